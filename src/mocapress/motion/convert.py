"""From one format's skeleton and columns to another's; positions of joints stay."""

import warnings
from dataclasses import replace
from fractions import Fraction

import numpy as np

from mocapress.errors import MocapressError, MotionWarning, UnsupportedError
from mocapress.motion import Clip, Column, Joint, NumberFormat, Skeleton
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.frame_time import of_rate
from mocapress.motion.kinematics import Array, local_rotations, translations
from mocapress.motion.number_format import NumberKind
from mocapress.motion.skeleton import Vec3

DEFAULT_FPS = 120
"""What is assumed, with a warning, where nothing says it; the rate of the CMU database."""


def with_rate(clip: Clip, fps: float | None = None, *, needed: bool = False) -> Clip:
    """Give the clip at a rate.

    Parameters
    ----------
    clip
        Any clip.
    fps
        Frames per second, which replace those of the clip; None keeps the clip's own.
    needed
        Whether to assume 120 frames per second, with a ``MotionWarning`` named ``assumed-rate``,
        where nobody says it.

    Raises
    ------
    ParameterError
        When ``fps`` is no number above 0.

    """
    if fps is not None:
        return _at_rate(clip, of_rate(fps))
    if clip.frame_time or not needed:
        return clip
    what = (
        f"the sampling rate is not known; {DEFAULT_FPS} frames per second are assumed "
        "(fps=... sets another)"
    )
    warnings.warn(MotionWarning("assumed-rate", MocapressError(what)), stacklevel=3)
    return clip.with_frame_time(Fraction(1, DEFAULT_FPS))


def _at_rate(clip: Clip, frame_time: Fraction) -> Clip:
    """Give the clip another frame time; what is sampled more often stays so."""
    streams = {
        name: replace(stream, frame_time=frame_time * Fraction(clip.frames, stream.frames))
        for name, stream in clip.streams.items()
        if stream.frames
    }
    made = clip.with_frame_time(frame_time)
    return replace(made, streams={**made.streams, **streams})


def to_bvh_clip(clip: Clip, fps: float | None = None) -> Clip:
    """Give the clip as BVH has it: three rotations per joint, six channels at the root.

    An ASF bone becomes the BVH joint at its start, so that its OFFSET is the vector of its parent
    bone; the vector of a bone without children becomes an End Site. Every joint gets Z, Y and X
    rotations, bones without degrees of freedom zeros.

    Parameters
    ----------
    clip
        With a skeleton. A clip that came from a BVH is given back as it is.
    fps
        Frames per second, instead of those of the clip. A clip that has none gets 120 where
        nothing is given, with a ``MotionWarning``.

    Raises
    ------
    ParameterError
        When ``fps`` is no number above 0.
    UnsupportedError
        When the clip has no skeleton or its bones stretch.

    """
    skeleton = _skeleton(clip)
    clip = with_rate(clip, fps, needed=True)
    if skeleton.rotation == "moving":
        return clip
    placed = translations(clip)
    moves = [i == 0 or _varies(placed[:, i]) for i in range(len(skeleton.joints))]
    joints = tuple(
        Joint(
            joint.name,
            joint.parent,
            (0.0, 0.0, 0.0) if i == 0 else joint.offset,
            (("tx", "ty", "tz") if moves[i] else ()) + ("rz", "ry", "rx"),
            ends=joint.ends,
        )
        for i, joint in enumerate(skeleton.joints)
    )
    made = Skeleton(joints, "moving", "deg", skeleton.length_unit, skeleton.name)
    angles = zyx_degrees(local_rotations(clip))
    values = [
        np.concatenate([placed[:, i], angles[:, i]] if moves[i] else [angles[:, i]], axis=1)
        for i in range(len(joints))
    ]
    return _finish(clip, made, values, NumberFormat(NumberKind.FIXED, 6))


def to_amc_clip(clip: Clip) -> Clip:
    """Give the clip as AMC with ASF has it.

    A BVH joint becomes the ASF bone that begins there. An ASF bone has one end, so where children
    lie elsewhere than at one common end, bones without degrees of freedom lead to them. Where a
    joint other than the root moves, the bone gets tx, ty and tz.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton, or one of several roots.

    """
    skeleton = _skeleton(clip)
    if skeleton.rotation == "fixed":
        return clip
    if sum(joint.parent < 0 for joint in skeleton.joints) != 1:
        raise UnsupportedError("an ASF has one root", expected="1")
    placed = translations(clip)
    angles = zyx_degrees(local_rotations(clip))[..., ::-1]
    # The root's place is all in its channels; ASF's translations add to the offset.
    places = _rest_places(skeleton, placed)
    moves = [i == 0 or _varies(placed[:, i]) for i in range(len(skeleton.joints))]
    joints, origin = _one_end_each(skeleton, places, moves)
    made = Skeleton(joints, "fixed", "deg", skeleton.length_unit or 1.0, skeleton.name)
    values = []
    for i in origin:
        parts = [placed[:, i] - np.array(places[i])] if i >= 0 and moves[i] else []
        values.append(
            np.concatenate([*parts, angles[:, i]], axis=1) if i >= 0 else angles[:, 0, :0]
        )
    return _finish(clip, made, values, NumberFormat(NumberKind.GENERAL, 9))


