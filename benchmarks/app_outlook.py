"""What the APP paper leaves for later: alpha tables learned for groups of clips, and key frames.

Usage: python benchmarks/app_outlook.py FOLDER [FOLDER ...]

**Tables.** Of all clips with a skeleton every other one is for learning, the rest is measured.
Clips are grouped by how often each alpha would be best (k-means of histograms), and each group gets
a table of 8 alphas by Lloyd's algorithm, by the bits that an alpha costs that is off. A clip that
is measured takes the table of the nearest group; *its own* is learned from the clip itself, and is
a bound. Every difference is coded in context; 32 bytes are counted for each table.

**Key frames** are found by the simplification of Douglas and Peucker: again and again the frame
that is furthest from the straight line between the two key frames around it. *Chunks* end every 480
frames, or at the strongest key frame 360 to 600 frames behind the last end. *Clusters*, which share
an alpha of a column, end every 15 frames, or at as many key frames; this is told in ideal bits, of
the number of last printed digits by which a prediction is off, with the index.
"""

import heapq
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2

import mocapress as mp
from mocapress.codecs.app.coding import Coding
from mocapress.codecs.app.parents import parent_columns
from mocapress.codecs.app.tables import ALPHA_TABLES
from mocapress.motion import Clip
from mocapress_bench.inputs import clips_in
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]
T, CHUNK, ENTRIES, GROUPS = 15, 480, 8, (1, 2, 4, 8)
PUBLISHED = "k3-non-uniform"
_EDGES = np.array([-np.inf, *np.linspace(-2, 2, 17), np.inf])
_FAR, _MOST, _ROUNDS = 4.0, 100.0, 50


def size_of(clip: Clip, alphas: Sequence[float], chunk: int = CHUNK) -> int:
    """Give the bytes of all chunks."""
    coded = Coding(tuple(alphas), T, 53, chunk).encode(clip.main, clip.skeleton)
    return sum(len(one.payload) for one in coded.chunks)


def steps_of(clip: Clip) -> tuple[Array, Array, list[int]]:
    """Give the steps of columns that have a parent, and of their parents, (F - 1, n)."""
    parents = parent_columns(clip.columns, clip.skeleton)
    own = [c for c, parent in enumerate(parents) if parent >= 0]
    steps = np.diff(np.nan_to_num(clip.values), axis=0)
    return steps[:, own], steps[:, [parents[c] for c in own]], own


def best_alphas(clip: Clip, ends: Sequence[int]) -> tuple[Array, Array]:
    """Give the alpha of each cluster and column (Eq. 9), and how much it matters."""
    child, parent, _ = steps_of(clip)
    starts = np.array([0, *ends[:-1]])
    products = np.add.reduceat(child * parent, starts, axis=0)
    squares = np.add.reduceat(parent * parent, starts, axis=0)
    own = np.add.reduceat(child * child, starts, axis=0)
    alphas = np.divide(products, squares, out=np.zeros_like(products), where=squares > 0)
    left = np.maximum(own - alphas * products, 1e-12)
    return np.clip(alphas, -_FAR, _FAR), np.minimum(squares / left, _MOST)


def even_ends(count: int) -> list[int]:
    """Give where clusters of T frames end, among steps."""
    return [*range(T, count, T), count]


def table_of(alphas: Array, weights: Array) -> tuple[float, ...]:
    """Learn a table by Lloyd's algorithm, from the published one on.

    A cluster whose alpha is off by d takes about log2(1 + w d d) / 2 bits a value more, so each
    counts for w / (1 + w d d) in the mean.
    """
    centres = np.array(ALPHA_TABLES[PUBLISHED])
    for _ in range(_ROUNDS):
        own = np.searchsorted((centres[1:] + centres[:-1]) / 2, alphas)
        counts = weights / (1 + weights * (alphas - centres[own]) ** 2)
        total = np.bincount(own, counts, ENTRIES)
        sums = np.bincount(own, counts * alphas, ENTRIES)
        centres = np.sort(np.where(total > 0, sums / np.where(total > 0, total, 1), centres))
    # Where nothing is to be gained from the parent, its step must not disturb at all.
    centres[np.abs(centres).argmin()] = 0
    return tuple(float(np.float32(centre)) for centre in centres)


def tables(clips: Sequence[Clip]) -> list[list[str]]:
    """Measure tables that were learned from every other clip on the others."""
    told = []
    for clip in clips:
        alphas, weights = best_alphas(clip, even_ends(clip.frames - 1))
        told.append((alphas.ravel(), weights.ravel()))
    features = np.array(
        [np.histogram(a, _EDGES, weights=w)[0] / max(float(w.sum()), 1e-12) for a, w in told]
    )
    learn, test = range(0, len(clips), 2), range(1, len(clips), 2)

    def learned(members: Sequence[int]) -> tuple[float, ...]:
        return table_of(
            *(np.concatenate(part) for part in zip(*(told[i] for i in members), strict=True))
        )

    base = sum(size_of(clips[i], ALPHA_TABLES[PUBLISHED]) for i in test)
    rows = [[f"{PUBLISHED}, as published", str(base), ""]]
    for groups in GROUPS:
        centres, own = kmeans2(features[learn], groups, minit="++", seed=1)
        made = {
            g: learned([learn[i] for i in np.flatnonzero(own == g)])
            for g in np.unique(own).tolist()
        }
        near = [
            min(made, key=lambda g: float(np.linalg.norm(features[i] - centres[g]))) for i in test
        ]
        size = sum(size_of(clips[i], made[g]) for i, g in zip(test, near, strict=True))
        rows.append([f"learned, {groups} groups", str(size + 32 * len(made)), ""])
    size = sum(size_of(clips[i], learned([i])) + 32 for i in test)
    rows.append(["learned, its own", str(size), ""])
    for row in rows:
        row[2] = f"{100 * (int(row[1]) / base - 1):+.2f} %"
    return rows


