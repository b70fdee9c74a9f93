"""Measures memory and time of `near` on 20,000 frames: AMC clips of a folder, one after the other.

    python benchmarks/near_large.py CORPUS/amc/cmu/01

For each goal, in a process of its own: processor time of one pass, at a scale that is given, of the
whole search, and of decoding, a frame; the peak of the process after the clip was read, and in all.
"""

import argparse
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from itertools import cycle
from math import inf
from pathlib import Path
from time import process_time

import numpy as np

import mocapress as mp
from mocapress.codecs import codec
from mocapress.codecs.near import Near
from mocapress.codecs.near.encoding import Encoder
from mocapress_bench.peak import peak
from mocapress_bench.tables import markdown

GOALS = ("p=0.01cm", "max=0.1cm", "p=1cm")
HEADER = (
    *("goal", "frames", "bytes", "a pass, ms/frame", "search, ms/frame", "decode, µs/frame"),
    *("peak before, MB", "peak, MB"),
)


def row(folder: Path, goal: str, frames: int) -> list[str]:
    """Code the clips for a goal."""
    parts, count = list[mp.Clip](), 0
    for path in cycle(sorted(folder.glob("*.amc"))):
        parts.append(mp.read(path))
        count += parts[-1].frames
        if count >= frames:
            break
    values = np.concatenate([part.values for part in parts])[:frames]
    clip = parts[0].with_frames(values, parts[0].frame_time)
    del parts, values
    near = codec(f"near:{goal}")
    assert isinstance(near, Near)
    before, begin = peak(), process_time()
    encoded = near.encode(clip.main, skeleton=clip.skeleton)
    searched = process_time()
    near.decode(encoded.header, encoded.chunks, clip.columns)
    decoded = process_time()
    most = peak()
    asked = replace(near.goal(clip.skeleton, clip.columns), most=inf)
    encoder = Encoder(asked, inf, near.chunk, clip.main, clip.skeleton)
    started = process_time()
    encoder.chunks(2.5 * asked.mean, encoder.most)
    once = process_time() - started
    return [
        *(goal, f"{clip.frames}", f"{sum(len(chunk.payload) for chunk in encoded.chunks)}"),
        *(f"{1e3 * once / frames:.2f}", f"{1e3 * (searched - begin) / frames:.2f}"),
        *(f"{1e6 * (decoded - searched) / frames:.1f}", f"{before:.0f}", f"{most:.0f}"),
    ]


def main(argv: Sequence[str] | None = None) -> None:
    """Measure every goal in a process, and print a row for each."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--goal", help="only this one, in this process")
    told = parser.parse_args(argv)
    if told.goal:
        print("\t".join(row(told.folder, told.goal, told.frames)))
        return
    rows = []
    for goal in GOALS:
        command = [sys.executable, __file__, str(told.folder), "--goal", goal]
        command += ["--frames", str(told.frames)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603
        rows.append(done.stdout.strip().split("\t"))
    print(markdown(list(HEADER), rows), end="")


if __name__ == "__main__":
    main()
