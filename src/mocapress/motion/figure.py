"""What the size of a figure and its motion tell: the unit of lengths, and where the floor is."""

import numpy as np

from mocapress.motion.clip import Clip
from mocapress.motion.kinematics import Array, positions
from mocapress.motion.units import (
    centimetres_of,
    centimetres_per_unit,
    named_unit,
    suggest_unit,
)

_LOOKED_AT = 200
"""Frames."""


def unit_of(clip: Clip) -> str | None:
    """Say what unit the lengths of bones suggest, from the figure at rest or else in motion.

    Rest poses may be folded to nothing, with all lengths in the channels.
    """
    if clip.skeleton is None:
        return None
    found = suggest_unit(clip.skeleton)
    size = None if found else _size(clip)
    return found if size is None else named_unit(size, "in motion the figure measures")


def centimetres(clip: Clip) -> float | None:
    """Give the unit of lengths in centimetres, said or suggested as ``unit_of`` does."""
    if clip.skeleton is None:
        return None
    found = centimetres_per_unit(clip.skeleton)
    size = None if found else _size(clip)
    return found if size is None else centimetres_of(size)


def doubtful_root(clip: Clip) -> str | None:
    """Say where the root's translation seems to be meant relative to its OFFSET; None elsewhere.

    By the rule of the format, channels replace the offset. Where that puts the figure far below the
    floor, and with the offset added it stands on it, the file was probably written otherwise.
    """
    skeleton = clip.skeleton
    if skeleton is None or skeleton.rotation != "moving":
        return None
    places = _places(clip)
    if places is None:
        return None
    size = size_of(places)
    for axis, name in ((1, "y"), (2, "z")):
        offset = skeleton.joints[0].offset[axis]
        floor = float(np.median(places[:, :, axis].min(axis=1)))
        if floor < -size / 4 and abs(floor + offset) < size / 10:
            return (
                f"the figure stands at {name} = {floor:.4g}, with the root's OFFSET added at "
                f"{floor + offset:.4g}: its translation is probably relative to it"
            )
    return None


def size_of(places: Array) -> float:
    """Give how long a figure is that was in some places, (F, J, 3).

    It stands upright, or stretches, at some time.
    """
    return float(np.quantile(np.ptp(places, axis=1).max(axis=1), 0.95))


def _size(clip: Clip) -> float | None:
    places = _places(clip)
    return None if places is None else size_of(places)


def _places(clip: Clip) -> Array | None:
    """Give the places of all joints in some frames that have them, (F, J, 3)."""
    step = max(clip.frames // _LOOKED_AT, 1)
    with np.errstate(all="ignore"):
        places = positions(clip[::step]) if clip.frames else np.empty((0, 1, 3))
    places = places[np.isfinite(places).all(axis=(1, 2))]
    return places if len(places) else None
