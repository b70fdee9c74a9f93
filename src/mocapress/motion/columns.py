"""Columns of a skeleton's channels."""

from collections.abc import Iterable, Sequence

from mocapress import _core
from mocapress.errors import FormatError
from mocapress.motion.skeleton import Skeleton
from mocapress.motion.stream import Column


def skeleton_columns(skeleton: Skeleton) -> tuple[Column, ...]:
    """Give the columns of all joints' channels, in the order of the joints."""
    return tuple(Column(*column) for column in _core.skeleton_columns(skeleton))


def named_columns(names: Sequence[Column | str]) -> tuple[Column, ...]:
    """Give the columns of names such as ``root.tx``; joints are numbered as they appear."""
    joints: dict[str, int] = {}
    columns = []
    for name in names:
        if isinstance(name, Column):
            columns.append(name)
            continue
        joint, _, kind = name.rpartition(".")
        unit = {"r": "deg", "t": "length"}.get(kind[:1], "") if len(kind) == 2 else ""
        columns.append(Column(name, joints.setdefault(joint, len(joints)), kind, unit))
    return tuple(columns)


def numbered_columns(count: int, kinds: tuple[str, ...]) -> tuple[Column, ...]:
    """Give columns in groups of these kinds, named by the number of their group, from 1 on."""
    size = len(kinds)
    return tuple(
        Column(f"{i // size + 1}.{kinds[i % size]}", -1, kinds[i % size]) for i in range(count)
    )


def bone_columns(
    skeleton: Skeleton, bones: Sequence[tuple[str, int]], angle_unit: str | None = None
) -> tuple[Column, ...]:
    """Give the columns of bones in the order in which a motion file names them.

    Parameters
    ----------
    skeleton
        Where to look up the bones: by name, or else by name ignoring case. The n-th bone of a name
        is the n-th joint of that name, those without channels last.
    bones
        Name and number of values of each.
    angle_unit
        ``deg`` or ``rad``; by default the skeleton's.

    Raises
    ------
    FormatError
        When the skeleton has no such bone, or one with another number of channels.

    """
    radians = (angle_unit or skeleton.angle_unit) == "rad"
    columns, fault = _core.bone_columns(skeleton, list(bones), radians)
    if fault:
        raise FormatError(fault.what, expected=fault.expected, found=fault.found)
    return tuple(Column(*column) for column in columns)


def distinct(names: Iterable[str]) -> list[str]:
    """Give names of which one that is there again is ``name#2``."""
    seen: dict[str, int] = {}
    found = []
    for name in names:
        count = seen[name] = seen.get(name, 0) + 1
        found.append(name if count == 1 else f"{name}#{count}")
    return found
