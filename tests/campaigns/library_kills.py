"""Kill and disturb processes that write to a library; nothing that had been done may be lost.

A process adds, removes and recompresses clips, some of which share frames, and says after each
step that it is done. It is killed at random moments, before the n-th write, sync, truncation or
deletion of a library's file, or this call fails with an error of the system, alone or with all
that follow, for every n. Afterwards the library opens again, has everything that was said to be
done and of the rest each step as a whole or not at all, is sound, and is one file once it is
closed.

    python tests/campaigns/library_kills.py --runs 200 [--seed N] [--stride N]
"""

import argparse
import ctypes
import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: forks want one thread

sys.path[:0] = [str(Path(__file__).parents[1])]
from takes import amc_of, rows_of  # noqa: E402

SAMPLE = Path(__file__).parents[2] / "samples" / "cmu_01_01.amc"
LIBRARY = Path("library.mocapdb")
PRELOADED = "LIBRARY_KILLS_SHIM"
Contents = dict[str, bytes]


class LossError(Exception):
    """Something was lost or torn."""


@dataclass(frozen=True)
class Step:
    """What is done to the library in one transaction."""

    what: str
    name: str
    data: bytes = b""

    def run(self, library: object) -> None:
        from mocapress.library import Library

        assert isinstance(library, Library)
        if self.what == "add":
            library.add(self.data, self.name, codec="exact:level=1", replace=True)
        elif self.what == "remove":
            library.remove(self.name)
        else:
            library.recompress(self.name, "exact:level=2")

    def apply(self, contents: Contents) -> Contents:
        """Give what the library holds afterwards."""
        if self.what == "add":
            return {**contents, self.name: self.data}
        if self.what == "remove":
            return {name: data for name, data in contents.items() if name != self.name}
        return contents


def prepare() -> tuple[Contents, list[Step]]:
    """Make the library that each run begins with; give what is in it, and the steps."""
    from mocapress.library import open_library

    header, rows = rows_of(SAMPLE.read_bytes())
    start = {
        "take.amc": amc_of(header, rows[:260]),
        "cut.amc": amc_of(header, rows[40:200]),
        "other.amc": amc_of(header, rows[300:400]),
        "text.amc": b"no motion " * 300,
    }
    with open_library(LIBRARY, "a") as library:
        for name, data in start.items():
            library.add(data, name, codec="exact:level=1")
    shutil.copy(LIBRARY, "start")
    steps = [
        Step("add", "new.amc", amc_of(header, rows[500:600])),
        Step("add", "cut 2.amc", amc_of(header, rows[100:250])),
        Step("remove", "take.amc"),
        Step("recompress", "other.amc"),
        Step("add", "cut.amc", amc_of(header, rows[30:190])),
        Step("remove", "text.amc"),
        Step("recompress", "cut 2.amc"),
        Step("remove", "cut 2.amc"),
    ]
    return start, steps


def reset() -> None:
    for path in Path().glob(f"{LIBRARY}*"):
        path.unlink()
    shutil.copy("start", LIBRARY)


def work(steps: list[Step], said: int, before: Callable[[], None]) -> None:
    """Do the steps; say of each by a byte whether it was done or failed."""
    from mocapress.errors import MocapressError
    from mocapress.library import open_library

    with open_library(LIBRARY, "a") as library:
        before()
        for step in steps:
            try:
                step.run(library)
            except (MocapressError, OSError):
                os.write(said, b"-")
            else:
                os.write(said, b"+")


def run(
    steps: list[Step], before: Callable[[], None], kill: float | None = None
) -> tuple[str, bool]:
    """Do the steps in a process of their own; give what it said, and whether it was killed."""
    reset()
    mouth = os.pipe()
    child = os.fork()
    if not child:
        try:
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, 1)
            os.dup2(null, 2)
            work(steps, mouth[1], before)
        finally:
            os._exit(0)
    os.close(mouth[1])
    if kill is not None:
        time.sleep(kill)
        os.kill(child, signal.SIGKILL)
    with os.fdopen(mouth[0], "rb") as ear:
        said = ear.read().decode()
    return said, os.WIFSIGNALED(os.waitpid(child, 0)[1])


