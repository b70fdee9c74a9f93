"""What each part of `near` brings: bytes at ACL's mean errors, with more and more left out.

    python benchmarks/near_ablation.py CORPUS/amc/cmu [--clips 16_15,35_01] [--p 0.01,0.1,1]

Bytes are those of codec header and payloads, without a bound of the largest error, beside those of
ACL; near_rates.py says where ACL's figures are from.
"""

import argparse
from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path

import mocapress as mp
from mocapress.codecs.near import Near
from mocapress.codecs.near.encoding import Encoder
from mocapress.codecs.near.figure import RADIUS
from mocapress.codecs.near.goal import Goal
from mocapress.codecs.near.search import encode
from mocapress.motion.units import centimetres_per_unit, figure_size
from mocapress_bench.tables import markdown
from near_rates import Rival, rivals


def without_figure(encoder: Encoder) -> None:
    """Let the clip be one of any figure."""
    encoder.turn(known=False, orders=True)


def without_start(encoder: Encoder) -> None:
    """Begin with nothing learned."""
    without_figure(encoder)
    encoder.starts = False


def without_orders(encoder: Encoder) -> None:
    """Keep the file's order of angles."""
    without_start(encoder)
    encoder.turn(known=False, orders=False)


def without_rate(encoder: Encoder) -> None:
    """Round every number to the nearest."""
    without_orders(encoder)
    encoder.rate = 1e-4


def with_short_chunks(encoder: Encoder) -> None:
    """Begin anew every 256 frames."""
    without_rate(encoder)
    encoder.chunk = 256


ROWS: dict[str, Callable[[Encoder], None] | None] = {
    "all": None,
    "any figure": without_figure,
    "and no start": without_start,
    "and the file's orders of angles": without_orders,
    "and the nearest steps": without_rate,
    "and chunks of 256 frames": with_short_chunks,
}


def size_of(path: Path, rival: Rival, change: Callable[[Encoder], None] | None) -> int:
    """Give the bytes of a clip at ACL's mean error."""
    clip = mp.read(path)
    assert clip.skeleton is not None
    unit = centimetres_per_unit(clip.skeleton)
    assert unit is not None
    goal = Goal(True, rival.mean / unit, inf, RADIUS / unit, figure_size(clip.skeleton))
    encoder = Encoder(goal, inf, Near().chunk, clip.main, clip.skeleton)
    if change:
        change(encoder)
    encoded = encode(encoder, Near().effort)
    return len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)


def main(argv: Sequence[str] | None = None) -> None:
    """Measure, and print a row for each state."""
    parser = argparse.ArgumentParser()
    parser.add_argument("corpus", type=Path)
    parser.add_argument("--clips", default="16_15,35_01")
    parser.add_argument("--p", default="0.01,0.1,1")
    told = parser.parse_args(argv)
    found, names = rivals(), told.clips.split(",")
    precisions = [float(p) for p in told.p.split(",")]
    rows = []
    for row, change in ROWS.items():
        cells = [row]
        for p in precisions:
            own, others = 0, 0
            for name in names:
                path = next(told.corpus.rglob(f"{name}.amc"))
                own += size_of(path, found[name, p], change)
                others += found[name, p].size
            cells.append(f"{own / others:.4f}")
        rows.append(cells)
    print(markdown(["", *(f"{p:g}" for p in precisions)], rows), end="")


if __name__ == "__main__":
    main()
