"""Finds joints with fewer than three degrees of freedom, although they have three angles.

A knee that turned about one axis in the file from which a clip was converted still does, in other
angles; a wrist that had two axes keeps them. In both cases some direction v of the bone and some
direction u of its parent keep their angle: u' R v = c, with R the rotation of the joint. That gives
one of its angles from the other two. A hinge keeps its axis whole, R v = u, which gives two from
one. The directions are searched for in the clip; nothing is taken from names.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, product

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.exact.coupling import Coupling, CouplingKind
from mocapress.motion import Column
from mocapress.records import Writer

Floats = NDArray[np.float64]

_LEAST_FRAMES = 24
_MOST_FRAMES = 240
_LEAST_GAIN = 1.5
"""Bits per number."""
_REAL_GAIN = 0.7
"""How much of a gain over second differences is one over the other predictors."""
_OTHER_BITS = 48
"""What a coupling takes in the header beside its parameters."""
_USUAL_STEPS = 0.5
_NEAR, _NEAR_STEPS = 1e-4, 30
"""How far off, in radians and in steps, the rotations of a limited joint may be."""
_ITERATIONS = 8
_STARTS = np.array([v for v in product((-1, 0, 1), repeat=3) if v > (0, 0, 0)], dtype=np.float64)
_HINGE = 1e-6
_BITS = range(4, 41, 4)
_WORSE = 1.02
_CLOSE = 0.01


@dataclass(frozen=True, slots=True)
class _Motion:
    """The rotations of a joint in n frames."""

    columns: tuple[int, ...]
    axes: tuple[int, ...]
    """Per column: 0 to 2, x to z."""
    rotation: Floats
    """(n, 3, 3)."""
    turning: Floats
    """(n, 3, 3): per column, the axis of its turn as the parent sees it."""
    steps: Floats
    """(3,) radians: how fine the columns' numbers are."""
    moves: Floats
    """(3,): log2 of how many steps the columns' second differences have."""


@dataclass(frozen=True, slots=True)
class _Limit:
    """u' R v = c, by which one of a joint's angles follows from one or both of the others."""

    u: Floats
    v: Floats
    c: float
    sources: tuple[int, ...]
    target: int
    gain: float
    """Bits per number."""


def find_joints(
    values: Floats, columns: Sequence[Column], steps: Floats, predicted: Sequence[int]
) -> list[Coupling]:
    """Find couplings of the angles of one joint; ``steps`` (C,) is how fine the numbers are."""
    motions = [m for m in _motions(values, columns, steps, predicted) if _is_limited(m)]
    if not motions:
        return []
    found: list[Coupling] = []
    rotations = np.stack([motion.rotation for motion in motions])
    for motion, u, v in zip(motions, *_directions(rotations), strict=True):
        limits = [_limit(motion, u, v, target) for target in range(3)]
        best = max([limits[:1], limits[1:2], limits[2:], *_hinges(motion)], key=_gain)
        if _gain(best) < _LEAST_GAIN * len(best):
            continue
        couplings = [_coupling(motion, limit) for limit in best]
        size = sum(_OTHER_BITS + _bits(coupling) for coupling in couplings)
        if _REAL_GAIN * _gain(best) * len(values) > size:
            found += couplings
    return found


def _is_limited(motion: _Motion) -> bool:
    """Rule out quickly most joints that turn freely."""
    vectors = motion.rotation.reshape(-1, 9)
    least = np.linalg.eigvalsh(vectors.T @ vectors)[0] / len(vectors)
    return bool(least <= max(_NEAR, _NEAR_STEPS * motion.steps.max()) ** 2)


def _gain(limits: Sequence[_Limit]) -> float:
    return sum(limit.gain for limit in limits)


def _bits(coupling: Coupling) -> int:
    """Give the bits that the parameters take in the header."""
    writer = Writer()
    for parameter in coupling.parameters:
        writer.signed(parameter)
    return 8 * len(writer.data)


