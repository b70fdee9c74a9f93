"""Fits of the laws of core/exact/law.cpp, which docs/exact_laws.md explains.

`y` axes are numbered from the parent of a chain, y0, to its last joint, y3.
"""

from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEGREE = 4
# A branch holds where y2 lies within this of its plane and ratio: what rounded angles leave.
HOLDS = 3e-6
MOST_SOLVED = 3000  # frames in one least-squares fit of a branch


class Branch(NamedTuple):
    """One branch of the y law: polynomials of DEGREE in three bends, coefficients by degree."""

    near: Array  # (35,) g
    root: Array  # (35,) h


class Chain(NamedTuple):
    """The axes of a chain of three joints over F frames, seen by the parent of the first."""

    first: Array  # (F, 3, 3) rotation matrices
    second: Array
    third: Array


def rotations(degrees: Array) -> Array:
    """Give Rz Ry Rx of (F, 3) degrees as (F, 3, 3)."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(np.radians(degrees.T)), np.cos(np.radians(degrees.T))
    rows = [
        [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
        [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def chain(angles: Array) -> Chain:
    """Chain (F, 9) degrees: x, y, z of three joints."""
    first = rotations(angles[:, :3])
    second = first @ rotations(angles[:, 3:6])
    return Chain(first, second, second @ rotations(angles[:, 6:9]))


def dot(a: Array, b: Array) -> Array:
    """Give the inner product of vectors in the last axis."""
    product: Array = (a * b).sum(-1)
    return product


def powers(variables: Array, degree: int) -> Array:
    """Give the monomials of (F, V) variables by degree: 1, a, b, c, aa, ab, ..."""
    chosen = [
        np.prod(variables[:, list(term)], axis=1)
        for d in range(degree + 1)
        for term in combinations_with_replacement(range(variables.shape[1]), d)
    ]
    return np.stack(chosen, axis=1)


def y_axes(axes: Chain) -> tuple[Array, Array, Array, Array]:
    """Give y0 to y3, (F, 3) each."""
    y1, y2, y3 = (rotation[:, :, 1] for rotation in axes)
    return np.broadcast_to([0.0, 1.0, 0.0], y1.shape), y1, y2, y3


def total_bend(axes: Chain) -> Array:
    """Give the sum of the three joints' bends, radians."""
    y = y_axes(axes)
    steps = [np.arccos(np.clip(dot(y[i], y[i + 1]), -1, 1)) for i in range(3)]
    total: Array = np.sum(steps, axis=0)
    return total


def y_bends(axes: Chain) -> Array:
    """Give a, b, c of the y law, (F, 3)."""
    y0, y1, _, y3 = y_axes(axes)
    return np.stack([1 - dot(y0, y1), 1 - dot(y0, y3), 1 - dot(y1, y3)], axis=1)


def y_system(axes: Chain, degree: int) -> tuple[Array, Array]:
    """Give A (F, 3, 2P) and b (F, 3) with A (g, h) = b where y2 is along y1 + g y3 + h y0."""
    y0, y1, y2, y3 = y_axes(axes)
    terms = powers(y_bends(axes), degree)[:, None, :]
    near, root = np.cross(y2, y3)[:, :, None], np.cross(y2, y0)[:, :, None]
    return np.concatenate([near * terms, root * terms], axis=2), -np.cross(y2, y1)


def robust(system: Array, wanted: Array, rounds: int, share: float) -> Array:
    """Fit by least squares whose weights fall with the error beyond that of a share of the frames.

    `system` is (F, K, N), `wanted` (F, K).
    """
    scale = np.abs(system).mean(axis=(0, 1)) + 1e-30
    weights = np.ones(len(system))
    solved = np.zeros(system.shape[2])
    for _ in range(rounds):
        a = (system / scale * weights[:, None, None]).reshape(-1, system.shape[2])
        solved = np.linalg.lstsq(a, (wanted * weights[:, None]).ravel(), rcond=1e-13)[0]
        error = np.abs(system / scale @ solved - wanted).max(axis=1)
        weights = 1 / (1 + (error / max(3e-7, float(np.quantile(error, share)))) ** 2)
    coefficients: Array = solved / scale
    return coefficients


def y_errors(axes: Chain, branch: Branch, degree: int = DEGREE) -> Array:
    """Give how far y2 is from what a branch has, (F,)."""
    y0, y1, y2, y3 = y_axes(axes)
    terms = powers(y_bends(axes), degree)
    near, root = terms @ branch.near, terms @ branch.root
    along = y1 + near[:, None] * y3 + root[:, None] * y0
    error: Array = np.abs(np.cross(y2, along)).max(axis=1)
    return error


