"""What columns are to the codec: turns of joints, and numbers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapress.motion import Column, Skeleton
from mocapress.records import Writer

_AXES = {"rx": 0, "ry": 1, "rz": 2}
_USUAL_REACH = 100.0
"""Length of a grown figure from the root to its farthest joint, cm."""
_USUAL_IMPORTANCE = 30.0
"""Of a joint of which nothing is known, cm per radian of half an angle."""
_LEAST_IMPORTANCE = 3.0
_IMPORTANCE_STEPS = 16
_REFERENCE_STEPS = 4096


@dataclass(frozen=True, slots=True)
class Body:
    """Columns as turns of joints and as numbers: docs/format/qssd.md, "Body"."""

    roles: tuple[int, ...]
    """Of each column: 0 for a number; 1, 2, 3 for a joint's first turn about x, y, z; 4, 5, 6 for
    a further one."""
    reversed: bool
    """Whether a joint's last turn stands first in the product, as in ASF."""
    radians: bool
    importance: tuple[int, ...]
    """Of each joint, 1/16: how far the body moves where half the angle is 1 radian."""
    numbers: tuple[float, ...]
    """Of each number: its importance."""
    apart: tuple[bool, ...]
    """Which joints no atom covers: those that move along axes, too, as the root does."""
    references: tuple[tuple[int, ...], ...]
    """Of each joint the turn from which displacements are counted, four parts in 1/4096."""
    number_references: tuple[float, ...]

    def pack(self) -> bytes:
        """Give the record."""
        writer = Writer()
        writer.integer(len(self.roles))
        writer.runs(self.roles)
        writer.integer(self.reversed | self.radians << 1)
        for importance, reference in zip(self.importance, self.references, strict=True):
            writer.integer(importance)
            for part in reference:
                writer.signed(part)
        facts = zip(self.numbers, self.number_references, strict=True)
        writer.numbers([fact for pair in facts for fact in pair])
        return bytes(writer.data)

    def with_references(self, turns: NDArray[np.float64], numbers: NDArray[np.float64]) -> "Body":
        """Take the mean of turns, (F, J, 4), and of numbers, (F, M), as the reference."""
        if not len(turns):
            return self
        aligned = np.where((turns * turns[:1]).sum(axis=-1, keepdims=True) < 0, -turns, turns)
        mean = aligned.mean(axis=0)
        length = np.sqrt((mean**2).sum(axis=-1, keepdims=True))
        near = np.where(length > 0.1, mean / np.where(length > 0, length, 1), turns[0])
        parts = np.rint(near * _REFERENCE_STEPS).astype(int).tolist()
        middle = [round(float(number), 3) for number in numbers.mean(axis=0)]
        return replace(
            self,
            references=tuple(map(tuple, parts)),
            number_references=tuple(middle),
        )


def body_of(columns: Sequence[Column], skeleton: Skeleton | None) -> Body:
    """Tell what columns are. A joint is one to three turns about different axes, side by side."""
    roles: list[int] = []
    joints: list[int] = []
    axes: list[list[int]] = []
    for c, column in enumerate(columns):
        axis = _AXES.get(column.kind, -1) if column.unit in ("deg", "rad") else -1
        if axis < 0 or column.joint < 0:
            roles.append(0)
        elif c and roles[-1] and joints[-1] == column.joint and axis not in axes[-1]:
            roles.append(4 + axis)
            axes[-1].append(axis)
        else:
            roles.append(1 + axis)
            joints.append(column.joint)
            axes.append([axis])
    moving = {column.joint for column in columns if column.kind in ("tx", "ty", "tz")}
    reach = _reach(skeleton)
    importance = _importance(skeleton, joints, reach)
    numbers = [c for c, role in zip(columns, roles, strict=True) if role == 0]
    return Body(
        tuple(roles),
        _is_reversed(axes, skeleton),
        any(column.unit == "rad" for column in columns),
        tuple(max(1, round(i * _IMPORTANCE_STEPS)) for i in importance),
        tuple(
            round(_USUAL_REACH / reach, 3) if reach and c.kind[:1] == "t" else 1.0 for c in numbers
        ),
        tuple(joint in moving for joint in joints),
        ((_REFERENCE_STEPS, 0, 0, 0),) * len(joints),
        (0.0,) * len(numbers),
    )


def _is_reversed(axes: list[list[int]], skeleton: Skeleton | None) -> bool:
    if skeleton is not None:
        return skeleton.rotation == "fixed"
    # An AMC names the channels in order, x first, and applies the last one last.
    return all(own == sorted(own) for own in axes)


def _reach(skeleton: Skeleton | None) -> float:
    """Give the distance from the root to the farthest joint or end at rest; 0 if unknown."""
    if skeleton is None:
        return 0.0
    places = _places(skeleton)
    ends = [
        places[i] + np.array(end) for i, joint in enumerate(skeleton.joints) for end in joint.ends
    ]
    squares = [float((place**2).sum()) for place in [*places, *ends]]
    reach = float(np.sqrt(max(squares, default=0.0)))
    return reach if 1e-6 < reach < 1e6 else 0.0


def _places(skeleton: Skeleton) -> list[NDArray[np.float64]]:
    places: list[NDArray[np.float64]] = []
    for joint in skeleton.joints:
        inside = joint.parent >= 0
        places.append(places[joint.parent] + np.array(joint.offset) if inside else np.zeros(3))
    return places


def _importance(skeleton: Skeleton | None, joints: Sequence[int], reach: float) -> list[float]:
    """Give the root mean square of how far all joints and ends move, cm per radian of half angle.

    At rest, and for an axis of any direction: two thirds of the squared distances.
    """
    if skeleton is None or not reach:
        return [_USUAL_IMPORTANCE] * len(joints)
    places = _places(skeleton)
    squares = np.zeros(len(places))
    count = 0
    for i, joint in enumerate(skeleton.joints):
        for point in [places[i], *(places[i] + np.array(end) for end in joint.ends)]:
            count += 1
            above = i
            while above >= 0:
                squares[above] += float(((point - places[above]) ** 2).sum())
                above = skeleton.joints[above].parent
    scale = 2 * _USUAL_REACH / reach
    found = scale * np.sqrt(squares * 2 / 3 / max(count, 1))
    return [
        min(max(float(found[joint]), _LEAST_IMPORTANCE), 1000.0)
        if joint < len(found)
        else _USUAL_IMPORTANCE
        for joint in joints
    ]
