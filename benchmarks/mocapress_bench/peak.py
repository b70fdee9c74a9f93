"""Prints the peak memory of this process, MB, before and after it codes a file."""

import re
import resource
import sys
from pathlib import Path

from mocapress.source import Source
from mocapress_bench.contenders import Tool, contenders
from mocapress_bench.rivals import Rival


def peak() -> float:
    """Give the peak memory of this process, MB."""
    # Not getrusage: its maximum is handed down from the process that started this one.
    status = Path("/proc/self/status").read_text()
    found = re.search(r"VmHWM:\s*(\d+) kB", status)
    return int(found[1]) / 1024 if found else 0.0


def _peak_of_commands() -> float:
    """Give the peak of the largest command that was run (or of this process then, if larger)."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def main(path: Path, name: str) -> None:
    """Code one file with one contender, both ways."""
    (contender,) = contenders(name)[0].values()
    data = path.read_bytes()
    before = peak()
    if isinstance(contender, Tool):
        contender.decompress(contender.compress(data))
    else:
        clip, layout, *_ = Source(data, path.name).split()
        if isinstance(contender, Rival):
            packed = contender.compress(clip.values)
            values = contender.decompress(packed, (clip.frames, clip.channels))
        else:
            encoded = contender.encode(clip.main, skeleton=clip.skeleton)
            values = contender.decode(encoded.header, encoded.chunks, clip.columns)
        layout.join(values)
    print(before, peak() + _peak_of_commands())


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
