"""Whether a clip that a program built can be written and read back."""

from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from math import isfinite

from mocapress.errors import ParameterError
from mocapress.motion.clip import Clip
from mocapress.motion.skeleton import Joint, Skeleton

_CHANNELS = (*(f"{what}{axis}" for what in "trs" for axis in "xyz"), "l")
_KINDS = {"rotation": ("moving", "fixed"), "angle_unit": ("deg", "rad")}


def refuse_unsound(clip: Clip) -> None:
    """Refuse what no file could give back.

    Raises
    ------
    ParameterError
        When a frame time is no exact number above 0, a joint stands before its parent, a skeleton
        has channels, units or orders that there are not, places that are not finite, a column is of
        a joint that there is not, or metadata are no texts.

    """
    for what, expected, found in _faults(clip):
        raise ParameterError(what, expected=expected, found=found)


def _faults(clip: Clip) -> Iterator[tuple[str, str, str]]:
    joints = len(clip.skeleton.joints) if clip.skeleton else 2**31
    for name, stream in clip.streams.items():
        time = stream.frame_time
        exact = isinstance(time, Decimal | Fraction)
        if time is not None and not (exact and isfinite(time) and time > 0):
            expected = "a Decimal or Fraction above 0, or None; retime takes frames per second"
            yield f"frame time of stream {name!r}", expected, repr(time)
        for column in stream.columns:
            if not -1 <= column.joint < joints:
                expected = f"-1 to {joints - 1}" if clip.skeleton else "-1 or more"
                yield f"joint of column {column.name!r}", expected, str(column.joint)
    if clip.skeleton:
        yield from _of_skeleton(clip.skeleton)
    for key, value in clip.metadata.items():
        if not isinstance(key, str) or not isinstance(value, str):
            yield f"metadata {key!r}", "texts", repr(value)


def _of_skeleton(skeleton: Skeleton) -> Iterator[tuple[str, str, str]]:
    for field, allowed in _KINDS.items():
        if getattr(skeleton, field) not in allowed:
            yield f"skeleton: {field}", " or ".join(allowed), repr(getattr(skeleton, field))
    for place, joint in enumerate(skeleton.joints):
        for what, expected, found in _of_joint(joint, place):
            yield f"joint {joint.name!r}: {what}", expected, found


def _of_joint(joint: Joint, place: int) -> Iterator[tuple[str, str, str]]:
    if not -1 <= joint.parent < place:
        yield "parent", f"-1 or a joint before it, to {place - 1}", str(joint.parent)
    for channel in joint.channels:
        if channel not in _CHANNELS:
            yield "channel", ", ".join(_CHANNELS), repr(channel)
    if sorted(joint.axis_order) != ["x", "y", "z"]:
        yield "axis_order", "each of x, y, z once", repr(joint.axis_order)
    for vector in (joint.offset, joint.axis, *joint.ends):
        if len(vector) != 3 or not all(map(isfinite, vector)):
            yield "offset, axis or end", "three finite numbers", repr(vector)
