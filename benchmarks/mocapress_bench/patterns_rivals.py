"""Other ways to code markers, beside the codec ``patterns``: each gives what comes back, and bytes.

All are measured alike: what a way stores is counted as an adaptive arithmetic coder would code it,
or as float32 where it is said so.
"""

import lzma
import zlib
from collections.abc import Callable, Sequence
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from mocapress.codecs.patterns.clustering import nearest, patterns_of

Array = NDArray[np.float64]
Clips = Sequence[int]
"""How many frames each clip of the values has: none of these ways goes across clips."""
Way = Callable[[Array, float, Clips], tuple[Array, float]]
"""From (F, C) values and a step or length to decoded values and bytes."""
_BLOCK = 64
_MOST = 40
"""Of a magnitude that is a symbol of its own; above, an Elias-gamma code follows."""


def coded_bits(numbers: NDArray[np.int64]) -> float:
    """Give the bits of an adaptive arithmetic coder of numbers, each column a context, (n, k).

    With Krichevsky and Trofimov's estimate the code's length depends on the counts alone. Signs
    and what is above the largest symbol are raw.
    """
    magnitudes = np.abs(numbers)
    bits = float((magnitudes > 0).sum())
    beyond = magnitudes[magnitudes >= _MOST] - _MOST + 1
    bits += float((2 * np.floor(np.log2(beyond)) + 1).sum())
    for column in np.minimum(magnitudes, _MOST).T:
        counts = np.bincount(column, minlength=_MOST + 1)
        half, n = 0.5 * len(counts), len(column)
        nats = gammaln(n + half) - gammaln(half) - (gammaln(counts + 0.5) - gammaln(0.5)).sum()
        bits += float(nats) / np.log(2)
    return bits


def _cosines(size: int) -> Array:
    k, t = np.arange(size)[:, None], np.arange(size)
    rows: Array = np.sqrt(2 / size) * np.cos(np.pi * (2 * t + 1) * k / (2 * size))
    rows[0] /= np.sqrt(2)
    return rows


def _blocks(values: Array, clips: Clips, size: int) -> Array:
    """Cut clips into blocks of frames, (B, size, C); the last frame of a clip fills its last."""
    found = []
    for own in np.split(values, np.cumsum(clips)[:-1]):
        more = -len(own) % size
        found.append(np.pad(own, ((0, more), (0, 0)), mode="edge").reshape(-1, size, own.shape[1]))
    return np.concatenate(found)


def _joined(blocks: Array, clips: Clips) -> Array:
    """Put what ``_blocks`` cuts together again, (F, C)."""
    size, first, found = blocks.shape[1], 0, []
    for frames in clips:
        count = ceil(frames / size)
        own = blocks[first : first + count].reshape(count * size, -1)
        found.append(own[:frames])
        first += count
    return np.concatenate(found)


def _dct(values: Array, step: float, clips: Clips) -> tuple[Array, float]:
    """Code each column by blocks of 64 frames, the mean of a block from that of the one before."""
    rows = _cosines(_BLOCK)
    terms = np.einsum("kt,btc->bkc", rows, _blocks(values, clips, _BLOCK)) / step
    whole = (np.sign(terms) * np.floor(np.abs(terms) + 0.4)).astype(np.int64)
    stored = whole.copy()
    stored[:, 0] = np.diff(whole[:, 0], axis=0, prepend=0)
    # Contexts: the term, in all columns alike, as there are many columns and few blocks.
    by_term = stored.transpose(0, 2, 1).reshape(-1, _BLOCK)
    decoded = _joined(np.einsum("kt,bkc->btc", rows, whole * step), clips)
    return decoded, coded_bits(by_term) / 8


def dct(values: Array, step: float, clips: Clips) -> tuple[Array, float]:
    """Code every coordinate alone."""
    return _dct(values, step, clips)


