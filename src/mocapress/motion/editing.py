"""Clips made from clips: joined, at another rate, mirrored."""

import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from fnmatch import fnmatchcase
from fractions import Fraction

import numpy as np

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.motion.clip import Clip
from mocapress.motion.convert import with_rate
from mocapress.motion.frame_time import of_rate
from mocapress.motion.kinematics import Array
from mocapress.motion.skeleton import Joint, Skeleton, Vec3, near
from mocapress.motion.stream import Column, Stream

_SIDES = (
    re.compile("left|right"),
    re.compile("(?<![a-z])[lr](?![a-z])"),  # `L Thigh`, `foot_l`
    re.compile("^[lr]"),  # `lfemur`
)
_WHOLE = 1e-6
"""Part of a frame by which a new frame may miss one of the clip, and be taken as that."""
_PRINTED = 2e-5
"""Part of a rate by which one may miss a simple ratio because it was printed with few digits:
0.0083333 seconds are a 120th."""
_OTHER = {"left": "right", "right": "left", "l": "r", "r": "l"}


def concat(clips: Sequence[Clip]) -> Clip:
    """Join clips of the same columns and rate, one after the other; the rest is the first's.

    Raises
    ------
    ParameterError
        When there is no clip, or one differs from the first in its streams, columns or frame time.

    """
    if not clips:
        raise ParameterError("concat", expected="at least one clip", found="none")
    first = clips[0]
    for number, clip in enumerate(clips[1:], 1):
        if [*clip.streams] != [*first.streams]:
            raise ParameterError(
                f"clip {number}", expected=f"streams {[*first.streams]}", found=str([*clip.streams])
            )
        for name, stream in first.streams.items():
            other = clip.streams[name]
            if _named(other.columns) != _named(stream.columns):
                raise ParameterError(f"clip {number}: its columns are not those of the first")
            if other.frame_time != stream.frame_time:
                raise ParameterError(
                    f"clip {number}: frame time",
                    expected=str(stream.frame_time),
                    found=str(other.frame_time),
                )
    streams = {
        name: replace(stream, values=np.concatenate([clip.streams[name].values for clip in clips]))
        for name, stream in first.streams.items()
    }
    return replace(first, streams=streams)


def _named(columns: Sequence[Column]) -> list[tuple[str, str]]:
    return [(column.name, column.unit) for column in columns]


def only(clip: Clip, names: Sequence[str]) -> Clip:
    """Give the columns of some names, without the skeleton, which needs all of its own.

    Parameters
    ----------
    clip
        Any; streams of which no column is left are left out.
    names
        Of columns; ``*``, ``?`` and ``[...]`` stand for others, as in a shell: ``root.*``.

    Raises
    ------
    ParameterError
        When one of them is no column's.

    """
    known = [column.name for stream in clip.streams.values() for column in stream.columns]
    for name in names:
        if not any(fnmatchcase(one, name) for one in known):
            raise ParameterError(f"no column {near(name, known)}")
    streams = {}
    for name, stream in clip.streams.items():
        kept = [
            c
            for c, column in enumerate(stream.columns)
            if any(fnmatchcase(column.name, wanted) for wanted in names)
        ]
        if kept:
            columns = tuple(replace(stream.columns[c], joint=-1) for c in kept)
            streams[name] = replace(stream, values=stream.values[:, kept], columns=columns)
    return replace(clip, streams=streams, skeleton=None)


def crop(clip: Clip, start: float = 0, end: float | None = None) -> Clip:
    """Give the frames of a clip from one time to another, the last not included.

    Parameters
    ----------
    clip
        With a frame time.
    start, end
        Seconds from the first frame; None is the end of the clip.

    Raises
    ------
    UnsupportedError
        When the clip's rate is not known.

    """
    if clip.frame_time is None:
        raise UnsupportedError("the sampling rate is not known; mp.retime states it")
    return clip[frames_between(start, end, clip.frame_time)]


def frames_between(start: float, end: float | None, frame_time: Decimal | Fraction) -> slice:
    """Give the frames from one time to another, in seconds from the first; None is the end."""
    step = float(frame_time)
    first = max(round(start / step), 0)
    return slice(first, None if end is None else max(round(end / step), first))


def retime(clip: Clip, fps: float) -> Clip:
    """Give the same frames at another rate: the first stream then lasts longer or shorter.

    Raises
    ------
    ParameterError
        When ``fps`` is no number above 0.

    """
    return with_rate(clip, fps)


def resample(clip: Clip, fps: float) -> Clip:
    """Give the first stream of a clip at another rate: the same motion in more or fewer frames.

    Frames that fall on a frame of the clip are that frame. Between two frames, rotations of joints
    that turn about three different axes go the shortest way on the sphere of unit quaternions
    (slerp), and all other channels straight. Nothing is filtered before frames are left out.

    Parameters
    ----------
    clip
        With a frame time. Values that are not finite make the values beside them NaN.
    fps
        Frames per second.

    Raises
    ------
    ParameterError
        When ``fps`` is no number above 0.
    UnsupportedError
        When the clip's own rate is not known; ``mp.retime`` states it.

    """
    frame_time = of_rate(fps)
    if clip.frame_time is None:
        raise UnsupportedError("the sampling rate is not known; mp.retime states it")
    exact = frame_time / Fraction(clip.frame_time)
    simple = exact.limit_denominator(1000)
    step = float(simple if abs(simple / exact - 1) < _PRINTED else exact)
    count = int((clip.frames - 1) / step + _WHOLE) + 1 if clip.frames else 0
    at: Array = np.arange(count, dtype=np.float64) * np.float64(step)
    whole = np.abs(at - np.round(at)) < _WHOLE
    at[whole] = np.round(at[whole])
    before = at.astype(np.intp)
    part = (at - before)[:, None]
    after = np.minimum(before + 1, max(clip.frames - 1, 0))
    values = clip.values[before] * (1 - part) + clip.values[after] * part
    for columns in _turning(clip):
        values[:, columns] = _slerped(clip, columns, at, values)
    values[whole] = clip.values[before[whole]]
    return replace(clip, streams=_only_main(clip)).with_frames(values, frame_time)


