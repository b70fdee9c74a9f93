"""How the time and the memory of mrpa grow with a library: one process for each number of frames.

Usage: python benchmarks/mrpa_growth.py FOLDER [FRAMES ...]
"""

import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import mocapress as mp
from mocapress.codecs import codec
from mocapress_bench.inputs import clips_in
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
            clips.append(clip)
    count = sum(clip.frames for clip in clips)
    streams = [clip.main for clip in clips]
    begin = time.process_time()
    made = codec("mrpa").encode_together(streams, skeleton=clips[0].skeleton)
    seconds = time.process_time() - begin
    needs = sum(len(chunk.needs) for one in made.encoded for chunk in one.chunks)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    size = sum(len(chunk.payload) for one in made.encoded for chunk in one.chunks)
    values = sum(np.asarray(stream.values).size for stream in streams)
    print(count, f"{seconds:.1f}", f"{1e6 * seconds / count:.0f}", f"{peak:.0f}", needs,
          f"{8 * size / values:.2f}", sep="\t")  # fmt: skip


def main() -> None:
    """Measure each number of frames in a process of its own."""
    folder, *told = sys.argv[1:]
    if told[:1] == ["--one"]:
        measure(Path(folder), int(told[1]))
        return
    rows = []
    for frames in [int(text) for text in told] or FRAMES:
        words = [sys.executable, __file__, folder, "--one", str(frames)]
        done = subprocess.run(words, check=True, capture_output=True, text=True)
        rows.append(done.stdout.strip().split("\t"))
    head = ["frames", "processor time, s", "µs a frame", "peak, MB", "parents", "bits a value"]
    print(markdown(head, rows))


if __name__ == "__main__":
    main()
