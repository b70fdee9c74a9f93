"""What the best parent of all would save, whatever way of finding it: an upper bound for MRPA.

Usage: python benchmarks/mrpa_oracle.py FOLDER [FOLDER ...]

Each folder is a library. Pieces of it, evenly spread, are predicted beside every stretch of the
library that has no frame in common with them, at every ``STRIDE``-th frame, one frame for one; for
each column the share of the parent is chosen. What the best parent saves is told with and without
the 32 bytes that name it, in percent of what the piece takes without one: for pieces as they are,
and for every fourth frame of the library (``30 Hz``, where it has 120).
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core
from mocapress.codecs.mrpa import coding
from mocapress.codecs.mrpa.coding import Parent, Piece
from mocapress.motion import Column
from mocapress_bench.inputs import clips_in
from mocapress_bench.tables import markdown

PIECE, STRIDE, PIECES = 60, 4, 40
NAME_BITS = 8 * 32


def savings(
    clips: list[NDArray[np.float64]], columns: tuple[Column, ...]
) -> tuple[float, float, float]:
    """Give bits a value without parents, and the two savings in percent."""
    values = np.ascontiguousarray(np.concatenate(clips))
    ids = np.repeat(np.arange(len(clips)), [len(clip) for clip in clips])
    plan = coding.plan_for(values, columns, None)
    inside = np.flatnonzero(ids[: -PIECE - 2] == ids[PIECE + 2 :])
    candidates = inside[::STRIDE] + 2
    alone = saved = kept = 0.0
    for start in inside[np.linspace(0, len(inside) - 1, PIECES).astype(int)] + 2:
        # The two frames before a piece are known.
        rows = values[start - 2 : start + PIECE]
        best = own = np.inf
        for other in candidates[np.abs(candidates - start) >= PIECE]:
            pieces = [Piece(2), Piece(PIECE, Parent(values, np.arange(other, other + PIECE)))]
            table, parents = coding.table_of(pieces), coding.beside(rows, pieces)
            _, _, own, beside = _core.mrpa_estimated_bits(rows, parents, table, plan)
            best = min(best, beside)
        alone += own
        saved += own - best
        kept += max(own - best - NAME_BITS, 0)
    return alone / (PIECES * PIECE * values.shape[1]), 100 * saved / alone, 100 * kept / alone


def main() -> None:
    """Measure each folder."""
    rows = []
    for folder in map(Path, sys.argv[1:]):
        clips = [mp.read(path) for path in clips_in(folder)]
        columns = clips[0].columns
        alike = [
            clip for clip in clips if [c.name for c in clip.columns] == [c.name for c in columns]
        ]
        for step in (1, 4):
            own = [clip.values[::step] for clip in alike if clip.frames // step > PIECE + 2]
            if sum(map(len, own)) > 4 * PIECE:
                numbers = savings(own, columns)
                name = folder.name if step == 1 else f"{folder.name}, every fourth frame"
                rows.append([name, *(f"{number:.2f}" for number in numbers)])
    head = ["library", "bits a value", "best parent saves, %", "less its name, %"]
    print(markdown(head, rows))


if __name__ == "__main__":
    main()
