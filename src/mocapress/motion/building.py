"""Clips from arrays, in one call, and arrays with names from clips."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from mocapress.errors import ParameterError
from mocapress.motion.clip import Clip
from mocapress.motion.columns import named_columns, skeleton_columns
from mocapress.motion.convert import zyx_degrees
from mocapress.motion.frame_time import FrameTime, of_rate
from mocapress.motion.kinematics import Array
from mocapress.motion.markers import POINTS
from mocapress.motion.skeleton import Joint, Skeleton
from mocapress.motion.stream import Column, Stream

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_TURNS = ("rz", "ry", "rx")


def from_array(
    values: ArrayLike, names: Sequence[str], fps: float | None = None, *, name: str = ""
) -> Clip:
    """Make a clip of numbers with names.

    Parameters
    ----------
    values
        (F, C).
    names
        Of the columns: ``joint.kind``, such as ``root.tx`` or ``lfemur.rx`` (degrees), or any text.
    fps
        Frames per second; None where it is not known.
    name
        Of the clip.

    Raises
    ------
    ParameterError
        When shape and names do not fit, or ``fps`` is no number above 0.

    """
    array = _shaped(values, "values", (None, len(names)))
    return Clip.of(array, named_columns(names), _optional(fps), name=name)


def from_positions(
    positions: ArrayLike,
    names: Sequence[str],
    fps: float | None = None,
    *,
    parents: Sequence[int] | None = None,
    name: str = "",
) -> Clip:
    """Make a clip of points in space.

    Parameters
    ----------
    positions
        (F, P, 3), in any unit of length.
    names
        Of the points.
    fps
        Frames per second; None where it is not known.
    parents
        Index of each point's parent, -1 for roots, parents before children. The points are then
        joints of a skeleton, each of which moves relative to its parent; without it, they are
        markers.
    name
        Of the clip.

    Raises
    ------
    ParameterError
        When shape, names and parents do not fit, or ``fps`` is no number above 0.

    """
    places = _shaped(positions, "positions", (None, len(names), 3))
    frames = len(places)
    if parents is None:
        columns = tuple(
            Column(f"{point}.{axis}", j, axis, "length")
            for j, point in enumerate(names)
            for axis in "xyz"
        )
        flat = places.reshape(frames, -1)
        return Clip({POINTS: Stream(flat, columns, _optional(fps))}, name=name)
    _refuse_bad(parents, len(names))
    moved = places.copy()
    for j, parent in enumerate(parents):
        if parent >= 0:
            moved[:, j] -= places[:, parent]
    joints = tuple(
        Joint(joint, parent, channels=("tx", "ty", "tz"))
        for joint, parent in zip(names, parents, strict=True)
    )
    skeleton = Skeleton(joints)
    columns = skeleton_columns(skeleton)
    return Clip.of(moved.reshape(frames, -1), columns, _optional(fps), skeleton, name)


def from_quaternions(
    rotations: ArrayLike,
    offsets: ArrayLike,
    parents: Sequence[int],
    names: Sequence[str],
    fps: float | None = None,
    *,
    root: ArrayLike | None = None,
    name: str = "",
) -> Clip:
    """Make a clip of joints' rotations, as BVH has it: angles about z, y and x, in degrees.

    Parameters
    ----------
    rotations
        (F, J, 4): unit quaternions relative to the parents, scalar first.
    offsets
        (J, 3): from each parent's joint, in the parent's frame.
    parents
        Index of each joint's parent, -1 for the root, parents before children.
    names
        Of the joints.
    fps
        Frames per second; None where it is not known.
    root
        (F, 3): positions of the first joint; by default its offset.
    name
        Of the clip.

    Raises
    ------
    ParameterError
        When shapes, names and parents do not fit, quaternions have another length than 1, or
        ``fps`` is no number above 0.

    """
    turns = _shaped(rotations, "rotations", (None, len(names), 4))
    apart = _shaped(offsets, "offsets", (len(names), 3))
    _refuse_bad(parents, len(names))
    lengths = np.linalg.norm(turns, axis=2)
    if not np.allclose(lengths, 1, atol=1e-3):
        worst = float(lengths.flat[np.abs(lengths - 1).argmax()])
        raise ParameterError("rotations", expected="unit quaternions", found=f"length {worst:.6g}")
    placed = np.broadcast_to(apart[0], (len(turns), 3)) if root is None else root
    joints = tuple(
        Joint(
            joint,
            parent,
            (0.0, 0.0, 0.0) if j == 0 else (float(x), float(y), float(z)),
            (("tx", "ty", "tz") if j == 0 else ()) + _TURNS,
        )
        for j, (joint, parent, (x, y, z)) in enumerate(zip(names, parents, apart, strict=True))
    )
    skeleton = Skeleton(joints)
    angles = zyx_degrees(turns / lengths[..., None]).reshape(len(turns), -1)
    values = np.hstack([_shaped(placed, "root", (len(turns), 3)), angles])
    return Clip.of(values, skeleton_columns(skeleton), _optional(fps), skeleton, name)


def to_dataframe(clip: Clip) -> "pd.DataFrame":
    """Give the first stream as a pandas data frame: a column a channel, seconds as the index.

    Where the rate is not known, the index is the number of the frame.

    Raises
    ------
    ImportError
        When pandas is not installed.

    """
    import pandas as pd

    names = [column.name for column in clip.columns]
    timed = clip.frame_time is not None
    index = (
        pd.Index(clip.times, name="seconds") if timed else pd.RangeIndex(len(clip), name="frame")
    )
    return pd.DataFrame(clip.values, columns=names, index=index)


def to_xarray(clip: Clip) -> "xr.DataArray":
    """Give the first stream as an xarray array (time, channel); see ``to_dataframe``.

    Raises
    ------
    ImportError
        When xarray is not installed.

    """
    import xarray as xr

    timed = clip.frame_time is not None
    along = "seconds" if timed else "frame"
    coordinates = {
        along: clip.times if timed else np.arange(len(clip)),
        "channel": [column.name for column in clip.columns],
    }
    return xr.DataArray(clip.values, coordinates, (along, "channel"), clip.name or None)


def _shaped(values: ArrayLike, what: str, shape: tuple[int | None, ...]) -> Array:
    """Give a float64 array after checking its shape; None is any number of frames."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ParameterError(what, expected="an array of numbers", found=str(error)) from None
    fits = array.ndim == len(shape) and all(
        wanted in (None, found) for wanted, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        expected = " x ".join("F" if size is None else str(size) for size in shape)
        raise ParameterError(
            f"shape of {what}", expected=expected, found=" x ".join(map(str, array.shape))
        )
    return array


def _refuse_bad(parents: Sequence[int], count: int) -> None:
    if len(parents) != count:
        raise ParameterError("parents", expected=str(count), found=str(len(parents)))
    for j, parent in enumerate(parents):
        if not -1 <= parent < j:
            raise ParameterError(
                f"parent of joint {j}",
                expected=f"-1 or a joint before it, to {j - 1}",
                found=str(parent),
            )


def _optional(fps: float | None) -> FrameTime:
    return None if fps is None else of_rate(fps)
