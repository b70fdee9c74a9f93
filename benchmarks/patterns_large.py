"""Patterns of much marker text: learned from all of it in one or two steps, then each clip coded.

Usage: python benchmarks/patterns_large.py FOLDER [--steps N] [--plot PNG] [MEGABYTES ...]

The clips are the joint positions of the AMC files below the folder, in mm; then the same mirrored,
and both again at 0.8 and 1.25 of their speed, until their text, each coordinate as ``%.3f`` and a
character behind it, has so many million bytes. A model is learned from all clips, and each is coded
with it by one of two processes. Each size is measured in a process of its own, without making the
clips: processor time of all processes, the same over two cores, wall time, the peaks of memory
added up, the ratio of the text to all chunks, headers and the model, and ARMS (Eq. 3) over all
frames.
"""

import argparse
import json
import multiprocessing
import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two processes for two cores

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.codecs import Model
from mocapress.codecs.patterns.encoding import unpack_facts
from mocapress_bench.inputs import clips_in
from mocapress_bench.patterns import joints_of, of_places
from mocapress_bench.peak import peak
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]
SIZES = (30, 125, 500)
HEAD = (
    "text, MB", "clips", "frames", "learning, s", "coding, s", "processor time / 2 cores, s",
    "wall time, s", "peak, MB", "patterns", "model, bytes", "ratio to text", "ARMS, mm",
)  # fmt: skip


def text_bytes(places: Array) -> int:
    """Give how long the text of positions is."""
    whole = np.abs(places).round(3)
    digits = np.floor(np.log10(np.maximum(whole, 1))).astype(int) + 1
    return int((digits + 5 + (places < 0)).sum())


def clips_of(folder: Path, most: float) -> Iterator[tuple[list[str], Array, int]]:
    """Give labels, positions and the bytes of their text, of as many clips as make so many."""
    total = 0
    paths = [path for path in clips_in(folder) if path.suffix.lower() == ".amc"]
    for speed in (1.0, 0.8, 1.25):
        for mirrored in (False, True):
            for path in paths:
                if total >= most:
                    return
                labels, places = joints_of(path)
                if mirrored:
                    other = {"l": "r", "r": "l"}
                    swap = [other.get(label[0], label[0]) + label[1:] for label in labels]
                    order = [labels.index(s) if s in labels else i for i, s in enumerate(swap)]
                    places = places[:, order] * (-1.0, 1.0, 1.0)
                if speed != 1:
                    at = np.arange(0, len(places) - 1, speed)
                    first = at.astype(int)
                    part = (at - first)[:, None, None]
                    places = (1 - part) * places[first] + part * places[first + 1]
                size = text_bytes(places)
                total += size
                yield labels, places, size


def coded(work: tuple[bytes, str, list[str], Array]) -> tuple[int, float, float]:
    """Code a clip with a model: bytes, the sum of its errors, and the peak of the process, MB."""
    payload, spec, labels, places = work
    codec = codecs.codec(spec)
    data = of_places("", places, labels)
    encoded = codec.encode(data.clip.main, model=Model("patterns", payload))
    size = len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)
    # Of the decoded clip, as the encoder has found it.
    error = unpack_facts(encoded.header)[0]["arms"] * len(places)
    return size, error, peak()


def processor() -> float:
    """Give the processor time of this process and of those that have ended."""
    both = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in both)


def measure(folder: Path, megabytes: float, steps: int) -> list[float]:
    """Learn and code so much text."""
    clips = [*clips_of(folder, 1e6 * megabytes)]
    spec = f"patterns:steps={steps}"
    codec = codecs.codec(spec)
    begin, wall = processor(), time.perf_counter()
    model = codec.learn(of_places("", places, labels).clip for labels, places, _ in clips)
    learned = processor()
    work = [(model.payload, spec, labels, places) for labels, places, _ in clips]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        found = pool.map(coded, work, chunksize=4)
        pool.close()
        pool.join()
    done, wall = processor(), time.perf_counter() - wall
    text, frames = sum(size for _, _, size in clips), sum(len(own) for _, own, _ in clips)
    memory = peak() + 2 * max(one for *_, one in found)
    size = len(model.payload) + sum(one for one, *_ in found)
    return [
        text / 1e6, len(clips), frames, learned - begin, done - learned, (done - begin) / 2, wall,
        memory, patterns_in(model, clips), len(model.payload), text / size,
        sum(error for _, error, _ in found) / frames,
    ]  # fmt: skip


def patterns_in(model: Model, clips: list[tuple[list[str], Array, int]]) -> int:
    """Count the patterns of all body parts in a model."""
    from mocapress import _core

    labels, places, _ = clips[0]
    codec = codecs.codec("patterns")
    data = of_places("", places[:100], labels).clip
    header = codec.encode(data.main, model=model).header
    nodes = len(_core.patterns_nodes(header, model.payload, data.channels))
    return sum(
        len(_core.patterns_shapes(header, model.payload, data.channels, n)) for n in range(nodes)
    )


def plot(rows: list[list[float]], file: Path) -> None:
    """Draw processor time and ratio against the size."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 3), layout="constrained")
    left, right = figure.subplots(1, 2)
    sizes = [row[0] for row in rows]
    left.plot(sizes, [row[3] for row in rows], "o-", label="learning")
    left.plot(sizes, [row[4] for row in rows], "o-", label="coding")
    left.set(xlabel="text, MB", ylabel="processor time, s", ylim=0)
    left.legend()
    right.plot(sizes, [row[10] for row in rows], "o-")
    right.set(xlabel="text, MB", ylabel="ratio to text", ylim=0)
    figure.savefig(file, dpi=100)


def main() -> None:
    """Measure each size in a process of its own."""
    told = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    told.add_argument("folder", type=Path)
    told.add_argument("--steps", type=int, default=2)
    told.add_argument("--plot", type=Path)
    told.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    told.add_argument("sizes", nargs="*", type=float, default=SIZES)
    given = told.parse_intermixed_args()
    if given.one:
        print(json.dumps(measure(given.folder, given.sizes[0], given.steps)))
        return
    rows = []
    for size in given.sizes:
        words = [given.folder, "--one", "--steps", given.steps, size]
        done = subprocess.run(  # noqa: S603
            [sys.executable, __file__, *map(str, words)], check=True, stdout=subprocess.PIPE
        )
        rows.append(json.loads(done.stdout))
        shown = [[f"{cell:.0f}" if cell >= 100 else f"{cell:.3g}" for cell in row] for row in rows]
        print(markdown(HEAD, shown), flush=True)
    if given.plot:
        plot(rows, given.plot)


if __name__ == "__main__":
    main()
