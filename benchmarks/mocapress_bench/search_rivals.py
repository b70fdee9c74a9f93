"""The methods of others that the QSSD paper compares its retrieval with, and motion words.

Each is written from its paper, for whole clips that are ranked: what a method does to find
stretches of long takes is left out. docs/papers/qssd.md says what was chosen on which clips.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2

from mocapress_bench.search_alignment import Clips
from mocapress_bench.search_bodies import Bodies
from mocapress_bench.search_data import Take

Array = NDArray[np.float64]
_EVERY = 2
"""Aligned are 15 frames a second."""


@dataclass(frozen=True, slots=True)
class Index:
    """What a method keeps of clips, and how it ranks them."""

    distances: Callable[[int], Array]
    """Of the clip with this number from all clips, (N,)."""
    bytes: float
    """Kept of a clip, on average."""
    mirrored: Callable[[int], Array] | None = None
    """The distances of the clip with left and right exchanged, where a method can tell them."""
    either: Callable[[int], Array] | None = None
    """The distances of that or of its mirror image; without it, the smaller one of each clip."""


def weighted_pca(bodies: Bodies, seed: int) -> Index:  # noqa: ARG001
    """Index by weighted PCA (K. Forbes, E. Fiume: An efficient search algorithm, 2005).

    Logarithms of joints' turns, weighted by how much of the body a joint moves, in the space of the
    principal components of all frames that hold nine tenths of the variance; aligned by dynamic
    time warping.
    """
    weights = np.sqrt(bodies.weights)[:, None]
    rows = principal([logs[::_EVERY] * weights for logs in bodies.logs], 0.9)
    clips = Clips(rows, euclidean)
    return Index(lambda i: clips.distances(rows[i]), _bytes(rows))


def match_webs(takes: Sequence[Take], seed: int) -> Index:  # noqa: ARG001
    """Index for match webs (L. Kovar, M. Gleicher: Automated extraction, 2004).

    Clouds of the joints' points in three frames side by side, at the turn about the vertical
    and the move along the floor that bring them nearest; aligned by dynamic time warping.
    """
    rows = [clouds(take) for take in takes]
    clips = Clips(rows, between_clouds)
    return Index(lambda i: clips.distances(rows[i]), _bytes(rows))


def clouds(take: Take) -> Array:
    """Give the points of three frames side by side, (F, 3 J, 3), centred along the floor."""
    places = take.places[::_EVERY]
    around = np.clip(np.arange(len(places))[:, None] + (-1, 0, 1), 0, len(places) - 1)
    points = places[around].reshape(len(places), -1, 3)
    centred: Array = points - points.mean(axis=1, keepdims=True) * np.array([1, 0, 1])
    return centred


def between_clouds(a: Array, b: Array) -> Array:
    """Give root mean squared distances of clouds, (A, P, 3) and (B, P, 3), at their best turns."""
    ax, ay, az = np.moveaxis(a, 2, 0)
    bx, by, bz = np.moveaxis(b, 2, 0)
    along = ax @ bx.T + az @ bz.T
    across = ax @ bz.T - az @ bx.T
    squares = (a**2).sum(axis=(1, 2))[:, None] + (b**2).sum(axis=(1, 2))
    left = squares - 2 * ay @ by.T - 2 * np.hypot(along, across)
    distances: Array = np.sqrt(np.maximum(left, 0) / a.shape[1])
    return distances


def motion_patterns(bodies: Bodies, seed: int) -> Index:
    """Index by motion patterns (Z. Deng, Q. Gu, Q. Li: Perceptually consistent retrieval, 2009).

    The motion of each part of the body, from a limb to the whole, is cut where it is slowest, and
    the pieces are grouped into patterns. A clip is a string of patterns for each part; strings are
    aligned, and the parts' distances added up, larger parts counting more.
    """
    clip_count = len(bodies.logs)
    total = np.zeros((clip_count, clip_count))
    kept = 0.0
    for joints, weight in bodies.parts:
        logs = [own[:, joints].reshape(len(own), -1) for own in bodies.logs]
        pieces = [_pieces(own) for own in logs]
        strings = [
            np.array([_resampled(own[a:b], 8) for a, b in cut])
            for own, cut in zip(logs, pieces, strict=True)
        ]
        rows = principal(strings, 0.9)
        every = np.concatenate(rows)
        count = max(2, min(len(every) // 6, 60))
        centres, own = kmeans2(every, count, minit="++", seed=seed)
        ends = np.cumsum([len(string) for string in rows])
        words = [w[:, None].astype(float) for w in np.split(own, ends[:-1])]
        clips = Clips(words, partial(_between_words, euclidean(centres, centres)))
        part = np.array([clips.distances(word) for word in words])
        total += weight * part / max(float(part.mean()), 1e-12)
        kept += sum(len(word) for word in words) / clip_count
    return Index(lambda i: total[i], kept)


def motion_index_tree(bodies: Bodies, seed: int) -> Index:  # noqa: ARG001
    """Index by a motion index tree (F. Liu, Y. Zhuang, F. Wu, Y. Pan, 2003).

    Key frames are aligned, one level of the skeleton after the other: clips are grouped by the
    joints near the root, each group by the next joints, and so on. Clips in the query's own group
    come first, then those that parted from it on the last level, and so on up; among these, the
    nearest of all joints.
    """
    rows = [key_frames(logs[::_EVERY]) for logs in bodies.logs]
    clips = Clips(rows, lambda a, b: euclidean(a.reshape(len(a), -1), b.reshape(len(b), -1)))
    near = np.array([clips.distances(row) for row in rows])
    groups = np.zeros(len(rows), dtype=np.int64)
    shared = np.zeros((len(rows), len(rows)))
    for joints in bodies.levels:
        own = [row[:, joints].reshape(len(row), -1) for row in rows]
        level = Clips(own, euclidean)
        apart = np.array([level.distances(row) for row in own])
        groups = _parted(groups, apart)
        shared += groups[:, None] == groups
    depth = near / (2 * near.max()) - shared
    return Index(lambda i: depth[i], _bytes(rows))


def motion_words(bodies: Bodies, seed: int) -> Index:
    """Index by motion words (A. Aristidou et al.: Deep motifs, 2018), without their network.

    Windows of 16 frames, principal components of them, and the nearest of 100 words; clips are
    compared by how often they use each word. In the paper a network learns the windows' space.
    """
    length, step = 16, 4
    windows = []
    for logs in bodies.logs:
        own = logs.reshape(len(logs), -1)
        if len(own) < length:
            own = own[np.minimum(np.arange(length), len(own) - 1)]
        firsts = range(0, len(own) - length + 1, step)
        windows.append(np.array([own[i : i + length].ravel() for i in firsts]))
    rows = principal(windows, 0.9)
    every = np.concatenate(rows)
    count = max(2, min(100, len(every) // 4))
    _, words = kmeans2(every, count, minit="++", seed=seed)
    ends = np.cumsum([len(row) for row in rows])
    used = np.array([np.bincount(own, minlength=count) for own in np.split(words, ends[:-1])])
    rare = np.log(len(used) / np.maximum((used > 0).sum(axis=0), 1)) + 1
    frequent = np.sqrt(used / used.sum(axis=1, keepdims=True) * rare)
    frequent /= np.linalg.norm(frequent, axis=1, keepdims=True)
    return Index(lambda i: 1 - frequent @ frequent[i], 2.0 * count)


def euclidean(a: Array, b: Array) -> Array:
    """Give distances of all rows, (A, D) and (B, D) to (A, B)."""
    squares = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1) - 2 * a @ b.T
    distances: Array = np.sqrt(np.maximum(squares, 0))
    return distances


def principal(rows: Sequence[Array], part: float) -> list[Array]:
    """Give rows in the space of the principal components that hold a part of the variance."""
    flat = [own.reshape(len(own), -1) for own in rows]
    every = np.concatenate(flat)
    middle = every.mean(axis=0)
    left = every - middle
    if len(left) < left.shape[1]:
        _, lengths, ways = np.linalg.svd(left, full_matrices=False)
        values = lengths**2
    else:
        values, ways = np.linalg.eigh(left.T @ left)
        values, ways = values[::-1], ways.T[::-1]
    held = np.cumsum(values) / max(float(values.sum()), 1e-300)
    count = int(np.searchsorted(held, part)) + 1
    return [(own - middle) @ ways[:count].T for own in flat]


def _between_words(apart: Array, a: Array, b: Array) -> Array:
    """Give distances of words that are known by their numbers, (A, 1) and (B, 1)."""
    costs: Array = apart[np.ix_(a[:, 0].astype(int), b[:, 0].astype(int))]
    return costs


def key_frames(logs: Array, most: int = 12) -> Array:
    """Choose frames between which joints have turned by the same amount."""
    flat = logs.reshape(len(logs), -1)
    moved = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(flat, axis=0), axis=1))])
    wanted = np.linspace(0, moved[-1], min(most, len(logs)))
    return logs[np.minimum(np.searchsorted(moved, wanted), len(logs) - 1)]


def _parted(groups: NDArray[np.int64], apart: Array) -> NDArray[np.int64]:
    """Part groups: a clip joins the nearest first clip of a group within reach, or begins one."""
    made = np.full(len(groups), -1, dtype=np.int64)
    new = 0
    reach = float(np.quantile(apart, 0.8))
    for group in np.unique(groups):
        firsts: list[int] = []
        for clip in np.flatnonzero(groups == group):
            nearest = min(firsts, key=lambda first: apart[first, clip], default=None)
            if nearest is None or apart[nearest, clip] > reach:
                firsts.append(int(clip))
                made[clip] = new
                new += 1
            else:
                made[clip] = made[nearest]
    return made


def _pieces(rows: Array, least: int = 8) -> list[tuple[int, int]]:
    """Cut where the motion is slowest, into pieces of at least so many frames."""
    speed = np.linalg.norm(np.diff(rows, axis=0, prepend=rows[:1]), axis=1)
    smooth = np.convolve(np.pad(speed, 2, mode="edge"), np.ones(5) / 5, mode="valid")
    slow = np.flatnonzero((smooth[1:-1] <= smooth[:-2]) & (smooth[1:-1] < smooth[2:])) + 1
    cuts = [0]
    for place in slow:
        if place - cuts[-1] >= least and len(rows) - place >= least:
            cuts.append(int(place))
    return list(zip(cuts, [*cuts[1:], len(rows)], strict=True))


def _resampled(rows: Array, count: int) -> Array:
    wanted = np.linspace(0, len(rows) - 1, count)
    before = np.floor(wanted).astype(int)
    after = np.minimum(before + 1, len(rows) - 1)
    mixed: Array = rows[before] + (wanted - before)[:, None] * (rows[after] - rows[before])
    return mixed


def _bytes(rows: Sequence[Array]) -> float:
    return 4 * sum(row.size for row in rows) / len(rows)
