"""Columns of a skeleton's channels."""

from collections.abc import Iterator, Sequence

from mocapress.errors import FormatError
from mocapress.motion.clip import Column
from mocapress.motion.skeleton import Skeleton

_ROOT_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")


def skeleton_columns(skeleton: Skeleton) -> tuple[Column, ...]:
    """Give the columns of all joints' channels, in the order of the joints."""
    columns: list[Column] = []
    seen: dict[str, int] = {}
    for index, joint in enumerate(skeleton.joints):
        if joint.channels:
            nth = seen[joint.name] = seen.get(joint.name, 0) + 1
            columns += _columns(joint.name, nth, index, joint.channels, skeleton.angle_unit)
    return tuple(columns)


def numbered_columns(count: int, kinds: tuple[str, ...]) -> tuple[Column, ...]:
    """Give columns in groups of these kinds, named by the number of their group, from 1 on."""
    size = len(kinds)
    return tuple(
        Column(f"{i // size + 1}.{kinds[i % size]}", -1, kinds[i % size]) for i in range(count)
    )


def bone_columns(
    skeleton: Skeleton | None, bones: Sequence[tuple[str, int]], angle_unit: str | None = None
) -> tuple[Column, ...]:
    """Give the columns of bones in the order in which a motion file names them.

    Parameters
    ----------
    skeleton
        Where to look up the bones: by name, or else by name ignoring case. The n-th bone of a name
        is the n-th joint of that name, those without channels last. Without a skeleton the kinds of
        columns are unknown, except for a first bone with six numbers, which is a root.
    bones
        Name and number of values of each.
    angle_unit
        ``deg`` or ``rad``; by default the skeleton's.

    Raises
    ------
    FormatError
        When the skeleton has no such bone, or one with another number of channels.

    """
    angle_unit = angle_unit or (skeleton.angle_unit if skeleton else "deg")
    exact, folded = _by_name(skeleton)
    seen: dict[str, int] = {}
    columns: list[Column] = []
    for place, (name, count) in enumerate(bones):
        nth = seen[name] = seen.get(name, 0) + 1
        joint, kinds = place, tuple(f"v{k + 1}" for k in range(count))
        if skeleton is not None:
            joint = _joint_of(skeleton, exact.get(name) or folded.get(name.lower(), []), name, nth)
            # Values of a bone without degrees of freedom are kept, and move nothing.
            kinds = skeleton.joints[joint].channels or kinds
            if len(kinds) != count:
                raise FormatError(
                    f"values of bone {name}",
                    expected=f"{len(kinds)} ({' '.join(kinds)}), as the skeleton has",
                    found=str(count),
                )
        elif place == 0 and count == len(_ROOT_CHANNELS):
            kinds = _ROOT_CHANNELS
        columns += _columns(name, nth, joint, kinds, angle_unit)
    return tuple(columns)


def _columns(
    name: str, nth: int, joint: int, kinds: tuple[str, ...], angle_unit: str
) -> Iterator[Column]:
    """Give the columns of the n-th bone of a name."""
    label = name if nth == 1 else f"{name}#{nth}"
    for kind in kinds:
        unit = angle_unit if kind[0] == "r" else "length" if kind[0] in "tl" else ""
        yield Column(f"{label}.{kind}", joint, kind, unit)


def _by_name(skeleton: Skeleton | None) -> tuple[dict[str, list[int]], dict[str, list[int]]]:
    exact: dict[str, list[int]] = {}
    folded: dict[str, list[int]] = {}
    joints = list(enumerate(skeleton.joints if skeleton else ()))
    # Bones without degrees of freedom usually have no values.
    for i, joint in sorted(joints, key=lambda item: not item[1].channels):
        exact.setdefault(joint.name, []).append(i)
        folded.setdefault(joint.name.lower(), []).append(i)
    return exact, folded


def _joint_of(skeleton: Skeleton, found: list[int], name: str, nth: int) -> int:
    if nth > len(found):
        names = ", ".join(joint.name for joint in skeleton.joints[:8])
        raise FormatError(
            f"the skeleton has no bone {name}", expected=f"{names}, …", found=repr(name)
        )
    return found[nth - 1]