def check(start: Contents, steps: list[Step], said: str, where: str) -> None:
    """Check what the process has left."""
    from mocapress.library import open_library

    allowed = {name: {data} for name, data in start.items()}
    possible: dict[str, set[bytes | None]] = {name: set(data) for name, data in allowed.items()}
    contents = start
    for number, step in enumerate(steps[: len(said) + 1]):
        after = step.apply(contents)
        new = after.get(step.name)
        if said[number : number + 1] == "+":
            possible[step.name], contents = {new}, after
        else:  # it failed, or was under way
            possible[step.name] = possible.get(step.name, {None}) | {new}
    with open_library(LIBRARY, "a") as library:
        faults = [*library.check(), *library.verify()]
        if faults:
            raise LossError(f"{where}: {faults}")
        found = {clip.name: library.read_bytes(clip) for clip in library}
    for name in found.keys() | possible.keys():
        if found.get(name) not in possible.get(name, {None}):
            raise LossError(f"{where}: {name} is not what it was, after {said!r}")
    left = [path.name for path in Path().glob(f"{LIBRARY}*")]
    if left != [str(LIBRARY)]:
        raise LossError(f"{where}: {left} are left")


def at_random(start: Contents, steps: list[Step], runs: int, choice: random.Random) -> Counter[str]:
    """Kill at random moments."""
    states: Counter[str] = Counter()
    begin = time.monotonic()
    run(steps, lambda: None)
    seconds = time.monotonic() - begin
    while sum(states.values()) < runs:
        said, killed = run(steps, lambda: None, choice.uniform(0, seconds))
        check(start, steps, said, "a kill at a random moment")
        if killed:
            states[f"after {len(said)} steps"] += 1
    return states


def at_calls(
    start: Contents, steps: list[Step], shim: ctypes.CDLL, stride: int
) -> Iterator[tuple[str, int]]:
    """Kill before calls, and have them fail; give each way and its number of runs."""
    ways = [
        ("killed before the call", 0, 0),
        ("the call fails", errno.EIO, 0),
        ("all calls fail from then on", errno.EIO, 1),
        ("the disk is full from then on", errno.ENOSPC, 1),
    ]
    last = count(steps, shim)
    for way, (name, error, stay) in enumerate(ways):
        numbers = range(1 + way * stride // len(ways), last + 1, stride)
        for number in numbers:

            def before(number: int = number, error: int = error, stay: int = stay) -> None:
                shim.fail_at(number, error, stay)

            said, _ = run(steps, before)
            check(start, steps, said, f"{name}, call {number}")
        yield name, len(numbers)


def count(steps: list[Step], shim: ctypes.CDLL) -> int:
    """Count the calls of a process that nothing disturbs."""
    reset()
    shim.fail_at(0, 0, 0)
    ear, mouth = os.pipe()
    work(steps, mouth, lambda: None)
    os.close(mouth)
    said = os.read(ear, len(steps) + 1)
    os.close(ear)
    if said != b"+" * len(steps):
        raise LossError(f"an undisturbed process says {said!r}")
    return int(shim.calls())


def main() -> None:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--runs", type=int, default=200, help="kills at random moments")
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    parser.add_argument("--stride", type=int, default=1, help="disturb every n-th call only")
    options = parser.parse_args()
    if PRELOADED not in os.environ:
        again()
    print(f"seed: {options.seed}", flush=True)
    shim = ctypes.CDLL(os.environ[PRELOADED])
    with tempfile.TemporaryDirectory(prefix="library-kills-") as folder:
        os.chdir(folder)
        start, steps = prepare()
        states = at_random(start, steps, options.runs, random.Random(options.seed))
        print(f"kills at random moments: {sum(states.values())} runs")
        for state, number in sorted(states.items()):
            print(f"    {number:5} {state}")
        for name, number in at_calls(start, steps, shim, options.stride):
            print(f"{name}: {number} runs", flush=True)
        os.chdir("/")


def again() -> None:
    """Start this program again with the calls that fail."""
    with tempfile.TemporaryDirectory(prefix="library-kills-") as folder:
        shim = Path(folder) / "failing.so"
        source = Path(__file__).with_name("failing.c")
        compiler = os.environ.get("CC", "cc")
        subprocess.run(
            [compiler, "-shared", "-fPIC", "-O1", "-o", shim, source, "-ldl"], check=True
        )
        more = {PRELOADED: str(shim), "LD_PRELOAD": str(shim)}
        done = subprocess.run([sys.executable, *sys.argv], env={**os.environ, **more}, check=False)
    sys.exit(done.returncode)


if __name__ == "__main__":
    main()
