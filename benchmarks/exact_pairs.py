"""Compares each level of `exact` with the one below, in total and file by file.

    python benchmarks/exact_pairs.py CORPUS/amc/cmu CORPUS/bvh

Prints the bytes of whole ``.mcz`` files of all clips at each level, how much smaller that is than
at the level below, and every file that is more than 0.2 % larger than at the level below.
"""

import sys
from itertools import pairwise
from pathlib import Path

import mocapress as mp
from mocapress_bench.tables import markdown

LEVELS = range(1, 10)
MOST = 1.002


def sizes(path: Path) -> list[int]:
    """Give the bytes of a file at each level."""
    return [len(mp.compress(path, f"exact:level={level}")) for level in LEVELS]


def main(folders: list[Path]) -> None:
    """Measure and print."""
    paths = sorted(path for folder in folders for path in folder.rglob("*"))
    measured = {path: sizes(path) for path in paths if path.suffix in {".amc", ".bvh"}}
    totals = [sum(column) for column in zip(*measured.values(), strict=True)]
    smaller = [
        "",
        *(f"{100 * (1 - b / a):.2f} %" for a, b in pairwise(totals)),
    ]
    rows = zip(map(str, LEVELS), (f"{total:,}" for total in totals), smaller, strict=True)
    print(markdown(["level", "bytes", "smaller than below"], [list(row) for row in rows]))
    larger = [
        [f"{path.parent.name}/{path.name}", str(level), f"{own:,}", f"+{own - below:,}"]
        for path, column in measured.items()
        for level, below, own in zip(LEVELS[1:], column, column[1:], strict=False)
        if own > MOST * below
    ]
    print(f"{len(larger)} of {len(measured)} files times {len(LEVELS) - 1} are larger by 0.2 %.\n")
    if larger:
        print(markdown(["file", "level", "bytes", "more"], larger))


if __name__ == "__main__":
    main([Path(folder) for folder in sys.argv[1:]])
