"""A clip in a notebook: the page in a frame that carries all it needs."""

import html

from mocapress.model import Clip
from mocapress.viewer import embed, page


def frame(clip: Clip, *, height: int = 520) -> str:
    """Give an ``iframe`` that plays the clip; it is sandboxed and fetches nothing.

    The notebook's file grows by the page and the clip. ``height`` is in CSS pixels.
    """
    document = page.document([embed.exact(clip)], clip.name or "mocapress")
    return (
        f'<iframe sandbox="allow-scripts" title="mocapress" '
        f'style="width:100%;height:{height}px;border:0;border-radius:12px" '
        f'srcdoc="{html.escape(document)}"></iframe>'
    )
