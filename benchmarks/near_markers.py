"""Measures `near` on markers beside `patterns`, at the same ARMS and with bounds.

    python benchmarks/near_markers.py CORPUS [--frames 12000] [--arms 6.5]

The markers are the joints of CMU subject 16, in mm, as in `mocapress bench patterns`, and those of
a few C3D. Bytes are those of codec header and payloads; ratios are to the text that `bench
patterns` counts. `largest` is the largest distance of any marker in any frame.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from mocapress import codecs
from mocapress_bench.patterns import MarkerSet, arms_of, cmu, distances, of_c3d, text_of
from mocapress_bench.tables import markdown

BOUNDS = ("max=20mm", "max=5mm")


def measured(data: MarkerSet, spec: str) -> tuple[float, float, int]:
    """Give ARMS, the largest distance, and bytes."""
    codec = codecs.codec(spec)
    made = codec.encode(data.clip.main)
    away = distances(data.values, codec.decode(made.header, made.chunks, data.clip.columns))
    size = len(made.header) + sum(len(chunk.payload) for chunk in made.chunks)
    return arms_of(away), float(away.max()), size


def at_arms(data: MarkerSet, target: float) -> str:
    """Find the mean at which `near` comes to an ARMS, from below."""
    mean, best = 0.91 * target, ""
    for _ in range(6):
        spec = f"near:mean={mean:.4g}mm"
        arms = measured(data, spec)[0]
        if arms <= target:
            best = spec
            if arms > 0.98 * target:
                break
        mean *= 0.99 * target / arms
    return best


def rows(data: MarkerSet, target: float) -> Iterator[list[str]]:
    """Give a row for each way."""
    text = len(text_of(data.values))
    for spec in (
        f"patterns:arms={target:g}",
        at_arms(data, target),
        *(f"near:{b}" for b in BOUNDS),
    ):
        arms, largest, size = measured(data, spec)
        cells = [data.name, f"`{spec}`", f"{size}", f"{text / size:.0f}"]
        yield [*cells, f"{arms:.2f}", f"{largest:.1f}"]


def main(argv: Sequence[str] | None = None) -> None:
    """Measure, and print the rows."""
    parser = argparse.ArgumentParser()
    parser.add_argument("corpus", type=Path)
    parser.add_argument("--frames", type=int, default=12_000)
    parser.add_argument("--arms", type=float, default=6.5)
    told = parser.parse_args(argv)
    folder = next((told.corpus / "amc" / "cmu").rglob("16_01.amc")).parent
    sets = [cmu(folder, told.frames)]
    sets += map(of_c3d, sorted((told.corpus / "markers" / "c3d" / "mocaprecovery").glob("*.c3d")))
    head = ["markers", "way", "bytes", "ratio to text", "ARMS, mm", "largest, mm"]
    print(markdown(head, []), end="", flush=True)
    for data in sets:
        for row in rows(data, told.arms):
            print(markdown(head, [row]).splitlines()[-1], flush=True)


if __name__ == "__main__":
    main()
