"""Learns what `exact` begins with, where no model is given, and writes core/exact/data/start_1.txt.

    python benchmarks/exact_start.py CORPUS/amc/cmu [core/exact/data/start_1.txt]

Every other folder of AMC clips is learned from, coded one behind the other as if they were one: the
shape of the distribution, and the numbers of columns of rounding noise. The rest of the clips tells
what it brings: compress them with and without the tables.
"""

import sys
from pathlib import Path

import mocapress as mp
from mocapress.codecs.exact import Exact
from mocapress.codecs.exact.start import start_of

HEAD = (
    "// Start, version 1: chances in 1/65536, by the node of a tree. "
    "Written by benchmarks/exact_start.py.\n"
)
NODES = 64


def main(corpus: Path, target: Path) -> None:
    """Learn, and write the tables."""
    folders = sorted(path for path in corpus.iterdir() if path.is_dir())[::2]
    paths = [path for folder in folders for path in sorted(folder.glob("*.amc"))]
    start = start_of(Exact(level=9).train(mp.read(path).main for path in paths))
    shape = start.shared[NODES : 2 * NODES]
    noise = next(numbers for numbers in start.columns.values() if len(numbers) == 4 * NODES)
    slow = noise[1::2]
    tables = {
        "that a bit of a bucket is 1": [value / 256 for value in shape],
        "that a bit of the kind of a noise is 0": slow[:NODES],
        "that a bit of its length is 0": slow[NODES:],
    }
    text = HEAD
    for what, values in tables.items():
        numbers = [f"{value:.0f}" for value in values]
        rows = [", ".join(numbers[i : i + 13]) for i in range(0, NODES, 13)]
        text += f"// {what}\n" + "".join(f"  {row},\n" for row in rows)
    target.write_text(text, encoding="utf-8")
    print(f"learned from {len(paths)} clips of {', '.join(folder.name for folder in folders)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(*sys.argv[2:3] or ["core/exact/data/start_1.txt"]))
