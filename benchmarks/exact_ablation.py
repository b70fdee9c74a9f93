"""Measures what each part of `exact` brings, its levels, and chunks of other lengths.

    OPENBLAS_NUM_THREADS=1 python benchmarks/exact_ablation.py CORPUS/amc/cmu

Takes every twelfth AMC clip, from the third on. Sizes are those of whole ``.mcz`` files without the
ASF, each restored and compared; times are processor times (``time.process_time``) of one run.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

import mocapress
from mocapress import api
from mocapress.api import compressing
from mocapress.codecs.exact import Exact, codec
from mocapress.codecs.exact.roles import Role, Roles, _exponents, _turns
from mocapress.motion import Clip, Column
from mocapress.source import Source
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]
Change = Callable[[Roles, Array], Roles]
FIRST, EVERY, STRONGEST = 2, 12, 9
CHUNKS = (512, 1024, 2048, 4096, WHOLE := 1 << 20)
TIMES = ("find roles µs/frame", "encode µs/frame", "decode µs/frame")
FLOAT64 = (0, 0)  # of core/numbers/line.hpp
find_roles = codec._roles


class Sample(NamedTuple):
    """A file, and what it holds."""

    source: Source
    clip: Clip


def with_roles(roles: Roles, values: Array, told: Sequence[Role]) -> Roles:
    """Have columns coded in other roles."""
    exponents, turns = tuple(_exponents(values, told)), tuple(_turns(values, told))
    return replace(roles, roles=tuple(told), exponents=exponents, turns=turns)


def predicted(roles: Roles, values: Array) -> Roles:
    """Have rounding noise coded like the usual columns."""
    told = [Role.PREDICTED if role is Role.NOISE else role for role in roles.roles]
    return with_roles(roles, values, told)


def coded(roles: Roles, values: Array) -> Roles:
    """Have copies coded like the columns that they copy."""
    return with_roles(roles, values, [roles.roles[column] for column in roles.originals])


def doubles(roles: Roles, _: Array) -> Roles:
    """Have predicted columns hold any float64."""
    told = zip(roles.lines, roles.roles, strict=True)
    lines = tuple(FLOAT64 if role is Role.PREDICTED else line for line, role in told)
    return replace(roles, lines=lines)


PARTS: dict[str, Change] = {
    "everything": lambda roles, _: roles,
    "without geometry": lambda roles, _: replace(roles, skeleton=0),
    "without laws and couplings": lambda roles, _: replace(roles, couplings=()),
    "without either": lambda roles, _: replace(roles, skeleton=0, couplings=()),
    "rounding noise predicted": predicted,
    "copies coded": coded,
    "float64 in place of decimal lines": doubles,
}


def size(sample: Sample, exact: Exact) -> int:
    """Give the size of the file that the codec makes, be it larger than other ways would."""
    with patch.object(compressing, "may_be_smaller", lambda *_: False):
        made = api.compress_source(sample.source, exact)
    if made.warning or not api.Opened(Source(made.blob)).streams:
        sys.exit(made.warning or "the codec made no file")
    return len(made.blob)


def size_with(samples: Sequence[Sample], change: Change) -> int:
    """Give the size of all files with other roles."""

    def roles(values: Array, columns: Sequence[Column], level: int) -> Roles:
        return change(find_roles(values, columns, level), values)

    with patch.object(codec, "_roles", roles):
        return sum(size(sample, Exact(level=STRONGEST)) for sample in samples)


def times(samples: Sequence[Sample], exact: Exact) -> list[str]:
    """Give µs per frame to find the roles, to encode besides, and to decode."""
    spent = np.zeros(3)
    for _, clip in samples:
        begin = process_time()
        find_roles(np.ascontiguousarray(clip.values), clip.columns, exact.level)
        found = process_time()
        encoded = exact.encode(clip)
        coded = process_time()
        exact.decode(encoded.header, encoded.chunks, clip.columns)
        finding, encoding, decoding = np.diff([begin, found, coded, process_time()])
        spent += finding, encoding - finding, decoding
    return [f"{1e6 * time:.1f}" for time in spent / sum(sample.clip.frames for sample in samples)]


def main(corpus: Path) -> None:
    """Measure, and print the tables."""
    paths = sorted(corpus.rglob("*.amc"))[FIRST::EVERY]
    samples = [Sample(Source(path), mocapress.read(path)) for path in paths]
    raw = sum(sample.source.size for sample in samples)
    frames = [sample.clip.frames for sample in samples]
    print(f"{len(samples)} clips, {sum(frames):,} frames, {raw:,} bytes.\n")

    def row(name: str, total: int, *more: str) -> list[str]:
        share = total / usual - 1
        return [name, f"{total:,}", f"{raw / total:.3f}", f"{100 * share:+.2f} %", *more]

    usual = sum(size(sample, Exact(level=STRONGEST)) for sample in samples)
    header = ["bytes", "ratio", "more"]
    rows = [row(part, size_with(samples, change)) for part, change in PARTS.items()]
    print(markdown([f"level {STRONGEST}", *header], rows))
    rows = []
    for exact in map(Exact, range(1, STRONGEST + 1)):
        total = sum(size(sample, exact) for sample in samples)
        rows.append(row(str(exact.level), total, *times(samples, exact)))
    print(markdown(["level", *header, *TIMES], rows))
    rows = []
    for chunk in CHUNKS:
        sizes = [size(sample, Exact(level=STRONGEST, chunk=chunk)) for sample in samples]
        own = str(sum(count > chunk for count in frames)), f"{sizes[int(np.argmax(frames))]:,}"
        rows.append(row("whole clips" if chunk == WHOLE else str(chunk), sum(sizes), *own))
    header += ["clips cut", f"clip of {max(frames):,} frames"]
    print(markdown(["frames a chunk", *header], rows), end="")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
