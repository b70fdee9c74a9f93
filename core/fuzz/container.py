"""Fuzz target of the `.mcz` and `.mcm` readers: any bytes give an error of ours, or the contents.

`python core/fuzz/container.py -runs=N` runs N mutations of the golden files, half of them with
checksums made right again, so that what lies behind these is reached. They follow from a number
that it prints, and takes as `-seed=N`. `one_input` is what atheris takes.
"""

import random
import sys
import warnings
from pathlib import Path

import mocapress as mp
from mocapress.container.sections import section
from mocapress.errors import MocapressError
from mocapress.records import Reader

GOLDEN = Path(__file__).parents[2] / "tests/golden"


def one_input(data: bytes) -> None:
    """Restore, load some frames, salvage, and read as a model."""
    for work in (
        mp.decompress,
        lambda blob: mp.load(blob, frames=slice(3, 9)),
        lambda blob: mp.load(blob, errors="skip", strict=False),
        lambda blob: mp.decompress(blob, salvage=True),
        mp.load_model,
    ):
        try:
            work(data)
        except MocapressError:
            pass


def forged(data: bytes) -> bytes:
    """Make the sections' checksums right, as far as there are sections."""
    reader = Reader(data, "file")
    made = bytearray(reader.raw(min(5, len(data))))
    try:
        while reader.left:
            tag, content = reader.raw(1)[0], reader.bytes()
            reader.raw(4)
            made += section(tag, content)
    except MocapressError:
        pass
    return bytes(made)


def mutated(data: bytes, chance: random.Random) -> bytes:
    """Change, cut out or repeat some bytes, mostly near the front, where the sections are."""
    made = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        place = min(int(chance.expovariate(1 / 80)), len(made) - 1)
        change = chance.randrange(4)
        if change == 0:
            made[place] = chance.randrange(256)
        elif change == 1:
            made[place] ^= 1 << chance.randrange(8)
        elif change == 2:
            del made[place : place + chance.randint(1, 8)]
        else:
            made[place:place] = made[place : place + chance.randint(1, 8)]
    return bytes(made)


def main(runs: int, seed: int) -> None:
    """Run so many mutations."""
    print(f"-runs={runs} -seed={seed}", flush=True)
    warnings.simplefilter("ignore", mp.MotionWarning)
    chance = random.Random(seed)
    seeds = [path.read_bytes() for path in sorted(GOLDEN.glob("*.mc[zm]"))]
    for run in range(runs):
        data = mutated(chance.choice(seeds), chance)
        one_input(forged(data) if run % 2 else data)
    print(f"{runs} mutations of {len(seeds)} files passed")


if __name__ == "__main__":
    options = dict(argument.split("=") for argument in sys.argv[1:])
    main(int(options.get("-runs", 20_000)), int(options.get("-seed", random.randrange(2**32))))
