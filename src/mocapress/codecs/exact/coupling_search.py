"""Which columns are functions of others in the same frame.

A solver that spreads one bend over three vertebrae, or closes a hand by one number, leaves angles
that follow from other angles. Nothing is taken from names: laws are tried on every chain of joints
that they could hold for, and polynomials on the columns of a joint as functions of those of the two
joints before it.
"""

from collections.abc import Sequence
from itertools import combinations_with_replacement, groupby

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.exact.coupling import Coupling, CouplingKind
from mocapress.codecs.exact.joints import find_joints
from mocapress.codecs.exact.skeletons import axes, skeleton_of
from mocapress.motion import Column

_MOST_SOURCES = 6
_STRETCH = 22
_LEAST_STRETCHES, _MOST_STRETCHES = 3, 60
_LEAST_GAIN = 0.3
_LEAST_BEND = 0.15
_LEAST_SHARE = 0.25
_LAWFUL = 0.05
_RIDGE = 1e-9
_SCALE = 1 / 30
_SIGNIFICANT, _DECIMALS = 2, (3, 5, 6)
_LEAST = 1e-6
_SAMPLES = 40


def find_couplings(
    values: NDArray[np.float64],
    columns: Sequence[Column],
    predicted: Sequence[int],
    lines: Sequence[tuple[int, int]],
) -> list[Coupling]:
    """Find couplings among the predicted columns of (F, C) values.

    The known skeleton has its laws and no others.
    """
    sample = values[:: len(values) // _SAMPLES + 1]
    known = skeleton_of(columns)
    stretches = _stretches(values[:0] if known else values)
    joints = [
        list(group)
        for joint, group in groupby(predicted, lambda column: columns[column].joint)
        if joint >= 0
    ]
    found: list[Coupling] = []
    for place, own in enumerate(joints):
        before = joints[max(place - 2, 0) : place]
        coupling = _law(sample, columns, before, own) or _polynomial(stretches, before, own)
        if coupling:
            found.append(coupling)
            found += _middle(coupling)
    if known:
        return found
    lawful = {c for own in found if own.kind is not CouplingKind.POLYNOMIAL for c in own.targets}
    with np.errstate(over="ignore"):
        usual = np.median(np.abs(sample), axis=0)
    steps = np.array([_step(*line, float(usual[c])) for c, line in enumerate(lines)])
    free = [column for column in predicted if column not in lawful]
    return found + find_joints(values, columns, steps, free)


def _step(line: int, digits: int, usual: float) -> float:
    """Give the distance of neighbouring numbers on a line of core/numbers/line.hpp."""
    if line in _DECIMALS:
        return float(10.0**-digits)
    if line == _SIGNIFICANT:
        return float(10.0 ** (np.floor(np.log10(usual + _LEAST)) + 1 - digits))
    return max(usual, _LEAST) * 2.0**-23


def _stretches(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take short stretches from all over (F, C) values: (S, frames, C)."""
    count = min(len(values) // _STRETCH, _MOST_STRETCHES)
    starts = np.linspace(0, max(len(values) - _STRETCH, 0), count).astype(int)
    return np.array([values[start : start + _STRETCH] for start in starts])


def _law(
    sample: NDArray[np.float64],
    columns: Sequence[Column],
    before: Sequence[Sequence[int]],
    own: Sequence[int],
) -> Coupling | None:
    """Give the law by which a joint's angles follow from those of the joints before, if any."""
    kinds = [axes([columns[c] for c in joint]) for joint in (*before, own)]
    candidates: list[Coupling] = []
    if kinds == ["xyz", "xyz", "xyz"]:
        targets = (own[1], own[0], own[2])
        candidates = [
            Coupling(kind, (*before[0], *before[1]), targets)
            for kind in (CouplingKind.SPINE, CouplingKind.NECK)
        ]
    elif kinds[-1] == "xz":
        candidates = [
            Coupling(kind, tuple(joint), tuple(own))
            for joint, joint_axes in zip(before, kinds, strict=False)
            if joint_axes == "xz"
            for kind in (CouplingKind.THUMB, CouplingKind.OTHER_THUMB)
        ]
    shares = [_share(sample, coupling) for coupling in candidates]
    best = max(shares, default=0)
    return candidates[shares.index(best)] if best >= _LEAST_SHARE else None


def _middle(coupling: Coupling) -> list[Coupling]:
    """Give the law of the middle joint that comes with one of a chain of three."""
    kind = {
        CouplingKind.SPINE: CouplingKind.SPINE_MIDDLE,
        CouplingKind.NECK: CouplingKind.NECK_MIDDLE,
    }.get(coupling.kind)
    if kind is None:
        return []
    x, y, z = coupling.sources[3:]
    return [Coupling(kind, (*coupling.sources[:3], x, z), (y,))]


def _share(sample: NDArray[np.float64], coupling: Coupling) -> float:
    """Give the share of frames in which a law holds, to about a twentieth of a degree."""
    chosen = np.ascontiguousarray(sample[:, [*coupling.sources, *coupling.targets]])
    if not (np.abs(chosen) < 1e4).all():
        return 0
    told = _core.exact_law(coupling.kind, chosen)
    off = np.abs(told - chosen[:, len(coupling.sources) :])
    off = np.abs(off - 360 * np.round(off / 360))
    return float((off < _LAWFUL).all(axis=1).mean())


def _polynomial(
    stretches: NDArray[np.float64], before: Sequence[Sequence[int]], own: Sequence[int]
) -> Coupling | None:
    """Give a coupling where degree 3 predicts better than degree 1 what it was not fitted on."""
    sources = [column for joint in before for column in joint]
    if (
        len(before) < 2
        or len(sources) > _MOST_SOURCES
        or len(own) > 3
        or own[0] < sources[-1]
        or len(stretches) < _LEAST_STRETCHES
    ):
        return None
    levels = stretches[..., [*sources, *own]]
    if not (np.abs(levels) < 1e4).all():
        return None
    # The dear question only where a cheaper one says that there may be something to gain.
    if (
        _gain(levels[::2], len(sources), 2) < _LEAST_BEND
        or _gain(levels, len(sources), 3) < _LEAST_GAIN
    ):
        return None
    return Coupling(CouplingKind.POLYNOMIAL, tuple(sources), tuple(own))


def _gain(levels: NDArray[np.float64], sources: int, degree: int) -> float:
    """Give the bits per number by which second differences follow better with a degree than 1."""
    inputs, targets = levels[..., :sources] * _SCALE, levels[..., sources:]
    powers = [inputs, *(_products(inputs, power) for power in range(2, degree + 1))]
    curved, bent = (np.diff(s, 2, axis=1) for s in (np.concatenate(powers, axis=-1), targets))
    return _bits(curved[..., :sources], bent) - _bits(curved, bent)


def _products(inputs: NDArray[np.float64], degree: int) -> NDArray[np.float64]:
    """Give all products of so many of the inputs, (..., sources)."""
    factors = np.array(list(combinations_with_replacement(range(inputs.shape[-1]), degree))).T
    products = inputs[..., factors[0]]
    for factor in factors[1:]:
        products *= inputs[..., factor]
    return products


def _bits(inputs: NDArray[np.float64], targets: NDArray[np.float64]) -> float:
    """Give the mean logarithm of what linear fits on half of the stretches leave of the others."""
    inputs = inputs / (np.sqrt((inputs**2).mean(axis=(0, 1))) + 1e-300)
    size = inputs.shape[-1]
    left = np.empty_like(targets)
    for half in (0, 1):
        known, told = (side[half::2].reshape(-1, side.shape[-1]) for side in (inputs, targets))
        square = known.T @ known + _RIDGE * len(known) * np.eye(size)
        left[1 - half :: 2] = targets[1 - half :: 2] - inputs[1 - half :: 2] @ np.linalg.solve(
            square, known.T @ told
        )
    return float(np.log2(np.abs(left) + 1e-12).mean())
