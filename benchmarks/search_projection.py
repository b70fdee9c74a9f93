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

import mocapress as mp
from mocapress.search.features import features
from mocapress.search.signatures import description
from mocapress.search.standard import standard_motion
from mocapress_bench.search_projection import learned

SLOW = {"60_01": 60}
"""Trials at other rates than 120 Hz."""


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
    found = learned(np.array(descriptions), classes)
    made = io.BytesIO()
    np.savez_compressed(
        made,
        mean=found.mean.astype(np.float32),
        matrix=found.matrix.astype(np.float16),
        step=np.float64(found.step),
    )
    given.output.write_bytes(made.getvalue())
    print(f"{given.output}: {len(descriptions)} trials, {len(made.getvalue())} bytes")


if __name__ == "__main__":
    main()
