"""A clip in a notebook: the page in a frame that needs nothing else."""

import html

from mocapress.errors import UnsupportedError
from mocapress.motion import Clip
from mocapress.viewer import embed, page


def frame(clip: Clip, *, max_error: float = embed.MAX_ERROR, height: int = 520) -> str:
    """Give an ``iframe`` that plays the clip; it is sandboxed and fetches nothing.

    Parameters
    ----------
    clip
        Is stored in the notebook's file as DiffMA JSON, or exactly if JSON cannot express it.
    max_error
        Largest error of a value, in its unit.
    height
        In CSS pixels.

    """
    try:
        content = embed.approximate(clip, max_error)
    except UnsupportedError:
        content = embed.exact(clip)
    document = page.document([content], clip.name or "mocapress")
    return (
        f'<iframe sandbox="allow-scripts" title="mocapress" '
        f'style="width:100%;height:{height}px;border:0;border-radius:12px" '
        f'srcdoc="{html.escape(document)}"></iframe>'
    )
