"""Processor time of compressing one small clip, in milliseconds, in a process that is warm.

``python benchmarks/small_clip.py [FILE] [--codec CODEC] [--runs 50]`` prints the least and the
median of the runs, and where the time goes. Without a file, ``samples/freebvh.bvh`` is taken.
"""

import argparse
import statistics
from collections.abc import Callable
from pathlib import Path
from time import process_time

from mocapress import api, codecs
from mocapress.source import Source

SAMPLE = Path(__file__).parents[1] / "samples/freebvh.bvh"


def milliseconds(work: Callable[[], object], runs: int) -> tuple[float, float]:
    """Give the least and the median processor time of some runs."""
    times = []
    for _ in range(runs + 3):
        begin = process_time()
        work()
        times.append(1e3 * (process_time() - begin))
    return min(times[3:]), statistics.median(times[3:])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, nargs="?", default=SAMPLE)
    parser.add_argument("--codec", default="exact:level=1")
    parser.add_argument("--runs", type=int, default=50)
    arguments = parser.parse_args()
    data, name = arguments.file.read_bytes(), arguments.file.name
    codec = codecs.codec(arguments.codec)
    clip = Source(data, name).split().clip
    blob = api.compress_source(Source(data, name), codec).blob
    encoded = codec.encode(clip.main, skeleton=clip.skeleton)
    steps: dict[str, Callable[[], object]] = {
        "compress": lambda: api.compress_source(Source(data, name), codec),
        "  split": lambda: Source(data, name).split(),
        "  encode": lambda: codec.encode(clip.main, skeleton=clip.skeleton),
        "decompress": lambda: api.decompress(blob),
        "  open": lambda: api.Opened(Source(blob)),
        "  decode": lambda: codec.decode(encoded.header, encoded.chunks, clip.columns),
        "load": lambda: api.load(blob),
    }
    print(f"{name}, {len(data):,} bytes, {arguments.codec}: ms of processor time")
    for step, work in steps.items():
        least, median = milliseconds(work, arguments.runs)
        print(f"{step:12} {least:7.2f} least {median:7.2f} median")


if __name__ == "__main__":
    main()
