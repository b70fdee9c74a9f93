"""Patterns of segments: K-means whose K grows until the error is small enough."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
LARGEST, MEAN = "max", "mean"
_ROUNDS = 100
_STEPS = 2
"""Of Lloyd's algorithm before K grows again; it goes on from the clusters that there are."""
_AT_ONCE = 2**24
MOST_PATTERNS = 4096
_WITHIN = 0.7
"""Of the threshold: what each of two steps may use, as their errors are about at right angles."""


def nearest(points: Array, centres: Array) -> tuple[Indices, Array]:
    """Give the nearest centre of each point, and how far it is: (S,) and (S,)."""
    own = np.empty(len(points), dtype=np.int64)
    lengths = np.einsum("kn,kn->k", centres, centres)
    step = max(1, _AT_ONCE // max(1, len(centres)))
    for first in range(0, len(points), step):
        part = points[first : first + step]
        own[first : first + step] = (lengths - 2 * part @ centres.T).argmin(axis=1)
    return own, np.linalg.norm(points - centres[own], axis=1)


def means_of(points: Array, own: Indices, count: int) -> Array:
    """Give the means of clusters, (K, n); clusters without points are left out."""
    order = np.argsort(own, kind="stable")
    sizes = np.bincount(own, minlength=count)
    starts = np.cumsum(sizes) - sizes
    used = sizes > 0
    sums = np.add.reduceat(points[order], starts[used], axis=0)
    means: Array = np.divide(sums, sizes[used, None])
    return means


def patterns_of(
    points: Array,
    threshold: float,
    *,
    metric: str = LARGEST,
    clusters: int = 10,
    most: int = MOST_PATTERNS,
) -> Array:
    """Cluster segments: the means of the clusters, (K, n).

    Parameters
    ----------
    points
        (S, n): normalised segments, scaled so that distances are in units of the threshold.
    threshold
        The largest ``max`` or ``mean`` error; see ``metric``.
    metric
        ``max``: the largest distance of a point from its centre (Eq. 2). ``mean``: the root of the
        mean squared distance (Eq. 1 has no root, and so is no length).
    clusters
        K at first.
    most
        K at last, whatever the error.

    """
    if len(points) == 0:
        return np.zeros((1, points.shape[1]))
    clusters = min(clusters, len(points))
    centres: Array = points[np.linspace(0, len(points) - 1, clusters).astype(int)]
    for _ in range(_ROUNDS):
        for _ in range(_STEPS):
            own, away = nearest(points, centres)
            centres = means_of(points, own, len(centres))
        own, away = nearest(points, centres)
        more = _worst(own, away, threshold) if metric == LARGEST else _far(away, threshold, centres)
        more = more[: max(0, most - len(centres))]
        if not len(more):
            break
        centres = np.concatenate([centres, points[more]])
    return centres


def patterns_in_steps(
    clips: Sequence[Array],
    threshold: float,
    *,
    metric: str = LARGEST,
    clusters: int = 10,
) -> Array:
    """Cluster the segments of each clip, and then the means across clips: (K, n).

    The paper leaves this for later (section 6). A segment may be further than the threshold from
    its pattern, by up to 1.4 of it.
    """
    own = [
        patterns_of(points, _WITHIN * threshold, metric=metric, clusters=clusters)
        for points in clips
        if len(points)
    ]
    every = np.concatenate(own) if own else np.zeros((0, clips[0].shape[1] if clips else 0))
    return patterns_of(every, _WITHIN * threshold, metric=metric, clusters=clusters)


def _worst(own: Indices, away: Array, threshold: float) -> Indices:
    """Give the point furthest from its centre of each cluster with an error that is too large."""
    beyond = np.flatnonzero(away > threshold)
    order = beyond[np.lexsort((-away[beyond], own[beyond]))]
    first: Indices = order[np.diff(own[order], prepend=-1) != 0]
    return first


def _far(away: Array, threshold: float, centres: Array) -> Indices:
    """Give the furthest points, where the mean error is too large: a quarter more clusters."""
    if np.sqrt(np.mean(away * away)) <= threshold:
        return np.empty(0, dtype=np.int64)
    furthest = np.argsort(-away, kind="stable")[: max(1, len(centres) // 4)]
    wrong: Indices = furthest[away[furthest] > 0]
    return wrong