def _motions(
    values: Floats, columns: Sequence[Column], steps: Floats, predicted: Sequence[int]
) -> Iterator[_Motion]:
    """Give the joints with three angles."""
    # The first frame is often of another pose.
    rows = np.arange(3, len(values), max(len(values) // _MOST_FRAMES, 1))
    if len(rows) < _LEAST_FRAMES:
        return
    for joint, group in groupby(predicted, lambda column: columns[column].joint):
        own = [c for c in group if columns[c].kind in ("rx", "ry", "rz")]
        if joint < 0 or len(own) != 3:
            continue
        now, before, long_before = (values[np.ix_(rows - age, np.array(own))] for age in range(3))
        if not (np.abs(now) < 1e4).all():
            continue
        axes = tuple("xyz".index(columns[c].kind[1]) for c in own)
        turns = [_turn(axis, now[:, i]) for i, axis in enumerate(axes)]
        first_two = turns[0] @ turns[1]
        turning = [np.eye(3)[axes[0]] + 0 * now, turns[0][:, :, axes[1]], first_two[:, :, axes[2]]]
        jumps = np.abs(now - 2 * before + long_before) / steps[own]
        yield _Motion(
            tuple(own),
            axes,
            first_two @ turns[2],
            np.stack(turning, axis=1),
            np.radians(steps[own]),
            np.log2(jumps + _USUAL_STEPS).mean(axis=0),
        )


def _turn(axis: int, angles: Floats) -> Floats:
    """Give the rotations about a coordinate axis: (n, 3, 3)."""
    turns = np.zeros((len(angles), 3, 3))
    sine, cosine = np.sin(np.radians(angles)), np.cos(np.radians(angles))
    y, z = (axis + 1) % 3, (axis + 2) % 3
    turns[:, axis, axis] = 1
    turns[:, y, y] = turns[:, z, z] = cosine
    turns[:, y, z], turns[:, z, y] = -sine, sine
    return turns


def _directions(rotations: Floats) -> tuple[Floats, Floats]:
    """Give, per joint of (J, n, 3, 3), the unit vectors u, v for which u' R v stays closest to 0.

    Gauss and Newton's method on the mean of vec R (vec R)', from many starts at once.
    """
    count, frames = rotations.shape[:2]
    vectors = rotations.reshape(count, frames, 9)
    square = np.swapaxes(vectors, 1, 2) @ vectors / frames
    starts = _STARTS / np.linalg.norm(_STARTS, axis=1, keepdims=True)
    v = np.repeat(starts[np.newaxis], count, axis=0)
    parts = square.reshape(count, 3, 3, 3, 3)
    u = np.linalg.eigh(np.einsum("jiakb,sa,sb->jsik", parts, starts, starts))[1][..., 0]
    for _ in range(_ITERATIONS):
        along_u, along_v = _tangents(u), _tangents(v)
        slopes = np.concatenate(
            [
                (along_u[..., :, np.newaxis, :] * v[..., np.newaxis, :, np.newaxis]),
                (u[..., :, np.newaxis, np.newaxis] * along_v[..., np.newaxis, :, :]),
            ],
            axis=-1,
        ).reshape(count, -1, 9, 4)
        both = _both(u, v)
        known = square[:, np.newaxis] @ slopes
        curve = np.swapaxes(slopes, -1, -2) @ known
        slope = np.einsum("jsat,jsa->jst", known, both)
        damping = 1e-13 + 1e-3 * _cost(square, both)
        curve += np.eye(4) * damping[..., np.newaxis, np.newaxis]
        step = -np.linalg.solve(curve, slope[..., np.newaxis])[..., 0]
        step *= np.minimum(1, 0.7 / (np.linalg.norm(step, axis=-1, keepdims=True) + 1e-30))
        u = _unit(u + np.einsum("jsit,jst->jsi", along_u, step[..., :2]))
        v = _unit(v + np.einsum("jsit,jst->jsi", along_v, step[..., 2:]))
    best = _cost(square, _both(u, v)).argmin(axis=1)
    rows = np.arange(count)
    return u[rows, best], v[rows, best]


def _both(u: Floats, v: Floats) -> Floats:
    return (u[..., :, np.newaxis] * v[..., np.newaxis, :]).reshape(*u.shape[:-1], 9)


def _cost(square: Floats, both: Floats) -> Floats:
    return np.asarray(((both @ square) * both).sum(axis=-1))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _tangents(vectors: Floats) -> Floats:
    """Give two unit vectors across each, (..., 3, 2)."""
    apart = np.where(np.abs(vectors[..., :1]) < 0.8, [1.0, 0, 0], [0, 1.0, 0])
    across = _unit(np.cross(vectors, apart))
    return np.stack([across, np.cross(vectors, across)], axis=-1)


def _hinges(motion: _Motion) -> Iterator[list[_Limit]]:
    """Give the pairs of limits of a joint that turns about one axis: R v = u."""
    lefts, sizes, rights = np.linalg.svd(motion.rotation.mean(axis=0))
    if 1 - sizes[0] > _HINGE:
        return
    u, v = lefts[:, 0], rights[0]
    units = np.eye(3)
    for source, target in ((0, 1), (1, 0), (1, 2), (2, 1)):
        rest = 3 - source - target
        # The turn that is neither does not matter where u or v is its axis.
        axis = motion.axes[rest]
        left, right = (u, units[axis]) if rest == 2 else (units[axis], v)
        c = float(v[axis] if rest == 2 else u[axis])
        across = _unit(np.cross(motion.turning[:, rest], u).sum(axis=0) + 1e-30)
        yield [
            _limit(motion, left, right, target, (source,), c),
            _limit(motion, across, v, rest, (source, target), float(across @ u)),
        ]


def _limit(
    motion: _Motion,
    u: Floats,
    v: Floats,
    target: int,
    sources: tuple[int, ...] = (),
    c: float = 0,
) -> _Limit:
    """Give a limit and what it predicts for the target."""
    sources = sources or tuple(i for i in range(3) if i != target)
    moved = motion.rotation @ v
    off = moved @ u - c
    # The triple product of the axis, R v and u: how u' R v follows the target's angle.
    axis = motion.turning[:, target]
    (x, y, z), (a, b, d) = axis.T, moved.T
    slopes = u[0] * (y * d - z * b) + u[1] * (z * a - x * d) + u[2] * (x * b - y * a)
    off_steps = np.abs(off) / (np.abs(slopes) + 1e-12) / motion.steps[target]
    gain = float(motion.moves[target] - np.log2(off_steps + _USUAL_STEPS).mean())
    return _Limit(u, v, c, sources, target, gain)


def _coupling(motion: _Motion, limit: _Limit) -> Coupling:
    """Give a limit with u, v, c as multiples of a power of two, with the fewest bits that do."""
    largest = [int(np.abs(vector).argmax()) for vector in (limit.u, limit.v)]
    u, v = limit.u / limit.u[largest[0]], limit.v / limit.v[largest[1]]
    c = limit.c / (limit.u[largest[0]] * limit.v[largest[1]])
    exact = np.array([*u, *v, c])
    products = motion.rotation.reshape(-1, 9)

    def off(told: Floats) -> float:
        rest = products @ np.outer(told[:3], told[3:6]).ravel() - told[6]
        return float(np.sqrt((rest**2).mean()))

    most = _WORSE * off(exact) + _CLOSE * float(motion.steps.min())
    bits, whole = 0, exact
    for bits in _BITS:
        whole = np.rint(exact * 2.0**bits)
        if off(whole / 2.0**bits) <= most:
            break
    axes = sum(axis * 3**i for i, axis in enumerate(motion.axes))
    turns = limit.target + 3 * limit.sources[0]
    shape = axes + 27 * (turns + 9 * (largest[0] + 3 * largest[1]))
    kept = np.delete(whole, [largest[0], 3 + largest[1]])
    return Coupling(
        CouplingKind.JOINT,
        tuple(motion.columns[i] for i in limit.sources),
        (motion.columns[limit.target],),
        (shape, bits, *(int(value) for value in kept)),
    )
