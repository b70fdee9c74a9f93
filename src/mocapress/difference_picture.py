"""A picture of how two clips of the same motion differ: errors over time, and the worst frame."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mocapress import figures
from mocapress.errors import UnsupportedError
from mocapress.figures import Array, Colour
from mocapress.motion import Clip
from mocapress.motion.comparing import Difference

if TYPE_CHECKING:
    from PIL import Image, ImageDraw, ImageFont

_WIDTH, _NAMES, _NUMBERS, _MARGIN = 1100, 190, 80, 16
_ROW, _TEXT, _FIGURES = 15, 12, 260
_MOST_ROWS = 40
_WORST: Colour = (196, 38, 38)


def draw_difference(
    first: Clip, second: Clip, difference: Difference, names: tuple[str, str] = ("first", "second")
) -> "Image.Image":
    """Draw the errors of each joint over time, and the worst frame of both clips side by side.

    Without skeletons, the rows are channels. Of many, those of the largest errors are drawn; a
    pixel shows the largest error of its frames.

    Parameters
    ----------
    first, second
        The clips.
    difference
        What ``mp.compare`` found between them.
    names
        What to call them.

    Raises
    ------
    UnsupportedError
        When Pillow is not installed, or the clips have no frames.

    """
    figures.pillow()
    from PIL import Image, ImageDraw, ImageFont

    placed = difference.distances
    errors, rows = (
        (difference.errors, difference.channels) if placed is None else (placed, difference.joints)
    )
    if not errors.size:
        raise UnsupportedError("clips without frames or channels cannot be drawn")
    kept = np.sort(np.argsort(-errors.max(axis=0), kind="stable")[:_MOST_ROWS])
    frame = int(errors.max(axis=1).argmax())
    figure = _worst_frame(first, second, frame)
    top = _MARGIN + 2 * (_TEXT + 6)
    below = top + len(kept) * _ROW
    height = below + 3 * _TEXT + _MARGIN + (_FIGURES + _TEXT + 2 * _MARGIN if figure else 0)
    picture = Image.new("RGB", (_WIDTH, height), figures.GROUND)
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(_TEXT)
    largest = float(errors.max())
    left, wide = _MARGIN + _NAMES, _WIDTH - 2 * _MARGIN - _NAMES - _NUMBERS
    of_what = "channels, units of each" if placed is None else "joints, length units of the file"
    _write(pen, font, (_MARGIN, _MARGIN), f"{names[0]}  and  {names[1]}", figures.INK)
    said = f"errors of {of_what}: white none, red {largest:.4g}; PSNR {difference.psnr:.2f} dB"
    _write(pen, font, (_MARGIN, _MARGIN + _TEXT + 6), said, figures.MUTED)
    heat = Image.fromarray(_coloured(errors[:, kept], wide, largest))
    picture.paste(heat.resize((wide, len(kept) * _ROW), Image.Resampling.NEAREST), (left, top))
    for row, column in enumerate(kept.tolist()):
        y = top + row * _ROW
        _write(pen, font, (_MARGIN, y), rows[column], figures.INK, _NAMES)
        most = f"{errors[:, column].max():.4g}"
        _write(pen, font, (left + wide + 8, y), most, figures.MUTED)
    x = left + round((frame + 0.5) / len(errors) * wide)
    pen.line([(x, below), (x, below + 6)], figures.INK, 2)
    _write(pen, font, (left, below + 8), _span(first), figures.MUTED)
    if figure:
        picture.paste(figure, (_MARGIN, below + 3 * _TEXT))
        said = f"frame {frame}, of {names[0]} and of {names[1]}"
        _write(pen, font, (_MARGIN, height - _MARGIN - _TEXT), said, figures.MUTED)
    return picture


def _coloured(errors: Array, wide: int, largest: float) -> NDArray[np.uint8]:
    """Give a pixel for each row and place in time, of the largest error of its frames."""
    frames = len(errors)
    if frames > wide:
        errors = np.maximum.reduceat(errors, np.arange(wide) * frames // wide, axis=0)
    finite = errors[np.isfinite(errors)].max(initial=0) if largest == np.inf else largest
    share = np.minimum(np.where(np.isfinite(errors), errors, np.inf) / (finite or 1), 1)
    ground, worst = np.array(figures.GROUND), np.array(_WORST)
    mixed = np.rint(ground + share.T[..., None] * (worst - ground))
    pixels: NDArray[np.uint8] = mixed.astype(np.uint8)
    return pixels


def _worst_frame(first: Clip, second: Clip, frame: int) -> "Image.Image | None":
    """Draw a frame of both at one scale; None of clips that are no figures."""
    both = np.stack([first.values[frame], second.values[frame]])
    name = next(iter(first.streams))
    alone = Clip({name: first.main}, first.skeleton).with_frames(both, first.frame_time)
    try:
        return figures.strip(alone, [0, 1], (_WIDTH - 2 * _MARGIN, _FIGURES))
    except UnsupportedError:
        return None


def _span(clip: Clip) -> str:
    lasting = "" if clip.duration is None else f", {clip.duration:.2f} s"
    return f"{clip.frames} frames{lasting}; the mark is the worst one"


def _write(
    pen: "ImageDraw.ImageDraw",
    font: "ImageFont.FreeTypeFont | ImageFont.ImageFont",
    at: tuple[int, int],
    text: str,
    colour: Colour,
    most: int = _WIDTH,
) -> None:
    text = text.encode(errors="surrogateescape").decode(errors="replace")
    while pen.textlength(text, font) > most:
        text = f"…{text[2:]}"  # of a name the end tells most
    pen.text(at, text, colour, font)
