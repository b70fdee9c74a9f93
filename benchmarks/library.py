"""What a library costs beside ``.mcz`` files: bytes and processor time, side by side in one run.

    python benchmarks/library.py corpus/amc/cmu [--clips 10000]

Prints, for the motion files of a folder: the size of a library and of the ``.mcz`` files, and of
tar.xz and tar.zst where these programs are there; the processor time of adding and of compressing,
both without the index for search;
the bytes that a cut of 300 frames adds; then, for a library of many clips made of cuts of the
files: the time to list them, to get one beside the time of its ``.mcz``, and to play a hundred at
once.
"""

import argparse
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import mocapress as mp
from mocapress import api
from mocapress.source import Source
from mocapress.storage import write_whole

COMMAND = [sys.executable, "-c", "from mocapress.cli import main; main()"]

SUFFIXES = (".amc", ".bvh", ".asf", ".c3d", ".trc")
_FRAME = re.compile(rb"^[0-9]+\s*?$", re.MULTILINE)
_CUT = 300


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--clips", type=int, default=10_000, help="of the large library")
    parser.add_argument("--no-tar", action="store_true", help="do not run tar with xz and zstd")
    options = parser.parse_args()
    files = [p for p in sorted(options.folder.rglob("*")) if p.suffix.lower() in SUFFIXES]
    with tempfile.TemporaryDirectory(prefix="library-") as place:
        packed = add(files, options.folder, Path(place))
        cuts(files, Path(place))
        if not options.no_tar:
            archives(options.folder)
        large(files, packed, Path(place), options.clips)


def add(files: list[Path], base: Path, place: Path) -> dict[Path, Path]:
    """Add files to a library and compress them, in turns; give the compressed files."""
    packed, spent = {}, {"add": 0.0, "compress": 0.0}
    raw = sum(path.stat().st_size for path in files)
    with mp.open_library(place / "all.mocapdb", "a") as library:
        for number, path in enumerate(files):
            target = place / f"{number}.mcz"

            def compress(path: Path = path, target: Path = target) -> None:
                write_whole(target, api.compress_source(Source(path)).blob)

            def store(path: Path = path) -> None:
                name = str(path.relative_to(base))
                if path.suffix.lower() == ".asf":
                    library.add_companion(Source(path), name)
                else:
                    library.add(path, name, index=False)

            turns = [("compress", compress), ("add", store)]
            for name, work in turns if number % 2 else reversed(turns):
                spent[name] += processor(work)
            packed[path] = target
    small = sum(path.stat().st_size for path in packed.values())
    size = (place / "all.mocapdb").stat().st_size
    clips = sum(path.suffix.lower() != ".asf" for path in files)
    most = 1.01 * small + 256 * clips
    print(f"{len(files)} files, {raw} bytes")
    print(f"  .mcz files      {small:12} bytes")
    print(f"  library         {size:12} bytes, {100 * size / small - 100:+.2f} %; limit {most:.0f}")
    with mp.open_library(place / "all.mocapdb") as library, library.db.reading() as connection:
        shared, runs = connection.execute(
            "SELECT coalesce(sum(frames), 0), count(DISTINCT clip) FROM runs"
        ).fetchone()
        print(f"  frames of others {shared} in {runs} clips")
    print(f"  compress        {spent['compress']:8.2f} s of processor time")
    ratio = 100 * spent["add"] / spent["compress"] - 100
    print(f"  add             {spent['add']:8.2f} s of processor time, {ratio:+.1f} %")
    return packed


