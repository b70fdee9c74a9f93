"""Where motion is cut into segments, and segments of one length."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
DISTANCE, RATIO, PCA = "distance", "ratio", "pca"
_LOOK_AHEAD = 48
_PCA_FRAMES = 24
_PCA_COMPONENTS = 4


def lengths_of(motion: Array, threshold: float, rule: str = DISTANCE) -> Indices:
    """Cut motion into segments: their numbers of frames.

    Parameters
    ----------
    motion
        (F, n): the coordinates of a node, weighted.
    threshold
        Of ``distance`` and ``pca`` a distance in the unit of the motion; of ``ratio`` a number.
    rule
        ``distance``: a frame begins a segment when it is further than the threshold from the
        segment's first frame (section 5). ``ratio``: when it is further from the frame before than
        the threshold times the mean of such distances in the segment (Algorithm 1; the first
        distance of a segment is its first mean). ``pca``: when the mean of the coming 24 frames'
        distances from the space of the segment's first 24 is above the threshold.

    """
    if len(motion) < 2:
        return np.array([1] * len(motion), dtype=np.int64)
    if rule == RATIO:
        return _by_ratio(motion, threshold)
    cuts = [0]
    next_cut = _pca_cut if rule == PCA else _distance_cut
    while (cut := next_cut(motion, cuts[-1], threshold)) < len(motion):
        cuts.append(cut)
    return np.diff(cuts, append=len(motion))


def _distance_cut(motion: Array, key: int, threshold: float) -> int:
    ahead = _LOOK_AHEAD
    while True:
        last = min(key + 1 + ahead, len(motion))
        moved = motion[key + 1 : last] - motion[key]
        beyond = np.einsum("fn,fn->f", moved, moved) > threshold * threshold
        if beyond.any():
            return key + 1 + int(beyond.argmax())
        if last == len(motion):
            return last
        ahead *= 4


def _by_ratio(motion: Array, threshold: float) -> Indices:
    steps = np.abs(np.diff(motion, axis=0)).sum(axis=1).tolist()
    cuts, total, count = [0], 0.0, 0
    for i, step in enumerate(steps):
        if count and step * count > threshold * total:
            cuts.append(i + 1)
            total, count = 0.0, 0
        else:
            total, count = total + step, count + 1
    return np.diff(cuts, append=len(motion))


def _pca_cut(motion: Array, key: int, threshold: float) -> int:
    own = motion[key : key + _PCA_FRAMES]
    if key + _PCA_FRAMES >= len(motion):
        return len(motion)
    middle = own.mean(axis=0)
    axes = np.linalg.svd(own - middle, full_matrices=False)[2][:_PCA_COMPONENTS]
    rest = motion[key + _PCA_FRAMES : key + 16 * _PCA_FRAMES] - middle
    away = np.linalg.norm(rest - rest @ axes.T @ axes, axis=1)
    sums = np.cumsum(np.pad(away, (0, _PCA_FRAMES), mode="edge"))
    means = (sums[_PCA_FRAMES:] - sums[:-_PCA_FRAMES]) / _PCA_FRAMES
    beyond = means > threshold
    cut = int(beyond.argmax()) if beyond.any() else len(rest)
    return key + _PCA_FRAMES + cut


def normalised(motion: Array, lengths: Indices, frames: int) -> Array:
    """Bring segments to one length by linear interpolation, (S, frames, n).

    A segment that is longer is smoothed before, by 1/4, 1/2, 1/4 of neighbouring frames.
    """
    starts = np.cumsum(lengths) - lengths
    last = (starts + lengths - 1)[:, None]
    at = starts[:, None] + (lengths - 1)[:, None] * np.linspace(0, 1, frames)
    before = np.minimum(at.astype(np.int64), last)
    part = (at - before)[..., None]
    smoothed = np.where(lengths > frames, 0.25, 0.0)[:, None, None]

    def taken(index: Indices) -> Array:
        around = motion[np.maximum(index - 1, starts[:, None])]
        around = around + motion[np.minimum(index + 1, last)]
        found: Array = (1 - 2 * smoothed) * motion[index] + smoothed * around
        return found

    after = np.minimum(before + 1, last)
    whole: Array = (1 - part) * taken(before) + part * taken(after)
    return whole
