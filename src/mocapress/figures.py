"""Figures of a clip at moments, drawn with Pillow: what contact sheets and lists of finds show.

>>> moments = clip.values[[0, 40, 80]]        # or whichever frames matter
>>> figures.strip(clip, [0, 40, 80], (480, 160)).save("walk.png")

Pillow is an extra (``pip install 'mocapress[pictures]'``), imported when something is drawn.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import UnsupportedError
from mocapress.motion import Clip
from mocapress.motion.kinematics import positions
from mocapress.motion.markers import POINTS, markers

if TYPE_CHECKING:
    from PIL import Image

Array = NDArray[np.float64]
Colour = tuple[int, int, int]

GROUND: Colour = (250, 251, 253)
INK: Colour = (23, 32, 47)
MUTED: Colour = (110, 122, 144)
_NEAR: Colour = (32, 90, 210)
_FAR: Colour = (168, 192, 240)
_LINE: Colour = (214, 220, 230)
_FINER = 3
"""Lines are drawn so much larger, and made smaller, which smooths them."""
_USUAL_Y = 1.2
"""How much longer figures must be along z than along y to be taken to stand along z."""


def moments(frames: int, count: int) -> list[int]:
    """Give up to ``count`` frames, evenly spread over a clip of ``frames``."""
    spread = (np.arange(count) + 0.5) * frames / count
    return sorted({int(place) for place in spread if frames})


def strip(clip: Clip, frames: Sequence[int], size: tuple[int, int]) -> "Image.Image":
    """Draw a clip at some moments, side by side, all at one scale and from one side.

    Parameters
    ----------
    clip
        With a skeleton, or with markers.
    frames
        The moments, at least one.
    size
        Width and height of the picture, pixels.

    Raises
    ------
    UnsupportedError
        When the clip has neither skeleton nor markers, bones that stretch, no place that is known
        in these frames, or Pillow is not installed.

    """
    pillow()
    from PIL import Image, ImageDraw

    points, parents, head = _points(clip, frames)
    across, up, depth = _seen(points)
    width, height = (_FINER * side for side in size)
    floor, top = np.nanmin(up), np.nanmax(up)
    cell = width / len(frames)
    middle = np.nanmean(across, axis=1, keepdims=True)
    reach = max(2 * float(np.nanmax(np.abs(across - middle))), 1e-9)
    scale = min(0.86 * height / max(top - floor, 1e-9), 0.92 * cell / reach)
    x = (across - middle) * scale + (np.arange(len(frames)) + 0.5)[:, None] * cell
    y = 0.94 * height - (up - floor) * scale
    behind, before = (edge(depth, axis=1, keepdims=True) for edge in (np.nanmin, np.nanmax))
    near = (depth - behind) / np.maximum(before - behind, 1e-9)

    picture = Image.new("RGB", (width, height), GROUND)
    draw = ImageDraw.Draw(picture)
    draw.line([(0, 0.94 * height), (width, 0.94 * height)], fill=_LINE, width=_FINER)
    thick = max(2, round(0.028 * (top - floor) * scale))
    for moment in range(len(frames)):
        for point in np.argsort(near[moment]):
            if not np.isfinite(x[moment, point]):
                continue
            colour = _between(near[moment, point])
            here = float(x[moment, point]), float(y[moment, point])
            if parents is None:
                _dot(draw, here, 0.8 * thick, colour)
                continue
            parent = parents[point]
            if parent >= 0:
                there = float(x[moment, parent]), float(y[moment, parent])
                draw.line([there, here], fill=colour, width=thick)
                _dot(draw, here, thick / 2, colour)
            if point == head:
                _dot(draw, here, 2 * thick, colour)
    return picture.resize(size, Image.Resampling.LANCZOS)


def pillow() -> None:
    """See that Pillow is there.

    Raises
    ------
    UnsupportedError
        When it is not.

    """
    try:
        import PIL  # noqa: F401
    except ImportError:
        raise UnsupportedError(
            "drawing needs Pillow", expected="pip install 'mocapress[pictures]'"
        ) from None


def _points(clip: Clip, frames: Sequence[int]) -> tuple[Array, list[int] | None, int]:
    """Give points (M, P, 3), each one's parent, and which is the head; markers have no parents."""
    if POINTS in clip.streams:
        found = markers(clip)
        places = np.where(found.valid[..., None], found.positions, np.nan)[list(frames)]
        parents: list[int] | None = None
        head = -1
    elif clip.skeleton is not None:
        skeleton = clip.skeleton
        rows = clip.with_frames(clip.values[list(frames)], clip.frame_time)
        places = positions(rows, end_sites=True)
        ends = [joint for joint, made in enumerate(skeleton.joints) for _ in made.ends]
        parents = [joint.parent for joint in skeleton.joints] + ends
        named = [i for i, joint in enumerate(skeleton.joints) if "head" in joint.name.lower()]
        head = named[0] if named else -1
    else:
        raise UnsupportedError("neither a skeleton nor markers to be drawn", file=clip.name or None)
    if not np.isfinite(places).any():
        raise UnsupportedError("no place is known to be drawn", file=clip.name or None)
    return places, parents, head


def _seen(points: Array) -> tuple[Array, Array, Array]:
    """Give where points are seen: to the right, up, and towards the eye, each (M, P).

    Files have y or z up. The side is the one from which a figure is widest.
    """
    lengths = [
        float(np.nanmean(np.nanmax(points[..., i], 1) - np.nanmin(points[..., i], 1)))
        for i in (1, 2)
    ]
    vertical = 2 if lengths[1] > _USUAL_Y * lengths[0] else 1
    flat = points[..., [0, 2]] if vertical == 1 else points[..., [0, 1]] * (1, -1)
    own = (flat - np.nanmean(flat, axis=1, keepdims=True)).reshape(-1, 2)
    own = own[np.isfinite(own).all(axis=1)]
    _, ways = np.linalg.eigh(own.T @ own)
    way = ways[:, -1] * (1 if ways[0, -1] >= 0 else -1)
    return flat @ way, points[..., vertical], flat @ np.array([-way[1], way[0]])


def _between(near: float) -> Colour:
    red, green, blue = (round(f + near * (n - f)) for f, n in zip(_FAR, _NEAR, strict=True))
    return red, green, blue


def _dot(draw: object, at: tuple[float, float], radius: float, colour: Colour) -> None:
    from PIL import ImageDraw

    assert isinstance(draw, ImageDraw.ImageDraw)
    (x, y) = at
    draw.ellipse([x - radius, y - radius, x + radius, y + radius], fill=colour)
