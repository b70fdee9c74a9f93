"""A contact sheet: figures of a few moments of each clip of a library."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mocapress import figures
from mocapress.errors import MocapressError
from mocapress.library.clips import StoredClip
from mocapress.library.library import Library
from mocapress.motion import Clip

if TYPE_CHECKING:
    from PIL import Image

_CELL, _FIGURES, _GAP, _TEXT = (480, 176), 136, 16, 14
_LONG = 2**12
"""Clips of more frames are not decoded whole."""


class Sheet(NamedTuple):
    """A picture, and what could not be drawn on it."""

    picture: "Image.Image"
    failures: list[MocapressError]


def draw_sheet(
    library: Library, clips: Sequence[StoredClip], *, columns: int = 3, count: int = 6
) -> Sheet:
    """Draw clips in rows, each with its name and some moments.

    Parameters
    ----------
    library, clips
        What to draw, at least one clip.
    columns
        How many clips there are in a row.
    count
        Moments of each clip.

    Raises
    ------
    UnsupportedError
        When Pillow is not installed.

    """
    figures.pillow()
    from PIL import Image, ImageDraw, ImageFont

    columns = min(columns, len(clips))
    width, height = (side + _GAP for side in _CELL)
    lines = -(-len(clips) // columns)
    size = columns * width + _GAP, lines * height + _GAP
    picture = Image.new("RGB", size, figures.GROUND)
    draw = ImageDraw.Draw(picture)
    font = ImageFont.load_default(_TEXT)
    failures = []
    for place, clip in enumerate(clips):
        left = _GAP + place % columns * width
        top = _GAP + place // columns * height
        try:
            made, at = _moments(library, clip, count)
            picture.paste(figures.strip(made, at, (_CELL[0], _FIGURES)), (left, top))
        except MocapressError as error:
            error.file = error.file or clip.name
            failures.append(error)
            draw.text((left, top + _FIGURES // 2), error.what, figures.MUTED, font)
        _caption(draw, font, (left, top + _FIGURES + 4), clip)
    return Sheet(picture, failures)


def _moments(library: Library, clip: StoredClip, count: int) -> tuple[Clip, list[int]]:
    """Give a clip with the moments in it, and where they are."""
    at = figures.moments(clip.frames, count)
    if clip.frames <= _LONG or not at:
        return library.load(clip, strict=False), at or [0]
    parts = [library.load(clip, slice(frame, frame + 1), strict=False) for frame in at]
    rows = np.concatenate([part.values for part in parts])
    return parts[0].with_frames(rows, parts[0].frame_time), list(range(len(rows)))


def _caption(draw: object, font: object, at: tuple[int, int], clip: StoredClip) -> None:
    from PIL import ImageDraw, ImageFont

    assert isinstance(draw, ImageDraw.ImageDraw)
    assert isinstance(font, ImageFont.FreeTypeFont | ImageFont.ImageFont)
    seconds = "" if clip.duration is None else f", {clip.duration:.1f} s"
    facts = "  ".join([f"{clip.frames} frames{seconds}", *clip.labels])
    name = clip.name.encode(errors="surrogateescape").decode(errors="replace")
    for text, colour, down in ((name, figures.INK, 0), (facts, figures.MUTED, _TEXT + 3)):
        while text and draw.textlength(text, font) > _CELL[0]:
            # Of a name the end tells most.
            text = f"…{text[2:]}" if down == 0 else f"{text[:-2]}…"
        draw.text((at[0], at[1] + down), text, colour, font)