def key_frames(values: Array, count: int) -> list[tuple[int, float]]:
    """Give so many key frames of a curve, (F, C), in the order in which they are found."""

    def furthest(first: int, last: int) -> tuple[float, int, int, int]:
        inside = values[first + 1 : last]
        part = (np.arange(1, last - first) / (last - first))[:, None]
        away = np.linalg.norm(
            inside - values[first] - part * (values[last] - values[first]), axis=1
        )
        at = int(away.argmax())
        return -float(away[at]), first, last, first + 1 + at

    waiting = [furthest(0, len(values) - 1)] if len(values) > 2 else []
    found = []
    while waiting and len(found) < count:
        away, first, last, at = heapq.heappop(waiting)
        found.append((at, -away))
        for ends in ((first, at), (at, last)):
            if ends[1] - ends[0] > 1:
                heapq.heappush(waiting, furthest(*ends))
    return found


def curve_of(clip: Clip) -> Array:
    """Give a clip as a curve, each column in units of its own."""
    values = np.nan_to_num(clip.values)
    spread = values.std(axis=0)
    return values / np.where(spread > 0, spread, 1)


def chunk_ends(clips: Sequence[Clip]) -> list[list[str]]:
    """Measure chunks that end at key frames."""
    alphas = ALPHA_TABLES[PUBLISHED]
    sizes, chunks = np.zeros(2, int), np.zeros(2, int)
    for clip in (clip for clip in clips if clip.frames > 2 * CHUNK):
        strength = dict(key_frames(curve_of(clip), clip.frames // 10))
        ends = [0]
        while clip.frames - ends[-1] > CHUNK * 5 // 4:
            around = range(ends[-1] + CHUNK * 3 // 4, ends[-1] + CHUNK * 5 // 4)
            ends.append(max(around, key=lambda at: strength.get(at, 0.0)))
        ends.append(clip.frames)
        own = [clip[a:b] for a, b in pairwise(ends)]
        sizes += size_of(clip, alphas), sum(size_of(one, alphas, 1 << 19) for one in own)
        chunks += -(-clip.frames // CHUNK), len(own)
    if not sizes[0]:
        return []
    names = ("every 480 frames", "at key frames")
    return [
        [f"chunks {name}, {count} of them", str(size), f"{100 * (size / sizes[0] - 1):+.2f} %"]
        for name, size, count in zip(names, sizes.tolist(), chunks.tolist(), strict=True)
    ]


def cluster_ends(clips: Sequence[Clip]) -> list[list[str]]:
    """Measure clusters that end at key frames, in ideal bytes."""
    table = np.array(ALPHA_TABLES[PUBLISHED])
    bits = np.zeros(2)
    for clip in clips:
        child, parent, own = steps_of(clip)
        even = even_ends(len(child))
        keys = sorted(at for at, _ in key_frames(curve_of(clip), len(even) - 1))
        units = np.abs(clip.values[1:, own])
        units = 10.0 ** (np.floor(np.log10(np.maximum(units, 1e-3))) - 5)
        for way, ends in enumerate((even, [*keys, len(child)])):
            alphas, _ = best_alphas(clip, ends)
            taken = table[np.abs(alphas[..., None] - table).argmin(axis=-1)]
            each = np.repeat(taken, np.diff([0, *ends]), axis=0)
            away = np.rint(np.abs(child - each * parent) / units)
            bits[way] += np.log2(2 * away + 1).sum() + 3 * taken.size
    names = ("every 15 frames", "at key frames")
    return [
        [f"clusters {name}, ideal", f"{b / 8:.0f}", f"{100 * (b / bits[0] - 1):+.2f} %"]
        for name, b in zip(names, bits.tolist(), strict=True)
    ]


def main() -> None:
    """Measure all clips of the folders together."""
    found = [
        mp.read(path, strict=False) for folder in sys.argv[1:] for path in clips_in(Path(folder))
    ]
    clips = [clip for clip in found if clip.skeleton is not None and clip.frames > 2 * T]
    rows = [*tables(clips), *chunk_ends(clips), *cluster_ends(clips)]
    print(f"{len(clips)} clips, {sum(clip.frames for clip in clips)} frames\n")
    print(markdown(["", "bytes", "against the first"], rows))


if __name__ == "__main__":
    main()