def klt_dct(values: Array, step: float, clips: Clips) -> tuple[Array, float]:
    """Code all coordinates less the first marker's, turned into independent ones; and that one."""
    root = np.tile(values[:, :3], values.shape[1] // 3)
    rest = values - root
    middle = rest.mean(axis=0)
    variances, axes = np.linalg.eigh(np.cov((rest - middle).T))
    kept = variances > (step / 8) ** 2
    axes = axes[:, kept].astype(np.float32).astype(np.float64)
    scores, size = _dct((rest - middle) @ axes, step, clips)
    place, more = _dct(values[:, :3], step / 2, clips)
    decoded = scores @ axes.T + middle + np.tile(place, values.shape[1] // 3)
    return decoded, size + more + 2 * (axes.size + middle.size)


def global_pca(values: Array, share: float, _: Clips) -> tuple[Array, float]:
    """Keep the components that make up a share of the variance, as float32."""
    middle = values.mean(axis=0)
    variances, axes = np.linalg.eigh(np.cov((values - middle).T))
    order = np.argsort(-variances)
    count = 1 + int(np.searchsorted(np.cumsum(variances[order]) / variances.sum(), share))
    own = axes[:, order[:count]]
    scores = (values - middle) @ own
    return scores @ own.T + middle, 4.0 * (scores.size + own.size + middle.size)


def subsampled(values: Array, every: float, clips: Clips) -> tuple[Array, float]:
    """Keep one frame of so many, and the last, as float32, with lines between them."""
    found, size = [], 0.0
    for own in np.split(values, np.cumsum(clips)[:-1]):
        kept = np.unique([*range(0, len(own), int(every)), len(own) - 1])
        times = np.arange(len(own))
        found.append(np.stack([np.interp(times, kept, column[kept]) for column in own.T], axis=1))
        size += 4.0 * kept.size * values.shape[1]
    return np.concatenate(found), size


def arikan(
    values: Array, bound: float, clips: Clips, frames: int = 24, clusters: int = 10
) -> tuple[Array, float]:
    """Arikan 2006 without contacts: Bezier curves over 24 frames, clustered PCA.

    Each run of frames is put where its first marker is at the middle frame. A component is kept
    while the mean distance of control points is above the bound; scores are 16 bits, coded
    adaptively, the axes of clusters float32.
    """
    used = _blocks(values, clips, frames)
    count = len(used)
    origin = np.tile(used[:, frames // 2, :3], values.shape[1] // 3)
    time = np.linspace(0, 1, frames)[:, None]
    curve = np.hstack(
        [(1 - time) ** 3, 3 * time * (1 - time) ** 2, 3 * time**2 * (1 - time), time**3]
    )
    control = np.einsum("pt,ntc->npc", np.linalg.pinv(curve), used - origin[:, None])
    points = control.reshape(count, -1)
    centres = patterns_of(points, 0.0, clusters=clusters, most=clusters)
    own, _ = nearest(points, centres)
    found, size = np.empty_like(points), count * np.log2(clusters) / 8
    for cluster in range(len(centres)):
        members = points[own == cluster]
        if not len(members):
            continue
        middle = members.mean(axis=0)
        axes = np.linalg.svd(members - middle, full_matrices=False)[2]
        kept = 0
        while kept < len(axes):
            rest = (members - middle) - (members - middle) @ axes[:kept].T @ axes[:kept]
            if np.linalg.norm(rest.reshape(len(rest), -1, 3), axis=2).mean() <= bound:
                break
            kept += 1
        scores = (members - middle) @ axes[:kept].T
        step = max(float(np.abs(scores).max(initial=0.0)) / 32767, bound / 4, 1e-9)
        whole = np.rint(scores / step).astype(np.int64)
        found[own == cluster] = middle + (whole * step) @ axes[:kept]
        size += coded_bits(whole) / 8 + 4.0 * (kept + 1) * points.shape[1]
    back = np.einsum("tp,npc->ntc", curve, found.reshape(count, 4, -1)) + origin[:, None]
    return _joined(back, clips), size + 4.0 * 3 * count


def zipped(text: bytes) -> int:
    """Give the bytes of Deflate at its strongest, as in zip."""
    return len(zlib.compress(text, 9))


def xzipped(text: bytes) -> int:
    """Give the bytes of xz, which has the coder of 7z."""
    return len(lzma.compress(text, preset=9 | lzma.PRESET_EXTREME))
