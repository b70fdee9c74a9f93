"""The skeleton of a DiffMA JSON: what a player needs to move it."""

from collections.abc import Sequence
from typing import Any, cast

from mocapress.codecs.diffma.json_value import JsonValue
from mocapress.motion import Joint, Skeleton
from mocapress.motion.skeleton import Vec3

_KINDS = ("tx", "ty", "tz", "rx", "ry", "rz", "l")
_AXIS_ORDERS = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")

ColumnPlace = tuple[int, str]
"""A channel's joint (-1: none) and kind."""


def skeleton_keys(skeleton: Skeleton, places: Sequence[ColumnPlace]) -> dict[str, Any]:
    """Give a skeleton, and where its channels belong, as plain data."""
    return {
        "rotation": skeleton.rotation,
        "angleUnit": skeleton.angle_unit,
        "lengthUnit": skeleton.length_unit,
        "joints": [_joint_keys(joint) for joint in skeleton.joints],
        "columns": [list(place) for place in places],
    }


def read_skeleton(
    value: JsonValue, channels: int
) -> tuple[Skeleton | None, tuple[ColumnPlace, ...]]:
    """Read a skeleton of so many channels, where there is one.

    Raises
    ------
    FormatError
        When it is none, with the JSON path.

    """
    if value.missing:
        return None, ()
    joints = tuple(_read_joint(item, i) for i, item in enumerate(value.get("joints").items()))
    length = value.get("lengthUnit")
    skeleton = Skeleton(
        joints,
        value.get("rotation").choice(["moving", "fixed"]),
        value.get("angleUnit").choice(["deg", "rad"], "deg"),
        None if length.missing or length.value is None else length.number(),
    )
    places = []
    for column in value.get("columns").items(channels):
        joint, kind = column.items(2)
        places.append((joint.integer(-1, len(joints) - 1), kind.text()))
    return skeleton, tuple(places)


def _joint_keys(joint: Joint) -> dict[str, Any]:
    keys: dict[str, Any] = {"name": joint.name, "parent": joint.parent, "offset": joint.offset}
    if joint.channels:
        keys["channels"] = joint.channels
    if any(joint.axis):
        keys |= {"axis": joint.axis, "axisOrder": joint.axis_order}
    if joint.ends:
        keys["ends"] = joint.ends
    return keys


def _read_joint(value: JsonValue, index: int) -> Joint:
    channels, axis, ends = value.get("channels"), value.get("axis"), value.get("ends")
    return Joint(
        value.get("name").text(),
        value.get("parent").integer(-1, index - 1),  # parents stand before their children
        _vector(value.get("offset")),
        () if channels.missing else tuple(item.choice(_KINDS) for item in channels.items()),
        (0.0, 0.0, 0.0) if axis.missing else _vector(axis),
        value.get("axisOrder").choice(_AXIS_ORDERS, "xyz"),
        ends=() if ends.missing else tuple(_vector(item) for item in ends.items()),
    )


def _vector(value: JsonValue) -> Vec3:
    return cast(Vec3, tuple(value.numbers(3).tolist()))
