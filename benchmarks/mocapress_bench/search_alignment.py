"""Dynamic time warping of a query with many clips at a time."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Costs = Callable[[Array, Array], Array]
"""Costs of all frames of one clip with all frames of another, (A, ...) and (B, ...) to (A, B)."""

_TOGETHER = 16


class Clips:
    """Clips as rows of features, to be aligned with queries."""

    def __init__(self, rows: Sequence[Array], costs: Costs) -> None:
        """Take (F, ...) features of each clip."""
        self._rows = rows
        self._costs = costs
        self._order = np.argsort([len(own) for own in rows], kind="stable")

    def distances(self, query: Array) -> Array:
        """Align a query with every clip: mean cost along the best path, (N,).

        A step in one clip alone counts once, in both twice, so that all paths are equally long.
        """
        found = np.empty(len(self._rows))
        for first in range(0, len(self._order), _TOGETHER):
            some = self._order[first : first + _TOGETHER]
            lengths = np.array([len(self._rows[i]) for i in some])
            costs = self._costs(query, np.concatenate([self._rows[i] for i in some]))
            ends = np.cumsum(lengths)
            frames = np.minimum(np.arange(lengths.max()), lengths[:, None] - 1)
            frames += (ends - lengths)[:, None]
            found[some] = _aligned(costs[:, frames.T], lengths)
        return found


def _aligned(costs: Array, lengths: NDArray[np.int64]) -> Array:
    """Align (A, B, N) costs, of N clips padded to B frames."""
    a, b, count = costs.shape
    paths = np.full((a + 1, b + 1, count), np.inf)
    paths[0, 0] = 0
    for diagonal in range(2, a + b + 1):
        i = np.arange(max(1, diagonal - b), min(a, diagonal - 1) + 1)
        j = diagonal - i
        own = costs[i - 1, j - 1]
        alone = np.minimum(paths[i - 1, j], paths[i, j - 1]) + own
        paths[i, j] = np.minimum(alone, paths[i - 1, j - 1] + 2 * own)
    ends: Array = paths[a, lengths, np.arange(count)] / (a + lengths)
    return ends


def stretches(costs: Array) -> tuple[Array, NDArray[np.int64]]:
    """Find where a query of A frames may end in a take of B: subsequence alignment.

    Parameters
    ----------
    costs
        (A, B). Steps are one frame in both, one and two, or two and one (Müller 2007).

    Returns
    -------
    tuple
        For every frame of the take, the mean cost of the best path that ends there, and the frame
        in which it begins.

    """
    a, b = costs.shape
    paths = np.full((a + 2, b + 2), np.inf)
    begins = np.zeros((a + 2, b + 2), dtype=np.int64)
    paths[2, 2:] = costs[0]
    begins[2, 2:] = np.arange(b)
    frames = np.arange(b)
    for i in range(1, a):
        row = i + 2
        from_ = [(row - 1, frames + 1, 1.0), (row - 1, frames, 1.0), (row - 2, frames + 1, 2.0)]
        totals = np.stack([paths[r, f] + by * costs[i] for r, f, by in from_])
        best = totals.argmin(axis=0)
        paths[row, 2:] = totals[best, frames]
        starts = np.stack([begins[r, f] for r, f, _ in from_])
        begins[row, 2:] = starts[best, frames]
    return paths[a + 1, 2:] / a, begins[a + 1, 2:]


def separate(ends: Array, begins: NDArray[np.int64], most: int) -> list[tuple[float, int, int]]:
    """Choose the best stretches that share less than half of the shorter one: cost, from, to."""
    chosen: list[tuple[float, int, int]] = []
    for end in np.argsort(ends, kind="stable"):
        if len(chosen) == most or not np.isfinite(ends[end]):
            break
        first, last = int(begins[end]), int(end) + 1
        if all(
            2 * (min(last, there) - max(first, here)) < min(last - first, there - here)
            for _, here, there in chosen
        ):
            chosen.append((float(ends[end]), first, last))
    return chosen
