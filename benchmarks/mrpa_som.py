"""The map of segments in batches, beside the one that learns input by input.

Usage: python benchmarks/mrpa_som.py FOLDER [FOLDER ...]

In a batch, all h-segments find the segments that they resemble most at once, and each border moves
by the learning rate times the mean of what its inputs ask for (Eq. 7); between two segments that
leave a gap of LengthThr frames or more there is then one more, and one that is shorter goes to the
one before it. Ratios are those of mode ``published``, the time is of the map alone: of the core,
of the same in plain Python (``tests/codecs/mrpa_reference.py``), and of batches in NumPy.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.mrpa import forest, som
from mocapress.codecs.mrpa.paths import Segments
from mocapress_bench.inputs import clips_in
from mocapress_bench.mrpa import Library, patterns_of, published_bytes, read_library
from mocapress_bench.tables import markdown

sys.path.append(str(Path(__file__).parents[1] / "tests/codecs"))
import mrpa_reference


def batched(h: Segments, frames: int, least: int) -> Segments:
    """Move the borders of even segments in batches, one for each learning rate."""
    firsts = som.even_segments(h, frames)[:, 0]
    for rate in som.RATES:
        lasts = np.append(firsts[1:], frames) - 1
        own = most_alike(h, firsts, lasts)
        counts = np.bincount(own, minlength=len(firsts))
        safe = np.maximum(counts, 1)
        moves = [
            np.rint(rate * np.bincount(own, h[:, i] - at[own], len(firsts)) / safe).astype(np.int64)
            for i, at in enumerate((firsts, lasts))
        ]
        firsts = borders(firsts + moves[0], lasts + moves[1], frames, least)
    return np.stack([firsts, np.append(firsts[1:], frames) - 1], axis=1)


def most_alike(
    h: Segments, firsts: NDArray[np.int64], lasts: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Give the segment of the largest IoU (Eq. 6) of each input."""
    overlap = np.minimum(h[:, 1:], lasts) - np.maximum(h[:, :1], firsts) + 1
    together = h[:, 1:] - h[:, :1] + lasts - firsts + 2 - overlap
    found: NDArray[np.int64] = np.where(overlap > 0, overlap / together, 0).argmax(axis=1)
    return found


def borders(
    firsts: NDArray[np.int64], lasts: NDArray[np.int64], frames: int, least: int
) -> NDArray[np.int64]:
    """Give where segments begin so that they cover all frames and none is too short."""
    wanted = [0]
    for first, last in zip(firsts[1:].tolist(), lasts[:-1].tolist(), strict=True):
        gap = first - last - 1
        wanted += [last + 1, first] if gap >= least else [(last + 1 + first) // 2]
    kept = [0]
    for border in wanted[1:]:
        if border - kept[-1] >= least and frames - border >= least:
            kept.append(border)
    return np.array(kept, np.int64)


def measured(library: Library) -> list[list[str]]:
    """Measure a library."""
    found = patterns_of(library)
    h, frames, least = found.paths.h, len(found.clips), found.thresholds.length
    ways: dict[str, Callable[[], Segments]] = {
        "even (Non-SOM)": lambda: som.even_segments(h, frames),
        "input by input, core": lambda: som.refined_segments(h, frames, least),
        "input by input, Python": lambda: np.array(
            mrpa_reference.refine(h.tolist(), frames, least, som.RATES)
        ),
        "batches, NumPy": lambda: batched(h, frames, least),
    }
    rows = []
    for name, way in ways.items():
        begin = time.process_time()
        made = way()
        seconds = time.process_time() - begin
        segments = som.cut_at_clips(made, found.clips)
        built = forest.build(segments, found.paths, found.thresholds.iou)
        size, *_ = published_bytes(library, found, built)
        facts = (len(h), len(segments), built.predicted_frames, f"{library.size / size:.3f}")
        rows.append([library.name, name, *map(str, facts), f"{1000 * seconds:.2f}"])
    return rows


def main() -> None:
    """Measure each folder."""
    rows = []
    for folder in map(Path, sys.argv[1:]):
        rows += measured(read_library(folder.name, clips_in(folder)))
    head = ["library", "map", "inputs", "segments", "predicted frames", "ratio", "time, ms"]
    print(markdown(head, rows))


if __name__ == "__main__":
    main()
