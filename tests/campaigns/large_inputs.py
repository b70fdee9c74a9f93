"""Works on inputs larger than is held in memory, and prints what that takes.

    python tests/campaigns/large_inputs.py [--table 10G] [--c3d 300M] [--folder DIR] [--level 6]

A table and a C3D file of the sizes given are made, compressed, verified and restored, each by a
command in a process of its own, whose largest memory and processor time are printed; what comes
back is compared. Of the C3D file it is measured, too, how long ``info`` takes in Python, and the
first 1,000 frames out of its ``.mcz``. Sizes may end in K, M and G.
"""

import argparse
import filecmp
import json
import os
import re
import struct
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

CHANNELS, POINTS, ANALOG = 24, 60, 12
ROWS = 4096
COMMAND = "from mocapress.cli import main; main()"
# At its end a process says what memory it took. What `wait4` says counts the memory of the process
# that started it, too.
TELL = """
import atexit, os
atexit.register(lambda: os.write(9, open("/proc/self/status", "rb").read()))
"""
MEASURED = """
import sys, time
import mocapress as mp
from mocapress.describe import describe_file
from mocapress.source import Source
start = time.perf_counter()
describe_file(Source(sys.argv[1]))
told = time.perf_counter() - start
start, used = time.perf_counter(), time.process_time()
clip = mp.load(sys.argv[2], frames=slice(1000), limit=None)
assert clip.frames == 1000
print(told, time.perf_counter() - start, time.process_time() - used)
"""


def moving(columns: int, seed: int) -> Iterator[NDArray[np.float64]]:
    """Give rows of numbers that swing like limbs and tremble like markers, without end."""
    random = np.random.default_rng(seed)
    paces = random.uniform(0.002, 0.02, columns)
    first = 0
    while True:
        rows = np.arange(first, first + ROWS)[:, None]
        slow = np.sin(paces * rows + np.arange(columns)) * (1 + 0.3 * np.sin(rows / 7000))
        yield 400 * slow + random.normal(0, 0.05, (ROWS, columns))
        first += ROWS


def write_table(path: Path, size: int, seed: int = 1) -> None:
    """Write a table of at least so many bytes."""
    first = 0
    with path.open("w", newline="") as file:
        names = [f"c{i}" for i in range(CHANNELS)]
        done = file.write("\t".join(["time", *names]) + "\n")
        row = "\t".join(["%.2f", *["%.3f"] * CHANNELS]) + "\n"
        for numbers in moving(CHANNELS, seed):
            times = (np.arange(first, first + ROWS) / 100)[:, None]
            done += file.write(row * ROWS % tuple(np.hstack([times, numbers]).ravel().tolist()))
            first += ROWS
            if done >= size:
                return


def write_c3d(path: Path, size: int, seed: int = 2) -> None:
    """Write a C3D file of floats, of about so many bytes."""
    numbers = 4 * POINTS + ANALOG
    frames = -(-size // (4 * numbers * ROWS)) * ROWS
    parameters = _parameters({"USED": POINTS, "DATA_START": 4, "LONG_FRAMES": frames})
    header = struct.pack(
        "<BB5HHfHHf", 2, 0x50, POINTS, ANALOG, 1, min(frames, 65535), 0, 0, -0.1, 4, 1, 120.0
    )
    with path.open("wb") as file:
        file.write(header.ljust(512, b"\0") + parameters.ljust(1024, b"\0"))
        of_points, of_analog = moving(3 * POINTS, seed), moving(ANALOG, seed + 1)
        for _ in range(frames // ROWS):
            rows = np.zeros((ROWS, numbers), "<f4")
            places = rows[:, : 4 * POINTS].reshape(ROWS, POINTS, 4)
            places[:, :, :3] = next(of_points).reshape(ROWS, POINTS, 3)
            rows[:, 4 * POINTS :] = np.rint(next(of_analog)) / 64
            file.write(rows.tobytes())


def _parameters(numbers: dict[str, int]) -> bytes:
    """Give a section of parameters of the group POINT."""
    made = bytes([1, 0x50, 2, 84]) + b"\x05\xffPOINT\x03\x00\x00"
    for name, number in numbers.items():
        content = struct.pack("<bBfB", 4, 0, number, 0)
        made += (
            bytes([len(name), 1]) + name.encode() + struct.pack("<H", len(content) + 2) + content
        )
    return made


class Ran(NamedTuple):
    """What a process took."""

    output: str
    peak: int
    """Bytes of memory."""
    seconds: float
    """Of the processor."""


def run(*words: object, code: str = COMMAND) -> Ran:
    """Run Python code in a process of its own."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as told:
        command = [sys.executable, "-c", TELL + code, *map(str, words)]
        child = os.posix_spawn(
            sys.executable,
            command,
            os.environ,
            file_actions=[
                (os.POSIX_SPAWN_DUP2, output.fileno(), 1),
                (os.POSIX_SPAWN_DUP2, told.fileno(), 9),
            ],
        )
        _, status, used = os.wait4(child, 0)
        output.seek(0)
        text = output.read().decode()
        told.seek(0)
        status_lines = told.read().decode()
    if status:
        raise SystemExit(f"{words}: ended with {os.waitstatus_to_exitcode(status)}")
    (peak,) = re.findall(r"^VmHWM:\s*(\d+) kB", status_lines, re.MULTILINE)
    return Ran(text, int(peak) * 1024, used.ru_utime + used.ru_stime)


def work_on(path: Path, level: int) -> Iterator[tuple[str, Ran]]:
    """Compress, verify and restore a file; see that it comes back."""
    packed = path.with_name(path.name + ".mcz")
    back = path.with_name("back" + path.suffix)
    yield "compress", run("compress", path, "--level", level)
    yield "verify", run("verify", packed, "--limit", "1T")
    yield "decompress", run("decompress", packed, "-o", back, "--limit", "1T")
    if not filecmp.cmp(path, back, shallow=False):
        raise SystemExit(f"{path} does not come back")
    back.unlink()


def bytes_of(text: str) -> int:
    """Read a size."""
    unit = {"K": 2**10, "M": 2**20, "G": 2**30}.get(text[-1:].upper())
    return int(float(text[:-1]) * unit) if unit else int(text)


def main() -> None:
    """Make the files, work on them, print a line for each command."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--table", type=bytes_of, default=10 * 2**30)
    parser.add_argument("--c3d", type=bytes_of, default=300 * 2**20)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--level", type=int, default=6)
    told = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=told.folder) as folder:
        for name, size, make in (
            ("table.tsv", told.table, write_table),
            ("frames.c3d", told.c3d, write_c3d),
        ):
            if not size:
                continue
            path = Path(folder) / name
            make(path, size)
            for work, ran in work_on(path, told.level):
                line = {
                    "file": name,
                    "bytes": path.stat().st_size,
                    "packed": path.with_name(name + ".mcz").stat().st_size,
                    "work": work,
                    "peak_mb": ran.peak // 2**20,
                    "cpu_seconds": round(ran.seconds, 1),
                }
                print(json.dumps(line), flush=True)
            if path.suffix == ".c3d":
                ran = run(path, path.with_name(name + ".mcz"), code=MEASURED)
                names = "info", "first_1000_frames", "first_1000_frames_cpu"
                times = (round(float(word), 3) for word in ran.output.split())
                seconds = dict(zip(names, times, strict=True))
                print(json.dumps({"file": name, "seconds": seconds}), flush=True)


if __name__ == "__main__":
    main()
