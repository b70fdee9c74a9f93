"""Kill commands at random moments, and before every call of the system; nothing may be lost.

After each kill: the inputs are as they were; every file in the output folder is whole, the old one
or the new one; and after a second, undisturbed run of the same command every output is there and
nothing else. Ends with an error that names scenario and seed where one of these does not hold.

    python tests/campaigns/kills.py --runs 1000 [--corpus FOLDER] [--seed N] [--every-call ...]
"""

import argparse
import contextlib
import io
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: forks want one thread

sys.path[:0] = [str(Path(__file__).parents[1])]
from dying import counted  # noqa: E402

SAMPLES = Path(__file__).parents[2] / "samples"
OLD = b"an old file, whole\n" * 1000
Contents = dict[str, bytes]


class LossError(Exception):
    """Something was lost, torn or left behind."""


@dataclass(frozen=True)
class Scenario:
    name: str
    words: tuple[str, ...]
    """With ``in`` and ``packed`` as folders of inputs and ``out`` as that of outputs."""
    force: bool
    expected: Contents
    """Outputs of a run that nothing disturbs."""
    seconds: float
    """How long it takes."""

    def prepare(self) -> None:
        shutil.rmtree("out", ignore_errors=True)
        Path("out").mkdir()
        if self.force:
            for name in self.expected:
                Path("out", name).write_bytes(OLD)

    def run(self) -> None:
        from mocapress.cli.app import app

        app([*self.words, *(["--force"] if self.force else [])], standalone_mode=False)


def contents(*folders: str) -> Contents:
    """Give the files of folders by their names."""
    paths = [path for folder in folders for path in sorted(Path(folder).rglob("*"))]
    return {path.name: path.read_bytes() for path in paths if path.is_file()}


def gather(corpus: Path | None, frames: int | None, choice: random.Random) -> None:
    """Put clips into ``in``: of the corpus, small ones at random, else of the samples."""
    Path("in").mkdir()
    clips = [SAMPLES / "freebvh.bvh", SAMPLES / "mocapbank.bvh", SAMPLES / "cmu_01_01.amc"]
    if corpus:
        small = [p for p in sorted(corpus.rglob("*")) if 20_000 < p.stat().st_size < 200_000]
        for i, (suffix, most) in enumerate(((".bvh", 2), (".amc", 1))):
            found = [path for path in small if path.suffix.lower() == suffix]
            clips[2 * i : 2 * i + most] = choice.sample(found, most)
    for clip in clips:
        made = Path("in", clip.name)
        made.write_bytes(clip.read_bytes() if frames is None else _cut(clip, frames))
        print(f"input: {clip.name}, {made.stat().st_size} bytes")
    skeleton = next(iter(sorted(clips[2].parent.glob("*.[aA][sS][fF]"))))
    shutil.copy(skeleton, Path("in", clips[2].stem + ".asf"))


def _cut(clip: Path, frames: int) -> bytes:
    """Keep the first frames of a sample."""
    lines = clip.read_bytes().splitlines(keepends=True)
    if clip.suffix == ".amc":
        ends = [i for i, line in enumerate(lines) if line.strip() == b"%d" % (frames + 1)]
        return b"".join(lines[: ends[0]])
    start = next(i for i, line in enumerate(lines) if line.startswith(b"Frames:"))
    lines[start] = b"Frames: %d\n" % frames
    return b"".join(lines[: start + 2 + frames])


def scenarios() -> Iterator[Scenario]:
    """Give what is to be disturbed: each command, one file and many, with ``--force`` and not."""
    run_forked(lambda: _app("compress", "in", "-o", "packed/", "--level", "1"))
    bvh = next(path.name for path in sorted(Path("in").iterdir()) if path.suffix.lower() == ".bvh")
    amc = next(path.name for path in sorted(Path("in").iterdir()) if path.suffix.lower() == ".amc")
    commands = {
        "compress one": ("compress", f"in/{bvh}", "-o", "out/"),
        "compress many": ("compress", "in", "-o", "out", "-j", "2", "--level", "1"),
        "decompress one": ("decompress", f"packed/{amc}.mcz", "-o", "out/"),
        "decompress many": ("decompress", "packed", "-o", "out", "-j", "2"),
        "convert one": ("convert", f"in/{bvh}", "--to", "amc", "-o", "out/"),
        "convert many": ("convert", "in", "--to", "amc", "-o", "out"),
        "convert amc": ("convert", f"in/{amc}", "--to", "bvh", "-o", "out/"),
        "train": ("train", "in", "-o", "out/model.mcm"),
    }
    for name, words in commands.items():
        first = Scenario(name, words, force=False, expected={}, seconds=0)
        first.prepare()
        start = time.monotonic()
        run_forked(first.run)
        seconds = time.monotonic() - start
        expected = contents("out")
        if not expected:
            raise LossError(f"{name}: makes nothing")
        for force in (False, True):
            yield Scenario(name, words, force=force, expected=expected, seconds=seconds)


def _app(*words: str) -> None:
    from mocapress.cli.app import app

    app(list(words), standalone_mode=False)


def fork(work: Callable[[], object]) -> int:
    """Start work in a process of its own, without anything printed."""
    child = os.fork()
    if child:
        return child
    try:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        work()
    finally:
        os._exit(0)


