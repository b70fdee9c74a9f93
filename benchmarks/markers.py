"""Compress the C3D and TRC files of a folder, restore and compare them, and print totals by class.

    python benchmarks/markers.py FOLDER [--level 6]

FOLDER has c3d/SET/FILE and trc/SET/FILE. Beside each total stands that of xz -9e.
"""

import argparse
import lzma
import re
import time
import warnings
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import mocapress as mp
from mocapress import _core

_LONG = re.compile(rb"[-.0-9]{17,}")
_SAMPLES = "c3dorg"


def classes(path: Path, data: bytes) -> list[str]:
    """Give the classes of a file."""
    if path.suffix.lower() == ".trc":
        long = len(_LONG.findall(data)) > 100
        return ["TRC", "TRC of 15-digit doubles" if long else "TRC without 15-digit doubles"]
    found = ["C3D"]
    if path.name.startswith("HDM"):
        found.append("C3D, HDM05")
    if not _core.c3d_layout(data)[1]:
        found.append("C3D, integers")
    elif path.parent.name != _SAMPLES:
        found.append("C3D, floats of labs")
    return found


def measured(level: int, path: Path) -> tuple[list[str], int, int, int, float]:
    """Give classes, the size of a file, of its ``.mcz`` and by xz, and seconds."""
    data = path.read_bytes()
    begun = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        blob = mp.compress(path, f"exact:level={level}")
    seconds = time.process_time() - begun
    if mp.decompress(blob) != data:
        raise SystemExit(f"{path} does not come back")
    packed = lzma.compress(data, preset=9 | lzma.PRESET_EXTREME)
    return classes(path, data), len(data), len(blob), len(packed), seconds


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--level", type=int, default=6)
    arguments = parser.parse_args()
    paths = sorted(p for kind in ("c3d", "trc") for p in arguments.folder.glob(f"{kind}/*/*"))
    totals: dict[str, list[float]] = defaultdict(lambda: [0, 0, 0, 0, 0])
    larger = []
    with ProcessPoolExecutor(2) as pool:
        work = partial(measured, arguments.level)
        for path, (found, size, own, xz, seconds) in zip(paths, pool.map(work, paths), strict=True):
            for name in found:
                for place, number in enumerate((1, size, own, xz, seconds)):
                    totals[name][place] += number
            if own > xz + 64:
                larger.append(f"{path.name}: {own} bytes, xz {xz}")
    print(f"`exact`, level {arguments.level}; every file was restored and compared.\n")
    print(
        "| class | files | bytes | ratio | xz -9e | compress, MB/s |\n"
        "|---|---:|---:|---:|---:|---:|"
    )
    for name, (files, size, own, xz, seconds) in sorted(totals.items()):
        speed = size / seconds / 1e6
        print(f"| {name} | {files} | {size:,} | {size / own:.2f} | {size / xz:.2f} | {speed:.1f} |")
    print(f"\nLarger than by xz -9e and 64 bytes: {', '.join(larger) or 'none'}")


if __name__ == "__main__":
    main()
