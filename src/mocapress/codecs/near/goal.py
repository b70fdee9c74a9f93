"""What was asked of the errors, in the units of a clip."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, radians

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.near.figure import HEIGHT, Figure
from mocapress.codecs.near.parts import joints_of_parts
from mocapress.errors import ParameterError
from mocapress.motion import Column
from mocapress.motion.units import ANGLES, LENGTHS, Amount

MEAN_OF_PRECISION = 1 / 3
MEAN_OF_MOST = 0.34
"""What mean error goes with a largest one, where none is asked for."""
MEAN_OF_FINE_MOST, FINE = 0.42, 3e-3
"""The same where the largest is less than this part of a figure's size: corrections cost less."""
WITHIN = 0.999
"""What an encoder takes of a bound; rounding of printed numbers may take the rest."""
MOST_OF_PRECISION = 1.6
"""ACL's own largest error at a precision, at most times this."""


@dataclass(frozen=True, slots=True)
class Goal:
    """What errors are measured and kept, in units of the file.

    ``in_space``: errors of joints, by their places and three points at ``radius``; otherwise of the
    values, in degrees and units of length.
    """

    in_space: bool
    mean: float
    most: float = inf
    radius: float = 0.0
    size: float = 1.0
    """Of the figure; 1 where errors are not in space."""
    of_joints: tuple[tuple[int, float], ...] = ()
    """Largest errors of joints that have their own instead of ``most``."""
    is_mean_asked: bool = False
    """Whether the mean is to be that of all errors as they are; otherwise, where joints have bounds
    of their own, each error counts beside its bound."""

    def largest(self, points: int) -> NDArray[np.float64]:
        """Give the largest error that each point may have, (P,)."""
        largest = np.full(points, self.most)
        for joint, most in self.of_joints:
            largest[joint] = most
        return largest


def goal_of(
    figure: Figure | None,
    *,
    most: Amount | None,
    mean: Amount | None,
    precision: Amount | None,
    quality: int,
    parts: Mapping[str, Amount],
) -> Goal:
    """Give the goal for clips of a figure; ``parts`` have largest errors of their own.

    Raises
    ------
    ParameterError
        When a length is asked for, and nothing says how long the units of the file are. When errors
        of parts cannot be measured, or are asked of a part that the skeleton does not have.

    """
    asked = [each for each in (most, mean, precision) if each is not None]
    if any(each.is_angle for each in asked):
        figure = None
    if parts and (figure is None or any(each.is_angle for each in parts.values())):
        raise ParameterError(
            f"near:{next(iter(parts))}: a part of the body has a bound in space only",
            expected="a clip with a skeleton, and lengths, such as 0.02cm",
        )
    size, radius = (figure.size, figure.radius) if figure else (1.0, 0.0)

    def own(each: Amount) -> float:
        if not each.unit:
            return each.number
        if each.is_angle:
            return each.number * ANGLES[each.unit]
        if figure is None or figure.unit is None:
            what = "a length" if figure else "a length, for a clip without a skeleton,"
            raise ParameterError(
                f"near: {what} cannot be kept: the units of the file are not known",
                expected="quality=1 to 9" if figure else "degrees, such as max=0.1deg, or no unit",
                found=f"{each.number:g}{each.unit}",
            )
        return each.number * LENGTHS[each.unit] / figure.unit

    if not asked:
        # From 1 cm at 1 to 0.01 cm at 9, of a figure 1.7 m high; without one, degrees.
        centimetres = 10.0 ** ((1 - quality) / 4)
        precision = Amount(centimetres / HEIGHT * size if figure else centimetres, "")
    largest = own(most) if most else own(precision) * MOST_OF_PRECISION if precision else inf
    of_joints = _of_joints(figure, {part: own(each) for part, each in parts.items()})
    if precision and not mean:
        middle = own(precision) * MEAN_OF_PRECISION
    else:
        # Above this mean, corrections of what is beyond the bound cost more than they save.
        fine = figure is not None and largest < FINE * size
        middle = largest * (MEAN_OF_FINE_MOST if fine else MEAN_OF_MOST)
        if mean:
            middle = min(middle, own(mean))
    return Goal(figure is not None, middle, largest, radius, size, of_joints, mean is not None)


def _of_joints(figure: Figure | None, parts: Mapping[str, float]) -> tuple[tuple[int, float], ...]:
    """Give the bound of every joint that has one of its own: the smallest of its parts."""
    found: dict[int, float] = {}
    if figure is not None:
        for part, joints in joints_of_parts(figure.skeleton, parts).items():
            found |= {joint: min(found.get(joint, inf), parts[part]) for joint in joints}
    return tuple(sorted(found.items()))


class Measure:
    """Errors of frames under a goal."""

    def __init__(self, goal: Goal, figure: Figure | None, columns: Sequence[Column]) -> None:
        self.goal = goal
        self.uses_radians = any(column.unit == "rad" for column in columns)
        figure = figure if goal.in_space else None
        if figure:
            columns, others = figure.columns, [goal.size] * len(columns)
        else:
            one = 1 / radians(1)
            others = [one if column.unit == "rad" else 1.0 for column in columns]
        skeleton = figure.skeleton if figure else None
        named = [(column.joint, column.kind) for column in columns]
        self.core = _core.near_measure(skeleton, named, self.uses_radians, goal.radius, others)
        self.points = len(skeleton.joints) if skeleton else len(columns)
