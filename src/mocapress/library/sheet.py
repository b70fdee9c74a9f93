"""Contact sheets: figures of a few moments of each of some clips."""

from collections.abc import Callable, Sequence
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


class Tile(NamedTuple):
    """A clip, or a stretch of one, as it is drawn."""

    name: str
    facts: str
    """What is said below the name."""
    moments: Callable[[int], tuple[Clip, list[int]]]
    """Gives a clip with so many moments in it, and where they are."""


class Sheet(NamedTuple):
    """A picture, and what could not be drawn on it."""

    picture: "Image.Image"
    failures: list[MocapressError]


def draw_sheet(
    library: Library, clips: Sequence[StoredClip], *, columns: int = 3, count: int = 6
) -> Sheet:
    """Draw clips of a library, each with its name and what it is; see ``draw``."""
    return draw([tile_of(library, clip) for clip in clips], columns=columns, count=count)


def draw(tiles: Sequence[Tile], *, columns: int = 3, count: int = 6) -> Sheet:
    """Draw clips in rows, each with its name and some moments.

    Parameters
    ----------
    tiles
        What to draw, at least one.
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

    columns = min(columns, len(tiles))
    width, height = (side + _GAP for side in _CELL)
    lines = -(-len(tiles) // columns)
    size = columns * width + _GAP, lines * height + _GAP
    picture = Image.new("RGB", size, figures.GROUND)
    pen = ImageDraw.Draw(picture)
    font = ImageFont.load_default(_TEXT)
    failures = []
    for place, tile in enumerate(tiles):
        left = _GAP + place % columns * width
        top = _GAP + place // columns * height
        try:
            made, at = tile.moments(count)
            picture.paste(figures.strip(made, at, (_CELL[0], _FIGURES)), (left, top))
        except MocapressError as error:
            error.file = error.file or tile.name
            failures.append(error)
            pen.text((left, top + _FIGURES // 2), error.what, figures.MUTED, font)
        _caption(pen, font, (left, top + _FIGURES + 4), tile)
    return Sheet(picture, failures)


def tile_of(
    library: Library, clip: StoredClip, frames: slice | None = None, facts: str | None = None
) -> Tile:
    """Give the tile of a clip of a library, or of some frames of it."""
    seconds = "" if clip.duration is None else f", {clip.duration:.1f} s"
    said = "  ".join([f"{clip.frames} frames{seconds}", *clip.labels]) if facts is None else facts
    rows = range(clip.frames)[frames or slice(None)]
    return Tile(clip.name, said, lambda count: _moments(library, clip, rows, count))


def _moments(library: Library, clip: StoredClip, rows: range, count: int) -> tuple[Clip, list[int]]:
    """Give a clip with moments of some rows in it, and where they are."""
    at = [rows[moment] for moment in figures.moments(len(rows), count)]
    if clip.frames <= _LONG or not at:
        return library.load(clip, strict=False), at or [0]
    parts = [library.load(clip, slice(frame, frame + 1), strict=False) for frame in at]
    values = np.concatenate([part.values for part in parts])
    return parts[0].with_frames(values, parts[0].frame_time), list(range(len(values)))


def _caption(pen: object, font: object, at: tuple[int, int], tile: Tile) -> None:
    from PIL import ImageDraw, ImageFont

    assert isinstance(pen, ImageDraw.ImageDraw)
    assert isinstance(font, ImageFont.FreeTypeFont | ImageFont.ImageFont)
    name = tile.name.encode(errors="surrogateescape").decode(errors="replace")
    for text, colour, down in ((name, figures.INK, 0), (tile.facts, figures.MUTED, _TEXT + 3)):
        while text and pen.textlength(text, font) > _CELL[0]:
            # Of a name the end tells most.
            text = f"…{text[2:]}" if down == 0 else f"{text[:-2]}…"
        pen.text((at[0], at[1] + down), text, colour, font)
