"""Learn the projection of search's signatures from CMU's trials and their labels.

    python benchmarks/search_projection.py LABELS.tsv CMU -o projection.npz

LABELS.tsv has a trial and its class a row, CMU the trials by subject. Descriptions of all trials
give the directions in which motion differs most; the labels say by which of them clips of one class
differ, and these count less. Clips of HDM05 are not seen.
"""

import argparse
import csv
import io
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.search.features import features
from mocapress.search.signatures import BYTES, description
from mocapress.search.standard import standard_motion

Array = NDArray[np.float64]

SHRUNK = 0.5
"""Share of the mean variance in the variances within classes."""
RANGE = 5.0
"""Deviations of a signature's elements that int8 holds."""
SLOW = {"60_01": 60}
"""Trials at other rates than 120 Hz."""


def learned(descriptions: Array, classes: list[str | None]) -> tuple[Array, Array]:
    """Give mean (R,) and projection (R, 64)."""
    mean = descriptions.mean(axis=0)
    _, _, ways = np.linalg.svd(descriptions - mean, full_matrices=False)
    basis = ways[:BYTES].T
    coordinates = (descriptions - mean) @ basis
    names = np.array(classes, dtype=object)
    within = []
    for name in sorted({name for name in classes if name}):
        of = coordinates[names == name]
        if len(of) > 1:
            of = of - of.mean(axis=0)
            within.append(of.T @ of / len(of))
    scatter = np.mean(within, axis=0)
    usual = np.trace(scatter) / BYTES
    sizes, axes = np.linalg.eigh((1 - SHRUNK) * scatter + SHRUNK * usual * np.eye(BYTES))
    return mean, basis @ (axes / np.sqrt(sizes))


def main() -> None:
    """Read the trials, learn, and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("labels", type=Path)
    parser.add_argument("trials", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    given = parser.parse_args()
    with given.labels.open() as file:
        known = {row["trial"]: row["class"] for row in csv.DictReader(file, delimiter="\t")}
    descriptions, classes = [], []
    warnings.simplefilter("ignore", mp.MotionWarning)
    for path in sorted(given.trials.glob("*/*.amc")):
        motion = standard_motion(mp.read(path), rate=SLOW.get(path.stem))
        descriptions.append(description(features(motion)))
        classes.append(known.get(path.stem))
    mean, matrix = learned(np.array(descriptions), classes)
    step = RANGE * float(((np.array(descriptions) - mean) @ matrix).std()) / 127
    made = io.BytesIO()
    np.savez_compressed(
        made, mean=mean.astype(np.float32), matrix=matrix.astype(np.float16), step=np.float64(step)
    )
    given.output.write_bytes(made.getvalue())
    print(f"{given.output}: {len(descriptions)} trials, {len(made.getvalue())} bytes")


if __name__ == "__main__":
    main()
