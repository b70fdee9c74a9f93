"""Measures what chunks of some lengths cost in size, and one frame of a file in time.

    OPENBLAS_NUM_THREADS=1 python benchmarks/random_access.py CORPUS/amc/cmu 01/01_01.amc

Sizes are those of whole ``.mcz`` files of every twelfth clip, from the first on, at the default
level, each restored and compared. Times are processor times of the only thread: ``mp.load`` of one
frame of the named clip's file, the mean over 100 frames chosen at random, and beside it ``mp.read``
of its text, the median of nine. A second table has ``mp.load`` of the whole file, by level; its
chunks are decoded in threads where there are cores, so run it on one (``taskset -c 0``).
"""

import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from time import thread_time

import numpy as np

import mocapress as mp
from mocapress_bench.tables import markdown

CHUNKS = (256, 512, 768, 1024, 2048)
EVERY, USUAL, FRAMES = 12, 2048, 100


def size(path: Path, chunk: int) -> int:
    """Give the bytes of a compressed file."""
    blob = mp.compress(path, f"exact:chunk={chunk}")
    assert mp.decompress(blob) == path.read_bytes()
    return len(blob)


def seconds(action: Callable[[], object]) -> float:
    """Give the seconds that something takes, the median of nine."""
    times = []
    for _ in range(9):
        start = thread_time()
        action()
        times.append(thread_time() - start)
    return median(times)


def reading(path: Path) -> float:
    """Give the seconds of reading the text."""
    return seconds(lambda: mp.read(path))


def opening(path: Path) -> list[list[str]]:
    """Give a row for each level: bytes, milliseconds to load, share of reading the text."""
    rows = []
    for level in range(1, 10):
        blob = mp.compress(path, f"exact:level={level}")
        loading = seconds(partial(mp.load, blob))
        share = f"{loading / reading(path):.2f}"
        rows.append([str(level), f"{len(blob):,}", f"{1e3 * loading:.1f}", share])
    return rows


def one_frame(path: Path, chunk: int) -> float:
    """Give the mean seconds of loading one frame of a compressed file."""
    frames = np.random.default_rng(1).integers(0, mp.read(path).frames, FRAMES).tolist()
    with tempfile.TemporaryDirectory() as folder:
        packed = Path(folder) / "clip.mcz"
        packed.write_bytes(mp.compress(path, f"exact:chunk={chunk}"))
        start = thread_time()
        for frame in frames:
            mp.load(packed, frames=slice(frame, frame + 1))
        return (thread_time() - start) / FRAMES


def main(folder: Path, clip: str) -> None:
    """Print the table."""
    paths = sorted(folder.rglob("*.amc"))[::EVERY]
    sizes = {chunk: sum(size(path, chunk) for path in paths) for chunk in CHUNKS}
    text = reading(folder / clip)
    rows = []
    for chunk in CHUNKS:
        seconds = one_frame(folder / clip, chunk)
        more = f"{100 * (sizes[chunk] / sizes[USUAL] - 1):+.2f} %"
        rows.append(
            [str(chunk), f"{sizes[chunk]:,}", more, f"{1e3 * seconds:.1f}", f"{seconds / text:.2f}"]
        )
    print(f"{len(paths)} clips; reading the text of {Path(clip).name}: {1e3 * text:.1f} ms.\n")
    head = ["frames per chunk", "bytes", "more", "ms for one frame", "share of reading the text"]
    print(markdown(head, rows))
    print()
    print(markdown(["level", "bytes", "ms to load", head[-1]], opening(folder / clip)))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
