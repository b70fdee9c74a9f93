"""The skeleton of a DiffMA JSON: what a player needs to move it."""

from collections.abc import Sequence
from typing import Any

import msgspec

from mocapress.codecs.diffma import json_types
from mocapress.codecs.diffma.json_types import described, fail
from mocapress.motion import Joint, Skeleton

ColumnPlace = tuple[int, str]
"""A channel's joint (-1: none) and kind."""


def skeleton_keys(skeleton: Skeleton, places: Sequence[ColumnPlace]) -> dict[str, Any]:
    """Give a skeleton, and where its channels belong, as plain data."""
    made: dict[str, Any] = msgspec.to_builtins(write_skeleton(skeleton, places))
    return made


def write_skeleton(skeleton: Skeleton, places: Sequence[ColumnPlace]) -> json_types.Skeleton:
    """Give a skeleton, and where its channels belong, as it stands in a document."""
    joints = [
        json_types.Joint(
            joint.name,
            joint.parent,
            joint.offset,
            joint.channels,  # type: ignore[arg-type]
            joint.axis if any(joint.axis) else msgspec.UNSET,
            joint.axis_order if any(joint.axis) else "xyz",  # type: ignore[arg-type]
            joint.ends,
        )
        for joint in skeleton.joints
    ]
    return json_types.Skeleton(
        rotation=skeleton.rotation,  # type: ignore[arg-type]
        angle_unit=skeleton.angle_unit,  # type: ignore[arg-type]
        length_unit=skeleton.length_unit,
        joints=joints,
        columns=list(places),
    )


def read_skeleton(
    found: json_types.Skeleton, channels: int
) -> tuple[Skeleton, tuple[ColumnPlace, ...]]:
    """Read a skeleton of so many channels, and where they belong.

    Raises
    ------
    FormatError
        When parents do not stand before their children, or columns and joints do not fit.

    """
    joints = []
    for i, joint in enumerate(found.joints):
        if joint.parent >= i:
            place = f"$.skeleton.joints[{i}].parent"
            fail(place, f"-1 to {i - 1}, parents before their children", described(joint.parent))
        axis = (0.0, 0.0, 0.0) if joint.axis is msgspec.UNSET else joint.axis
        joints.append(
            Joint(
                joint.name,
                int(joint.parent),
                joint.offset,
                joint.channels,
                axis,
                joint.axis_order,
                ends=joint.ends,
            )
        )
    if len(found.columns) != channels:
        fail("$.skeleton.columns", f"{channels} items", str(len(found.columns)))
    for i, (index, _) in enumerate(found.columns):
        if index >= len(joints):
            fail(f"$.skeleton.columns[{i}][0]", f"-1 to {len(joints) - 1}", described(index))
    skeleton = Skeleton(tuple(joints), found.rotation, found.angle_unit, found.length_unit)
    return skeleton, tuple((int(joint), kind) for joint, kind in found.columns)