def spread(frames: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Choose at most `most`, evenly."""
    chosen: NDArray[np.intp] = frames[
        np.linspace(0, len(frames) - 1, min(most, len(frames))).astype(np.intp)
    ]
    return chosen


def at(axes: Chain, frames: NDArray[np.intp]) -> Chain:
    """Give some frames."""
    return Chain(*(rotation[frames] for rotation in axes))


def seed(axes: Chain, rest: NDArray[np.intp]) -> NDArray[np.intp]:
    """Find the frames of like total bend of which most follow one polynomial of degree 2."""
    ordered = rest[np.argsort(total_bend(at(axes, rest)), kind="stable")]
    width = max(400, len(ordered) // 12)
    best, found = 0, rest[:0]
    for start in range(0, len(ordered), width):
        band = ordered[start : start + width]
        if len(band) < width // 2:
            continue
        chosen = at(axes, spread(band, 1000))
        solved = robust(*y_system(chosen, 2), rounds=12, share=0.3)
        error = y_errors(at(axes, band), Branch(*np.split(solved, 2)), 2)
        if (error < HOLDS).sum() > best:
            best, found = int((error < HOLDS).sum()), band[error < 2 * HOLDS]
    return found


def grow(axes: Chain, rest: NDArray[np.intp], seeds: NDArray[np.intp]) -> Branch:
    """Fit a branch to its seeds, then to all frames that follow it, with growing degree."""
    inside = np.isin(rest, seeds)
    left = at(axes, rest)
    branch = Branch(np.zeros(0), np.zeros(0))
    for degree in range(2, DEGREE + 1):
        for turn in range(4):
            most = 4 * MOST_SOLVED if (degree, turn) == (DEGREE, 3) else MOST_SOLVED
            chosen = at(axes, spread(rest[inside], most))
            solved = robust(*y_system(chosen, degree), rounds=4, share=0.5)
            branch = Branch(*np.split(solved, 2))
            inside = y_errors(left, branch, degree) < (HOLDS if turn > 1 else 3 * HOLDS)
    return branch


def branches(axes: Chain, most: int) -> list[Branch]:
    """Find the branches of the y law one after the other, each in what those before leave."""
    rest = np.arange(len(axes.first))
    found: list[Branch] = []
    while len(found) < most:
        seeds = seed(axes, rest)
        if len(seeds) < 60:
            break
        found.append(grow(axes, rest, seeds))
        rest = rest[y_errors(at(axes, rest), found[-1]) >= HOLDS]
    return found


def twists(a: Array, b: Array) -> Array:
    """Give the turn about y left of the way from a to b after the shortest swing of y, radians."""
    y, onto, x = a[:, :, 1], b[:, :, 1], a[:, :, 0]
    axis, cosine = np.cross(y, onto), dot(y, onto)[:, None]
    swung = x * cosine + np.cross(axis, x) + axis * (dot(axis, x)[:, None] / (1 + cosine))
    return np.arctan2(dot(swung, b[:, :, 2]), dot(swung, b[:, :, 0]))


def twist_terms(axes: Chain) -> Array:
    """Give the (F, 22) terms of the third joint's twist."""
    y0, y1, y2, _ = y_axes(axes)
    bends = np.stack([1 - dot(y0, y1), 1 - dot(y0, y2), 1 - dot(y1, y2)], axis=1)
    parent = np.broadcast_to(np.eye(3), axes.first.shape)
    odd = (twists(parent, axes.first), twists(axes.first, axes.second), dot(y0, np.cross(y1, y2)))
    linear = [factor[:, None] * powers(bends, 1) for factor in odd]
    cubic = [
        odd[0] ** i * odd[1] ** j * odd[2] ** (3 - i - j) for i in range(4) for j in range(4 - i)
    ]
    return np.concatenate([*linear, np.stack(cubic, axis=1)], axis=1)


def twist_law(axes: Chain) -> Array:
    """Fit the third joint's twist."""
    wanted = twists(axes.second, axes.third)
    return robust(twist_terms(axes)[:, None, :], wanted[:, None], rounds=30, share=0.4)


def middle_terms(axes: Chain) -> Array:
    """Give the (F, 12) terms of the second joint's twist."""
    y0, y1, y2, _ = y_axes(axes)
    bends = np.stack([1 - dot(y0, y1), 1 - dot(y0, y2), 1 - dot(y1, y2)], axis=1)
    odd = (
        twists(np.broadcast_to(np.eye(3), axes.first.shape), axes.first),
        dot(y0, np.cross(y1, y2)),
    )
    linear = [factor[:, None] * powers(bends, 1) for factor in odd]
    cubic = [odd[0] ** i * odd[1] ** (3 - i) for i in range(4)]
    return np.concatenate([*linear, np.stack(cubic, axis=1)], axis=1)


def middle_law(axes: Chain) -> Array:
    """Fit the second joint's twist, which the law only has where the chain is at ease."""
    wanted = twists(axes.first, axes.second)
    return robust(middle_terms(axes)[:, None, :], wanted[:, None], rounds=30, share=0.25)


def thumb(hand: Array, side: int) -> Array:
    """Give x, z of the thumb, (F, 2) degrees, from x, z of the hand."""
    turn = np.radians(hand[:, 0])
    along = np.stack(
        [
            np.full(len(turn), 0.3),
            0.5 * np.cos(turn) + np.sin(turn),
            np.cos(turn) - 0.5 * np.sin(turn),
        ]
    )
    x = np.degrees(np.arcsin(along[1] / np.sqrt(1.34)))
    z = hand[:, 1] + side * (45 - np.degrees(np.arctan2(along[0], along[2])))
    return np.stack([x, z], axis=1)
