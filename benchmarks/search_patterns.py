"""How well strings of patterns find clips of the same class, beside dictionaries of poses.

Usage: python benchmarks/search_patterns.py CORPUS/labelled/hdm05 [EVERY]

Of the labelled cuts of HDM05 every EVERY-th is taken (2), and each is sought in all others: whether
the first is of its class, how many of the first 5 are, and the mean average precision, in percent.
"""

import csv
import sys
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.search.patterns import distances_of
from mocapress.search.published import PUBLISHED
from mocapress.search.standard import StandardMotion, standard_motion
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]


def read(folder: Path, every: int) -> tuple[list[StandardMotion], NDArray[np.str_]]:
    """Read cuts, and their classes."""
    with (folder / "labels.tsv").open() as file:
        rows = list(csv.DictReader(file, delimiter="\t"))[::every]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        motions = [standard_motion(mp.read(folder / row["file"])) for row in rows]
    return motions, np.array([row["class"] for row in rows])


def row_of(name: str, distances: Array, classes: NDArray[np.str_]) -> list[str]:
    """Measure a way: the first, the first 5, and the mean average precision."""
    first, five, precisions = [], [], []
    for i, own in enumerate(distances):
        order = np.argsort(own, kind="stable")
        same = classes[order[order != i]] == classes[i]
        if not same.any():
            continue
        first.append(same[0])
        five.append(same[:5].sum() / min(5, same.sum()))
        hits = np.flatnonzero(same)
        precisions.append(np.mean(np.arange(1, len(hits) + 1) / (hits + 1)))
    return [name, *(f"{100 * np.mean(own):.1f}" for own in (first, five, precisions))]


def main() -> None:
    """Measure histograms, edits, both, and QSSD of bones."""
    folder, *told = sys.argv[1:]
    motions, classes = read(Path(folder), int(told[0]) if told else 2)
    by_use, by_edits = distances_of(motions, motions)
    rows = [
        row_of("histograms of patterns", by_use, classes),
        row_of("edit distance of patterns", by_edits, classes),
        row_of("both, `--by patterns`", by_use + by_edits, classes),
    ]
    qssd = PUBLISHED["qssd"]
    dictionaries = np.array([qssd.signature(motion) for motion in motions])
    found = np.array([qssd.distances(own, dictionaries) for own in dictionaries])
    rows.append(row_of("`--by qssd`", found, classes))
    print(f"{len(motions)} clips, {len(set(classes.tolist()))} classes\n")
    print(markdown(["", "first", "first 5", "MAP"], rows))


if __name__ == "__main__":
    main()