def _slerped(clip: Clip, columns: list[int], at: Array, straight: Array) -> Array:
    """Give the angles of a joint at fractional frames, those nearest to the straight ones."""
    from scipy.spatial.transform import Rotation, Slerp

    moving = clip.skeleton is None or clip.skeleton.rotation == "moving"
    order = "".join(clip.columns[c].kind[1] for c in columns)
    scale = 1.0 if clip.columns[columns[0]].unit == "rad" else np.pi / 180
    angles, near = clip.values[:, columns] * scale, straight[:, columns] * scale
    known = np.isfinite(near).all(axis=1)
    if len(angles) == 1 or not np.isfinite(angles).all(axis=1).any():
        return straight[:, columns]
    turns = Rotation.from_euler(order.upper() if moving else order, np.nan_to_num(angles))
    between = Slerp(np.arange(len(angles)), turns)(at)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of angles that are not determined: see below
        found = between.as_euler(order.upper() if moving else order)
    twin = np.pi + found * [1, -1, 1]
    both = np.stack([found, twin])
    both += 2 * np.pi * np.round((near - both) / (2 * np.pi))
    first, second = np.abs(both - near).sum(axis=2)
    chosen = np.where((first <= second)[:, None], both[0], both[1])
    locked = np.abs(np.cos(found[:, 1])) < 1e-6
    result: Array = np.where((known & ~locked)[:, None], chosen, near)
    return result / scale


def _only_main(clip: Clip) -> dict[str, Stream]:
    name = next(iter(clip.streams))
    return {name: clip.streams[name]}


def _turning(clip: Clip) -> list[list[int]]:
    """Give the columns of each joint that turns about three different axes, in their order."""
    of_joint: dict[int, list[int]] = {}
    for c, column in enumerate(clip.columns):
        if column.joint >= 0 and column.kind in ("rx", "ry", "rz"):
            of_joint.setdefault(column.joint, []).append(c)
    return [
        columns
        for columns in of_joint.values()
        if len(columns) == 3 and len({clip.columns[c].kind for c in columns}) == 3
    ]


def mirror(clip: Clip) -> Clip:
    """Give the mirror image of a clip: left and right change places, in the skeleton, too.

    Every joint is where the mirror shows its partner of the other side. The mirror stands across
    the axis along which the left and right joints of the skeleton at rest lie apart. Left and right
    are told by the joints' names.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton, no two sides can be told apart, or they have other joints or
        channels.

    """
    skeleton = clip.skeleton
    if skeleton is None:
        raise UnsupportedError("mirroring needs a skeleton")
    other = [_partner(skeleton, i) for i in range(len(skeleton.joints))]
    across = _axis(skeleton, other)
    place = {(column.joint, column.kind): c for c, column in enumerate(clip.columns)}
    values = clip.values.copy()
    for c, column in enumerate(clip.columns):
        if column.joint < 0:
            continue
        found = place.get((other[column.joint], column.kind))
        if found is None:
            raise UnsupportedError(f"{column.name} has no partner on the other side")
        axis = "xyz".find(column.kind[-1])
        # A turn about the axis across stays, others turn the other way; places do the opposite.
        turned = column.kind[0] == "r" and axis != across
        moved = column.kind[0] == "t" and axis == across
        values[:, c] = clip.values[:, found] * (-1 if turned or moved else 1)
    mirrored = replace(skeleton, joints=tuple(_mirrored(skeleton, other, across)))
    return replace(clip.with_values(values), skeleton=mirrored)


def _mirrored(skeleton: Skeleton, other: Sequence[int], across: int) -> Iterator[Joint]:
    """Give the joints of the mirrored skeleton: each has its partner's place and axes, mirrored."""

    def shown(place: Vec3, sign: int) -> Vec3:
        x, y, z = (
            -sign * part if axis == across else sign * part for axis, part in enumerate(place)
        )
        return x, y, z

    for i, joint in enumerate(skeleton.joints):
        partner = skeleton.joints[other[i]]
        if partner.parent != (other[joint.parent] if joint.parent >= 0 else -1):
            raise UnsupportedError(f"{joint.name} and {partner.name} hang on different joints")
        yield replace(
            joint,
            offset=shown(partner.offset, 1),
            axis=shown(partner.axis, -1),
            ends=tuple(shown(end, 1) for end in partner.ends),
        )


def _partner(skeleton: Skeleton, joint: int) -> int:
    """Give the joint of the other side; one in the middle is its own."""
    names = {made.name.lower(): i for i, made in enumerate(skeleton.joints)}
    name = skeleton.joints[joint].name.lower()
    for side in _SIDES:
        swapped = side.sub(lambda found: _OTHER[found[0]], name)
        if swapped != name and swapped in names:
            return names[swapped]
    return joint


def _axis(skeleton: Skeleton, other: Sequence[int]) -> int:
    """Give the axis (0, 1, 2) along which joints of the two sides lie apart."""
    apart = np.zeros(3)
    for i, partner in enumerate(other):
        if partner != i:
            offsets = np.array([skeleton.joints[i].offset, skeleton.joints[partner].offset])
            apart += np.abs(offsets[0] - offsets[1])
    if not apart.any():
        raise UnsupportedError("the names of the joints tell no left and right")
    return int(apart.argmax())