def cuts(files: list[Path], place: Path, most: int = 100) -> None:
    """Add cuts of AMC files, as text, and print what each costs."""
    chance, made = random.Random(1), []
    for path in files:
        data = path.read_bytes() if path.suffix.lower() == ".amc" else b""
        begins = [match.start() for match in _FRAME.finditer(data)]
        if len(begins) > 2 * _CUT:
            first = chance.randrange(len(begins) - _CUT)
            made.append(data[: begins[0]] + data[begins[first] : begins[first + _CUT]])
    made = chance.sample(made, min(most, len(made)))
    path = place / "all.mocapdb"
    before, shared, frames = path.stat().st_size, 0, 0
    with mp.open_library(path, "a") as library:
        for number, data in enumerate(made):
            library.add(data, f"cuts of files/{number}.amc", index=False)
        with library.db.reading() as connection:
            shared, frames = connection.execute(
                "SELECT sum((SELECT sum(frames) FROM runs WHERE clip = id)), sum(frames) "
                "FROM clips WHERE name GLOB 'cuts of files/*'"
            ).fetchone()
    cost = (path.stat().st_size - before) / max(len(made), 1)
    print(
        f"  {len(made)} cuts of {_CUT} frames: {cost:.0f} bytes each; {shared} of {frames} shared"
    )


def processor(work: Callable[[], object]) -> float:
    """Give the processor time of some work, in seconds."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def archives(folder: Path) -> None:
    """Print the sizes of archives of the folder."""
    for name, packer in (("tar.xz", ["xz", "-9e", "-T1"]), ("tar.zst", ["zstd", "-19", "-T1"])):
        if shutil.which(packer[0]) is None:
            print(f"  {name:15} no {packer[0]} here")
            continue
        tar = subprocess.Popen(["tar", "cf", "-", "."], cwd=folder, stdout=subprocess.PIPE)
        done = subprocess.run([*packer, "-c"], stdin=tar.stdout, capture_output=True, check=True)
        tar.wait()
        print(f"  {name:15} {len(done.stdout):12} bytes")


def large(files: list[Path], packed: dict[Path, Path], place: Path, clips: int) -> None:
    """Print the times of a library of many clips."""
    path, names = place / "large.mocapdb", []
    motion = [path for path in files if path.suffix.lower() in (".amc", ".bvh")]
    numbers = [(file, mp.load(packed[file])) for file in motion[:200]]
    with mp.open_library(path, "a") as library, library.db.writing():
        for file, _ in numbers:
            names.append(f"whole/{len(names)}{file.suffix}")
            library.add(packed[file], names[-1])
        for number in range(clips - len(names)):
            _, clip = numbers[number % len(numbers)]
            first = number // len(numbers) % max(clip.frames - 8, 1)
            library.add(clip[first : first + 8], f"cuts/{number}", codec="exact:level=1")
    start = min(command("--version") for _ in range(9))
    listed = min(command("library", "list", path) for _ in range(9))
    print(f"a library of {clips} clips, {path.stat().st_size} bytes")
    print(f"  list            {listed:8.3f} s, {listed - start:+.3f} s beyond start-up")
    beyond = []
    for (file, _), name in list(zip(numbers, names, strict=False))[:20]:

        def load(name: str = name) -> None:
            with mp.open_library(path) as library:
                library.load(name)

        def load_file(file: Path = file) -> None:
            mp.load(packed[file])

        # Processor time: other work on the machine must not count.
        of_library, of_file = (min(processor(w) for _ in range(9)) for w in (load, load_file))
        beyond.append(of_library - of_file)
    middle = sorted(beyond)[len(beyond) // 2]
    print(
        f"  one clip        {1e3 * middle:+8.2f} ms beyond its .mcz, "
        f"at most {1e3 * max(beyond):+.2f}"
    )
    play(path, names)


def play(path: Path, names: Iterable[str], block: int = 512, frames: int = 2048) -> None:
    """Print the time to decode a hundred clips at once, frame by frame; short ones begin again."""
    scene = [*names]
    scene = [scene[i % len(scene)] for i in range(100)]
    with mp.open_library(path) as library:
        lengths = {name: library[name].frames for name in scene}

        def all_at_once() -> None:
            for first in range(0, frames, block):
                for name in scene:
                    at = first % max(lengths[name] // block * block, block)
                    library.load(name, slice(at, at + block))

        spent = processor(all_at_once)
    print(f"  100 at once     {1e3 * spent / frames:8.2f} ms of processor time a frame")


def command(*words: str | Path) -> float:
    """Run a command; give its processor time, as other work on the machine must not count."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*COMMAND, *words], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    main()