def ended(child: int) -> bool:
    """Wait; say whether it was killed."""
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


def run_forked(work: Callable[[], object]) -> None:
    ended(fork(work))


def check_killed(scenario: Scenario, inputs: Contents) -> str:
    """Check what a kill has left; give the state in a word."""
    if contents("in", "packed") != inputs:
        raise LossError(f"{scenario.name}: an input has changed")
    left = contents("out")
    outputs = {name: data for name, data in left.items() if not name.startswith(".mocapress-")}
    old = dict.fromkeys(scenario.expected, OLD) if scenario.force else {}
    for name, data in outputs.items():
        if data not in (scenario.expected.get(name), old.get(name)):
            raise LossError(f"{scenario.name}: {name} is torn: {len(data)} bytes")
    if scenario.force and outputs.keys() != old.keys():
        raise LossError(f"{scenario.name}: {old.keys() - outputs.keys()} is lost")
    rest = ", temporary files left" if len(outputs) < len(left) else ""
    if outputs == old:
        return "nothing written" + rest
    return ("all written" if outputs == scenario.expected else "some written") + rest


def check_second_run(scenario: Scenario, inputs: Contents) -> None:
    """Run the same again, undisturbed; check that all is there and nothing else."""
    run_forked(scenario.run)
    if contents("in", "packed") != inputs:
        raise LossError(f"{scenario.name}: an input has changed")
    found = contents("out")
    if found != scenario.expected:
        wrong = {name for name in found if found[name] != scenario.expected.get(name)}
        missing = scenario.expected.keys() - found.keys()
        raise LossError(f"{scenario.name}: after a second run {wrong} is wrong, {missing} missing")


def at_random(
    planned: list[Scenario], runs: int, inputs: Contents, choice: random.Random
) -> Counter[str]:
    """Kill commands at random: half at any moment of their work, half once they are writing."""
    states: Counter[str] = Counter()
    seconds = {scenario.name: scenario.seconds for scenario in planned}
    kills = 0
    for i in count():
        if kills == runs:
            return states
        scenario = planned[i % len(planned)]
        scenario.prepare()
        child = fork(scenario.run)
        if i // len(planned) % 2:
            wait_for_writing(child)
            time.sleep(choice.uniform(0, seconds[scenario.name] / 4))
        else:
            time.sleep(choice.uniform(0, seconds[scenario.name]))
        os.kill(child, signal.SIGKILL)
        if ended(child):
            kills += 1
            states[check_killed(scenario, inputs)] += 1
        else:
            states["ended before the kill"] += 1
        start = time.monotonic()
        check_second_run(scenario, inputs)
        if scenario.force:  # which takes as long as the first run would; loads change
            seconds[scenario.name] = time.monotonic() - start
    return states


def wait_for_writing(child: int) -> None:
    """Wait for the first temporary file, or the end of the process."""
    while not any(Path("out").glob(".mocapress-*")):
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            return


def at_every_call(planned: Iterable[Scenario], inputs: Contents) -> Counter[str]:
    """Kill commands before the first call of the system, the second, and so on."""
    states: Counter[str] = Counter()
    for scenario in planned:
        for n in count(1):
            scenario.prepare()

            def work(n: int = n, scenario: Scenario = scenario) -> None:
                with counted(n):
                    scenario.run()

            if not ended(fork(work)):
                break
            states[check_killed(scenario, inputs)] += 1
            check_second_run(scenario, inputs)
    return states


def main() -> None:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else "")
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    parser.add_argument("--corpus", type=Path, help="folder of clips; else the samples are taken")
    parser.add_argument("--frames", type=int, help="keep only so many of each sample")
    parser.add_argument("--every-call", nargs="*", metavar="SCENARIO", help="without names: all")
    options = parser.parse_args()
    print(f"seed: {options.seed}", flush=True)
    choice = random.Random(options.seed)
    corpus = options.corpus.resolve() if options.corpus else None
    with tempfile.TemporaryDirectory(prefix="kills-") as folder:
        os.chdir(folder)
        gather(corpus, options.frames, choice)
        with contextlib.redirect_stdout(io.StringIO()):
            _warm()
        planned = list(scenarios())
        inputs = contents("in", "packed")
        for scenario in planned:
            print(f"{scenario.name}{', --force' * scenario.force}: {scenario.seconds:.2f} s")
        _print("kills at random moments", at_random(planned, options.runs, inputs, choice))
        if options.every_call is not None:
            named = [s for s in planned if s.name in options.every_call or not options.every_call]
            _print("kills before every call", at_every_call(named, inputs))
        os.chdir("/")


def _warm() -> None:
    """Import all that the commands import, so that kills fall into their work."""
    _app("compress", "in", "-o", "warm/", "--level", "1")
    _app("decompress", "warm", "-o", "warm/back")
    _app("convert", "in", "--to", "amc", "-o", "warm/converted")
    _app("train", "in", "-o", "warm/model.mcm")
    shutil.rmtree("warm")


def _print(title: str, states: Counter[str]) -> None:
    print(f"{title}: {sum(states.values())} runs")
    for state, number in sorted(states.items()):
        print(f"    {number:5} {state}")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
