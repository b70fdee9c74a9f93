"""Texts that tell several lies at once; those of tests/formats/test_lying_text.py tell one.

    python tests/campaigns/lies.py [--runs 10000] [--seed N]

Each must come back from its ``.mcz`` byte for byte, and be read, strictly and leniently, or refused
by one error of ours, in two seconds of the processor.
"""

import argparse
import random
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "formats")]
from test_lying_text import CHANGES, WHOLE  # noqa: E402 - of the tests

import mocapress as mp  # noqa: E402 - after it

SECONDS = 2.0


def lying(kind: str, chance: random.Random) -> bytes:
    """Give a file with a few lies, rows that are repeated, and perhaps an end too early."""
    data = WHOLE[kind]
    for old, new in chance.sample(CHANGES[kind], chance.randint(2, 4)):
        data = data.replace(old, new, 1)
    if chance.random() < 0.3:
        lines = data.split(b"\n")
        at = chance.randrange(len(lines))
        data = b"\n".join([*lines[:at], *lines[at : at + 3] * chance.randint(2, 40), *lines[at:]])
    if chance.random() < 0.3:
        data = data[: chance.randrange(len(data) + 1)]
    return data.replace(b"\n", chance.choice((b"\n", b"\n", b"\r\n", b"\r")))


def tried(data: bytes, path: Path) -> None:
    """Work on a file; what is wrong is an assertion, or an error that is none of ours."""
    if path.suffix != ".asf":
        assert mp.decompress(mp.compress(data)) == data, "does not come back"
    path.write_bytes(data)
    for strict in (True, False):
        try:
            if path.suffix == ".asf":
                mp.read(WHOLE[".amc"], asf_path=path, strict=strict)
                continue
            clip = mp.read(path, strict=strict)
            if clip.skeleton is not None:
                with np.errstate(all="ignore"):
                    assert mp.positions(clip).shape[0] == clip.frames
        except mp.MocapressError:
            continue


def main() -> None:
    """Try them all; print what fails, and how to repeat it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**32)
    told = parser.parse_args()
    warnings.simplefilter("ignore")
    failed, slowest = 0, 0.0
    folder = tempfile.TemporaryDirectory()
    for number in range(told.runs):
        chance = random.Random(f"{told.seed}:{number}")
        kind = chance.choice([*WHOLE])
        data = lying(kind, chance)
        begin = time.process_time()
        try:
            tried(data, Path(folder.name, f"a{kind}"))
        except Exception as error:  # noqa: BLE001 - whatever it is, it is a fault
            failed += 1
            print(f"{kind} {number}: {type(error).__name__}: {str(error)[:200]}", flush=True)
        spent = time.process_time() - begin
        slowest = max(slowest, spent)
        if spent > SECONDS:
            failed += 1
            print(f"{kind} {number}: {spent:.1f} s", flush=True)
    print(f"seed {told.seed}: {told.runs} runs, {failed} faults, slowest {slowest:.2f} s")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
