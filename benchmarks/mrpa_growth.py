"""How the time and the memory of mrpa grow with a library: one process for each number of frames.

Usage: python benchmarks/mrpa_growth.py FOLDER [--plot PNG] [FRAMES ...]

The clips are the first of the folder with the same columns; the last is cut where so many frames
are reached.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import mocapress as mp
from mocapress.codecs import codec
from mocapress_bench.inputs import clips_in
from mocapress_bench.peak import peak
from mocapress_bench.tables import markdown

FRAMES = (5_000, 20_000, 60_000, 120_000)


def measure(folder: Path, frames: int) -> None:
    """Code the first clips of a folder together, as many as make so many frames."""
    clips: list[mp.Clip] = []
    for path in clips_in(folder):
        if sum(clip.frames for clip in clips) >= frames:
            break
        clip = mp.read(path)
        if not clips or [c.name for c in clip.columns] == [c.name for c in clips[0].columns]:
            clips.append(clip[: frames - sum(other.frames for other in clips)])
    count = sum(clip.frames for clip in clips)
    streams = [clip.main for clip in clips]
    begin = time.process_time()
    made = codec("mrpa").encode_together(streams, skeleton=clips[0].skeleton)
    seconds = time.process_time() - begin
    needs = sum(len(chunk.needs) for one in made.encoded for chunk in one.chunks)
    size = sum(len(chunk.payload) for one in made.encoded for chunk in one.chunks)
    values = sum(np.asarray(stream.values).size for stream in streams)
    print(count, f"{seconds:.1f}", f"{1e6 * seconds / count:.0f}", f"{peak():.0f}", needs,
          f"{8 * size / values:.2f}", sep="\t")  # fmt: skip


def main() -> None:
    """Measure each number of frames in a process of its own."""
    folder, *told = sys.argv[1:]
    if told[:1] == ["--one"]:
        measure(Path(folder), int(told[1]))
        return
    picture = Path(told[1]) if told[:1] == ["--plot"] else None
    told = told[2:] if picture else told
    rows = []
    for frames in [int(text) for text in told] or FRAMES:
        words = [sys.executable, __file__, folder, "--one", str(frames)]
        done = subprocess.run(words, check=True, capture_output=True, text=True)
        rows.append(done.stdout.strip().split("\t"))
    head = ["frames", "processor time, s", "µs a frame", "peak, MB", "parents", "bits a value"]
    print(markdown(head, rows))
    if picture:
        plot([[float(cell) for cell in row] for row in rows], picture)


def plot(rows: list[list[float]], file: Path) -> None:
    """Draw processor time and memory against the frames."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 3), layout="constrained")
    left, right = figure.subplots(1, 2)
    frames = [row[0] / 1000 for row in rows]
    left.plot(frames, [row[1] for row in rows], "o-")
    left.plot([0, frames[-1]], [0, rows[0][1] / frames[0] * frames[-1]], ":", color="0.5")
    left.set(xlabel="thousand frames (dotted: linear)", ylabel="processor time, s", ylim=0, xlim=0)
    right.plot(frames, [row[3] for row in rows], "o-")
    right.set(xlabel="thousand frames", ylabel="memory at the peak, MB", ylim=0, xlim=0)
    figure.savefig(file, dpi=100)


if __name__ == "__main__":
    main()