def _skeleton(clip: Clip) -> Skeleton:
    if clip.skeleton is None:
        raise UnsupportedError(
            "no skeleton", expected="one beside the file, or given (asf_path=...)"
        )
    return clip.skeleton


def _varies(placed: Array) -> bool:
    return bool(len(placed) and np.ptp(placed, axis=0).max() > 0)


def _rest_places(skeleton: Skeleton, placed: Array) -> list[Vec3]:
    """Give constant places of joints in their parents' frames: channels that stay are offsets."""
    places: list[Vec3] = [(0.0, 0.0, 0.0)]
    for i, joint in enumerate(skeleton.joints[1:], 1):
        fixed = len(placed) and not _varies(placed[:, i])
        x, y, z = placed[0, i].tolist() if fixed else joint.offset
        places.append((x, y, z))
    return places


def _one_end_each(
    skeleton: Skeleton, places: list[Vec3], moves: list[bool]
) -> tuple[tuple[Joint, ...], list[int]]:
    """Build the joints of an ASF, and say which source joint each is (-1: a connecting bone)."""
    count = len(skeleton.joints)
    here: list[set[Vec3]] = [set(joint.ends) for joint in skeleton.joints]
    for i in range(1, count):
        here[skeleton.joints[i].parent].add(places[i])
    common = [next(iter(h)) if len(h) == 1 and i else (0.0, 0.0, 0.0) for i, h in enumerate(here)]
    names = {joint.name for joint in skeleton.joints}
    joints: list[Joint] = []
    origin: list[int] = []
    index: dict[int, int] = {}

    def connect(parent: int, target: Vec3, name: str) -> int:
        """Give the joint from whose bone's end a target can be reached."""
        end = common[parent]
        if target == end:
            return index[parent]
        fresh, n = f"{name}_offset", 1
        while fresh in names:
            n += 1
            fresh = f"{name}_offset{n}"
        names.add(fresh)
        joints.append(Joint(fresh, index[parent], end, ends=(target,)))
        origin.append(-1)
        return len(joints) - 1

    for i, joint in enumerate(skeleton.joints):
        parent = -1 if i == 0 else connect(joint.parent, places[i], joint.name)
        index[i] = len(joints)
        rotation = ("rx", "ry", "rz") if joint.channels or i == 0 else ()
        channels = (("tx", "ty", "tz") if moves[i] else ()) + rotation
        joints.append(Joint(joint.name, parent, places[i] if i else (0.0, 0.0, 0.0), channels))
        origin.append(i if channels else -1)
        for end in joint.ends:
            if end == common[i] and i:
                joints[index[i]] = replace(joints[index[i]], ends=(end,))
            else:
                connect(i, end, f"{joint.name}_end")
    return tuple(joints), origin


def _finish(clip: Clip, skeleton: Skeleton, values: list[Array], number: NumberFormat) -> Clip:
    columns: tuple[Column, ...] = tuple(
        replace(column, decimal=number) for column in skeleton_columns(skeleton)
    )
    matrix = np.concatenate(values, axis=1) if values else np.empty((clip.frames, 0))
    return Clip.of(matrix, columns, clip.frame_time, skeleton, clip.name)


def zyx_degrees(turn: Array) -> Array:
    """Give angles z, y, x with turn = Rz Ry Rx, (..., 4) to (..., 3), continuous over frames."""
    w, x, y, z = np.moveaxis(turn, -1, 0)
    sine = np.clip(2 * (w * y - x * z), -1, 1)
    # At the poles z and x turn about one axis; x is taken as 0 there.
    pole = np.abs(sine) > 1 - 1e-14
    about_z = np.where(
        pole,
        2 * np.arctan2(z, w),
        np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z),
    )
    about_x = np.where(pole, 0.0, np.arctan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z))
    first = np.degrees(np.stack([about_z, np.arcsin(sine), about_x], axis=-1))
    return _continuous(first)


def _continuous(first: Array) -> Array:
    """Choose between (z, y, x) and its twin (z + 180, 180 - y, x + 180), whichever is nearer."""
    if len(first) < 2:
        return first
    twin = np.array([180.0, 180.0, 180.0]) + first * np.array([1.0, -1.0, 1.0])

    def distance(a: Array, b: Array) -> Array:
        total: Array = np.abs((a - b + 180) % 360 - 180).sum(axis=-1)
        return total

    changes = distance(twin[1:], first[:-1]) < distance(first[1:], first[:-1])
    parity = np.concatenate([np.zeros((1, *changes.shape[1:]), bool), changes]).cumsum(axis=0) % 2
    chosen = np.where(parity[..., None] == 1, twin, first)
    unwrapped: Array = np.unwrap(chosen, axis=0, period=360)
    return unwrapped
