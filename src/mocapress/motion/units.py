"""Lengths and angles with their units, and how long those of a skeleton are."""

import re
from dataclasses import dataclass
from math import inf

import numpy as np

from mocapress.errors import ParameterError
from mocapress.motion.skeleton import Skeleton

LENGTHS = {"m": 100.0, "cm": 1.0, "mm": 0.1, "in": 2.54}
"""Centimetres."""
ANGLES = {"deg": 1.0, "rad": 180 / np.pi}
"""Degrees."""
_AMOUNT = re.compile(r"(\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)\s*([a-z]*)")

CENTIMETRES_PER_INCH = 2.54
CMU = CENTIMETRES_PER_INCH / 0.45
"""Centimetres in a unit of the CMU database, also where a file does not say so."""

_UNITS = (("m", 100.0), ("cm", 1.0), ("mm", 0.1), ("inches", CENTIMETRES_PER_INCH))


def figure_size(skeleton: Skeleton) -> float:
    """Give the largest extent of the figure at rest along an axis, in units of its lengths."""
    places: list[np.ndarray] = []
    for joint in skeleton.joints:
        start = places[joint.parent] if joint.parent >= 0 else np.zeros(3)
        places.append(start + (np.array(joint.offset) if joint.parent >= 0 else 0))
    ends = [
        places[i] + np.array(end) for i, joint in enumerate(skeleton.joints) for end in joint.ends
    ]
    return float(np.ptp(np.stack(places + ends), axis=0).max())


def suggest_unit(skeleton: Skeleton) -> str | None:
    """Say what unit the lengths of bones suggest, from the size of the figure at rest."""
    if skeleton.length_unit not in (None, 1.0):
        unit = CENTIMETRES_PER_INCH / skeleton.length_unit
        return f"1 unit is {unit:.4g} cm, as the file says"
    return named_unit(figure_size(skeleton), "the figure measures")


def named_unit(size: float, said: str) -> str | None:
    """Name the unit in which a figure of such a size is a human one; None where there is none."""
    for name, centimetres in (*_UNITS, ("CMU's, 5.644 cm", CMU)):
        if _is_figure(size * centimetres):
            return f"{name} ({said} {size:.4g})"
    return None


def centimetres_per_unit(skeleton: Skeleton) -> float | None:
    """Give the unit of lengths in centimetres, said or suggested; None where neither is."""
    if skeleton.length_unit not in (None, 1.0, 0.0):
        return CENTIMETRES_PER_INCH / skeleton.length_unit
    return centimetres_of(figure_size(skeleton))


def centimetres_of(size: float) -> float | None:
    """Give the unit in which a figure of such a size is a human one; None where there is none."""
    return next((unit for _, unit in (*_UNITS, ("", CMU)) if _is_figure(size * unit)), None)


def _is_figure(centimetres: float) -> bool:
    # At rest it is some 1.7 m high, or as wide with its arms out.
    return 130 <= centimetres <= 230


def centimetres_in(unit: str) -> float | None:
    """Give the length of a column's unit, such as ``mm`` or ``0.1 mm``; None where it is none."""
    times, _, name = unit.rpartition(" ")
    return LENGTHS[name] * float(times or 1) if name in LENGTHS else None


@dataclass(frozen=True, slots=True)
class Amount:
    """A number with its unit, as it was written; ``unit`` may be empty."""

    number: float
    unit: str

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle."""
        return self.unit in ANGLES


def amount(text: str, where: str) -> Amount:
    """Read ``0.1cm``, ``0.05deg`` or ``0.02`` (units of the file).

    Raises
    ------
    ParameterError
        When it is no such amount above 0.

    """
    found = _AMOUNT.fullmatch(text.strip())
    units = {"", *LENGTHS, *ANGLES}
    if found and found[2] in units and 0 < float(found[1]) < inf:
        return Amount(float(found[1]), found[2])
    raise ParameterError(where, expected="an amount above 0, such as 0.1cm", found=repr(text))
