"""In which order the curves of a joint turn."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.motion import Column

if TYPE_CHECKING:
    from mocapress.codecs.near.goal import Measure

Turning = tuple[int, int, int, int, int]
"""Of a joint: its first column, the order of the file's columns and of their axes and that of the
curves' axes, each one of six, and whether the file's angles are the nearest to zero."""

_FIGURE = """
root.tx/ty/tz/rx/ry/rz lowerback.rx/ry/rz upperback.rx/ry/rz thorax.rx/ry/rz
lowerneck.rx/ry/rz upperneck.rx/ry/rz head.rx/ry/rz
rclavicle.ry/rz rhumerus.rx/ry/rz rradius.rx rwrist.ry rhand.rx/rz rfingers.rx rthumb.rx/rz
lclavicle.ry/rz lhumerus.rx/ry/rz lradius.rx lwrist.ry lhand.rx/rz lfingers.rx lthumb.rx/rz
rfemur.rx/ry/rz rtibia.rx rfoot.rx/rz rtoes.rx lfemur.rx/ry/rz ltibia.rx lfoot.rx/rz ltoes.rx
"""
KNOWN = " ".join(
    f"{joint}.{kind}"
    for joint, _, kinds in (part.partition(".") for part in _FIGURE.split())
    for kind in kinds.split("/")
)
"""The columns of the known figure, that of the CMU database."""

_WINDOW, _WINDOWS = 64, 32
_GAIN = 0.97
"""Another order must cost so much less."""
_MOST = 1e4


def turnings_of(
    measure: "Measure", columns: Sequence[Column], values: NDArray[np.float64], scale: float
) -> list[Turning]:
    """Choose the joints whose curves are to turn in another order, and how.

    The cost of an order is the bits of the waves of the three curves, at steps of the scale divided
    by the curves' levers, in windows of the clip.
    """
    if len(values) < 2:
        return []
    named = [(column.joint, column.kind) for column in columns]
    found: list[Turning] = []
    for first, *orders in _core.near_turnable(measure.core, named):
        own = values[:, first : first + 3]
        if (np.abs(own) < _MOST).all() and (own != own[0]).any(axis=0).all():
            places, axes, curves, _ = orders
            found.append((first, places, axes, curves, 0))
    if not found:
        return []
    moderate = np.where(np.abs(values) < 1e9, values, 0.0)
    sample = _windows(moderate)
    costs = np.stack(
        [
            _costs(measure, sample, [(*each[:3], order, 0) for each in found], found, scale)
            for order in range(6)
        ]
    )
    # The file's own order counts among these, too: there the angles of a curve go on without leaps.
    as_they_are = _costs(measure, sample, [], found, scale)
    chosen = np.where(costs.min(axis=0) < _GAIN * as_they_are, costs.argmin(axis=0), -1)
    turnings = [
        (each[0], each[1], each[2], int(order), 0)
        for each, order in zip(found, chosen, strict=True)
        if order >= 0
    ]
    return nearest(measure, moderate, turnings)


def known_turnings() -> list[Turning]:
    """Give the turnings of the known figure."""
    return [(a, b, c, d, e) for a, b, c, d, e in _core.near_figure()[1]]


def is_known(measure: "Measure", columns: Sequence[Column], values: NDArray[np.float64]) -> bool:
    """Tell whether a clip has the columns of the known figure, which turn as its do."""
    exponents, turnings = _core.near_figure()
    if " ".join(column.name for column in columns) != KNOWN or measure.uses_radians:
        return False
    named = [(column.joint, column.kind) for column in columns]
    turnable = [tuple(each[:3]) for each in _core.near_turnable(measure.core, named)]
    return len(exponents) == len(columns) and all(
        tuple(each[:3]) in turnable
        and bool((np.abs(values[:, each[0] : each[0] + 3]) < _MOST).all())
        for each in turnings
    )


def _windows(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take windows out of a clip, one behind the other."""
    count = min(_WINDOWS, max(1, len(values) // _WINDOW))
    starts = np.linspace(0, max(0, len(values) - _WINDOW), count).astype(int)
    return np.ascontiguousarray(
        np.concatenate([values[first : first + _WINDOW] for first in starts])
    )


def _costs(
    measure: "Measure",
    sample: NDArray[np.float64],
    turnings: Sequence[Turning],
    joints: Sequence[Turning],
    scale: float,
) -> NDArray[np.float64]:
    """Give about how many bits every joint takes by turnings, (J,)."""
    turned = _core.near_turned(measure.core, sample, turnings)
    curves = _core.near_turned_measure(measure.core, turnings)
    frames = np.ascontiguousarray(turned[:: max(1, len(turned) // 128)])
    levers = np.sqrt(_core.near_levers(curves, frames, np.ones(measure.points)))
    size = min(_WINDOW, len(turned))
    windows = turned[: len(turned) // size * size].reshape(-1, size, turned.shape[1])
    k, t = np.mgrid[1:size, 0:size]
    cosines = np.sqrt(2 / size) * np.cos(np.pi * k * (2 * t + 1) / (2 * size))
    waves = np.einsum("kt,wtc->wkc", cosines, windows) * (levers / scale)
    bits = np.log2(1 + waves**2).sum(axis=(0, 1)) / 2
    return np.array([bits[each[0] : each[0] + 3].sum() for each in joints])


def nearest(
    measure: "Measure", values: NDArray[np.float64], turnings: Sequence[Turning]
) -> list[Turning]:
    """Say of each joint whether its angles are the nearest to zero or to the frame before."""
    zero, before = (
        _core.near_unlike(measure.core, values, [(*each[:4], nearest) for each in turnings])
        for nearest in (1, 0)
    )
    return [
        (*each[:4], int(one <= other))
        for each, one, other in zip(turnings, zero, before, strict=True)
    ]
