"""Compress the C3D and TRC files of a folder, restore and compare them, and print totals by class.

    python benchmarks/markers.py FOLDER [--level 6] [--every N] [--jobs N] > RESULTS.md

FOLDER has c3d/SET/FILE and trc/SET/FILE. Files are done side by side, the largest first; each is
told on stderr as soon as it is done. Beside each total stands that of xz -9e.
"""

import argparse
import lzma
import os
import re
import sys
import time
import warnings
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

import mocapress as mp
from mocapress import _core

_LONG = re.compile(rb"[-.0-9]{17,}")
_SAMPLES = "c3dorg"
_MARGIN = 64


class Measured(NamedTuple):
    """What a file costs."""

    classes: list[str]
    size: int
    own: int
    """Of its ``.mcz``."""
    xz: int
    seconds: float
    """Of processor time, to compress it and to check that it comes back."""
    restoring: float


def classes(path: Path, data: bytes) -> list[str]:
    """Give the classes of a file."""
    if path.suffix.lower() == ".trc":
        long = len(_LONG.findall(data)) > 100
        return ["TRC", "TRC of 15-digit doubles" if long else "TRC without 15-digit doubles"]
    found = ["C3D"]
    if path.name.startswith("HDM"):
        found.append("C3D, HDM05")
    if not _core.c3d_layout(data, len(data))[1]:
        found.append("C3D, integers")
    elif path.parent.name != _SAMPLES:
        found.append("C3D, floats of labs")
    return found


def measured(level: int, path: Path) -> Measured:
    """Compress and restore a file."""
    data = path.read_bytes()
    begun = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        blob = mp.compress(path, f"exact:level={level}")
    compressed = time.process_time()
    if mp.decompress(blob) != data:
        msg = f"{path} does not come back"
        raise ValueError(msg)
    restored = time.process_time()
    packed = lzma.compress(data, preset=9 | lzma.PRESET_EXTREME)
    return Measured(
        classes(path, data),
        len(data),
        len(blob),
        len(packed),
        compressed - begun,
        restored - compressed,
    )


def told(path: Path, done: int, count: int, found: Measured) -> str:
    """Give the line that says how a file fared."""
    large = found.own - found.xz
    return (
        f"[{done}/{count}] {path.parent.name}/{path.name}: {found.size} bytes, "
        f"{found.size / found.own:.3f} : 1, xz {found.size / found.xz:.3f}, "
        f"{found.seconds:.1f} s{', LARGER than xz' if large > _MARGIN else ''}"
    )


def report(level: int, command: str, found: dict[Path, Measured]) -> str:
    """Give totals by class in Markdown, and which files are larger than by xz."""
    of_class = defaultdict(list)
    for one in found.values():
        for name in one.classes:
            of_class[name].append(one)
    lines = [
        "# Files of markers",
        "",
        f"Written by `{command}`: the codec `exact` at level {level}. Every file was restored and",
        "compared. Ratios are those of total sizes, speeds those of processor time; the check of",
        "what was written is a part of compressing.",
        "",
        "| class | files | bytes | ratio | xz -9e | compress, MB/s | restore, MB/s |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for name, files in sorted(of_class.items()):
        size, own, xz, seconds, restoring = map(sum, list(zip(*files, strict=True))[1:])
        lines.append(
            f"| {name} | {len(files)} | {size:,} | {size / own:.2f} | {size / xz:.2f} | "
            f"{size / seconds / 1e6:.2f} | {size / restoring / 1e6:.2f} |"
        )
    larger = [
        f"- `{path.parent.name}/{path.name}`: {one.own:,} bytes, by xz {one.xz:,}"
        for path, one in sorted(found.items())
        if one.own > one.xz + _MARGIN
    ]
    lines += ["", f"Files larger than by `xz -9e` and {_MARGIN} bytes: {len(larger) or 'none'}."]
    return "\n".join([*lines, *([""] if larger else []), *larger])


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--level", type=int, default=6)
    parser.add_argument("--every", type=int, default=1, help="only each n-th file of a kind")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    paths = [
        path
        for kind in ("c3d", "trc")
        for path in sorted(arguments.folder.glob(f"{kind}/*/*"))[:: arguments.every]
    ]
    found = {}
    with ProcessPoolExecutor(arguments.jobs) as pool:
        largest_first = sorted(paths, key=lambda path: -path.stat().st_size)
        of = {pool.submit(measured, arguments.level, path): path for path in largest_first}
        for future in as_completed(of):
            found[of[future]] = future.result()
            line = told(of[future], len(found), len(paths), found[of[future]])
            print(line, file=sys.stderr, flush=True)
    options = [f"--level {arguments.level}"]
    options += [f"--every {arguments.every}"] if arguments.every > 1 else []
    command = f"python benchmarks/markers.py {arguments.folder} {' '.join(options)}"
    print(report(arguments.level, command, found))


if __name__ == "__main__":
    main()
