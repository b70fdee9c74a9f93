"""Measures `near` beside ACL, at ACL's mean errors and within its largest.

    python benchmarks/near_rates.py CORPUS/amc/cmu [--clips 05_05,141_01] [--p 0.1]

ACL's figures are in near_acl.tsv beside this script. What `near` begins with was learned from none
of these clips' subjects (near_start.py); its settings were looked at on all of them. Bytes are
those of codec header and payloads, without names and layout; errors are cm, of what was decoded;
times are processor time of one thread.
"""

import argparse
from collections.abc import Sequence
from math import inf
from pathlib import Path
from time import thread_time
from typing import NamedTuple

import numpy as np

import mocapress as mp
from mocapress import _core
from mocapress.codecs.near import Near
from mocapress.codecs.near.encoding import Encoder
from mocapress.codecs.near.figure import RADIUS
from mocapress.codecs.near.goal import Goal
from mocapress.codecs.near.search import encode
from mocapress.motion.units import centimetres_per_unit, figure_size
from mocapress_bench.tables import markdown

CLIPS = ("01_01", "05_05", "16_15", "49_02", "60_01", "09_01", "35_01", "141_01")
"""Of subjects that near_start.py leaves out."""
PRECISIONS = (0.01, 0.05, 0.1, 0.3, 1.0)
HEADER = (
    *("clip", "p", "bytes", "of ACL's", "mean", "ACL's", "largest", "ACL's", "worst joint"),
    *("encode ms/frame", "decode µs/frame"),
)


class Rival(NamedTuple):
    """What ACL made of a clip at a precision; errors in cm."""

    frames: int
    size: int
    mean: float
    most: float
    of_joints: np.ndarray


def rivals() -> dict[tuple[str, float], Rival]:
    """Read ACL's figures, by clip and precision."""
    found = {}
    for line in (Path(__file__).parent / "near_acl.tsv").read_text().splitlines():
        fields = line.split("\t")
        if line.startswith("#") or fields[0] == "clip":
            continue
        frames, size = int(fields[1]), int(fields[4])
        of_joints = np.array(fields[10].split(), np.float64)
        rival = Rival(frames, size, float(fields[6]), float(fields[7]), of_joints)
        found[fields[0], float(fields[3])] = rival
    return found


def row(path: Path, precision: float, rival: Rival, tight: bool, chunk: int) -> list[str]:
    """Code a clip as ACL did; ``tight``: with the precision as the largest error instead."""
    clip = mp.read(path)
    assert clip.skeleton is not None
    unit = centimetres_per_unit(clip.skeleton)
    assert unit is not None
    most = precision if tight else rival.most
    mean = Near(max=f"{precision}cm").goal(clip.skeleton, clip.columns).mean * unit
    wanted = mean if tight else rival.mean
    goal = Goal(True, wanted / unit, most / unit, RADIUS / unit, figure_size(clip.skeleton))
    begin = thread_time()
    encoder = Encoder(goal, inf, chunk, clip.main, clip.skeleton)
    encoded = encode(encoder, Near().effort)
    coded = thread_time()
    values = Near(chunk=chunk).decode(encoded.header, encoded.chunks, clip.columns)
    decoded = thread_time()
    errors = _core.near_errors(encoder.measure.core, clip.values, values) * unit
    size = len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)
    if errors.max() > most:
        raise SystemExit(f"{path.stem} at {precision}: {errors.max()} cm, more than {most}")
    worst = (errors.mean(axis=0) / np.maximum(rival.mean, rival.of_joints)).max()
    return [
        *(path.stem, f"{precision:g}", f"{size}", f"{size / rival.size:.4f}"),
        *(f"{errors.mean():.4f}", f"{rival.mean:.4f}", f"{errors.max():.3f}", f"{most:.3f}"),
        *(f"{worst:.2f}", f"{1e3 * (coded - begin) / clip.frames:.2f}"),
        f"{1e6 * (decoded - coded) / clip.frames:.0f}",
    ]


def main(argv: Sequence[str] | None = None) -> None:
    """Measure, and print a row for each clip and precision, then long and short clips together."""
    parser = argparse.ArgumentParser()
    parser.add_argument("corpus", type=Path)
    parser.add_argument("--clips", default=",".join(CLIPS))
    parser.add_argument("--p", default=",".join(map(str, PRECISIONS)))
    parser.add_argument("--tight", action="store_true", help="p as the largest error, not ACL's")
    parser.add_argument("--chunk", type=int, default=Near().chunk)
    told = parser.parse_args(argv)
    found = rivals()
    rows = []
    for precision in map(float, told.p.split(",")):
        sums = {"**400 frames and more**": [0, 0], "**shorter**": [0, 0]}
        for name in told.clips.split(","):
            path = next(told.corpus.rglob(f"{name}.amc"))
            rival = found[name, precision]
            rows.append(row(path, precision, rival, told.tight, told.chunk))
            own = sums["**400 frames and more**" if rival.frames >= 400 else "**shorter**"]
            own[0], own[1] = own[0] + int(rows[-1][2]), own[1] + rival.size
        for label, (size, others) in sums.items():
            if others:
                rows.append(
                    [label, f"{precision:g}", f"{size}", f"**{size / others:.4f}**"]
                    + [""] * (len(HEADER) - 4)
                )
    print(markdown(list(HEADER), rows), end="")


if __name__ == "__main__":
    main()
