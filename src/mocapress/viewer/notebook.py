"""A clip in a notebook: the page in a frame that needs nothing else."""

import html

from mocapress.motion import Clip
from mocapress.viewer import embed, page


def frame(clip: Clip, *, max_error: float | None = None, height: int = 520) -> str:
    """Give an ``iframe`` that plays the clip; it is sandboxed and fetches nothing.

    Parameters
    ----------
    clip
        Is stored in the notebook's file.
    max_error
        Largest error of a value, in its unit, as DiffMA JSON; None stores exact values.
    height
        In CSS pixels.

    """
    content = embed.exact(clip) if max_error is None else embed.approximate(clip, max_error)
    document = page.document([content], clip.name or "mocapress", assets=embed.assets([content]))
    return (
        f'<iframe sandbox="allow-scripts" title="mocapress" '
        f'style="width:100%;height:{height}px;border:0;border-radius:12px" '
        f'srcdoc="{html.escape(document)}"></iframe>'
    )
