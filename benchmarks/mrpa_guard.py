"""Whether ``mrpa`` is ever larger than APP, on any library; and which predictions it takes.

Usage: python benchmarks/mrpa_guard.py FOLDER [FOLDER ...]

Of each folder, the clips of the same columns are a library, each group by itself. Bytes are those
of the codec's headers and of all chunks, with 32 for each frame range that they need. The second
table says how many chunks are coded as APP codes them, and which share of all pieces of columns in
others takes which alpha and beta: of these libraries, and of edited copies of parts of the first
takes (``mocapress_bench/mrpa_planted.py``), where there are parents.
"""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core
from mocapress.codecs import Encoded, Together, codec
from mocapress.codecs.mrpa import Mrpa, coding
from mocapress.motion import Clip, Stream
from mocapress.records import Reader
from mocapress_bench.inputs import clips_in
from mocapress_bench.mrpa_planted import plant, size_of
from mocapress_bench.tables import markdown

ALPHAS = ("0", "0.25", "0.5", "0.75", "0.875", "1", "1.25")
BETAS = ("0", "0.125", "0.25", "0.375", "0.5", "0.625", "0.75", "1")
AS_APP = -1
TAKES = 6
Taken = Counter[tuple[int, int | None]]


def groups_of(folder: Path) -> list[list[Clip]]:
    """Give the clips of the same columns."""
    groups: dict[tuple[str, ...], list[Clip]] = {}
    for path in clips_in(folder):
        clip = mp.read(path, strict=False)
        if clip.frames and clip.channels:
            groups.setdefault(tuple(c.name for c in clip.columns), []).append(clip)
    return list(groups.values())


def bytes_of(clips: Sequence[Clip], spec: str) -> int:
    """Give the bytes of clips that are coded one by one."""
    made = [codec(spec).encode(clip.main, skeleton=clip.skeleton) for clip in clips]
    return size_of(Together(tuple(made), {}))


def taken(streams: Sequence[Stream], made: Together, counts: Taken) -> None:
    """Count which alphas and betas the pieces of columns take."""
    values = [np.ascontiguousarray(stream.values, dtype=np.float64) for stream in streams]
    others = {
        digest: values[origin.stream][origin.first : origin.first + origin.frames]
        for digest, origin in made.origins.items()
    }
    for own, one, stream in zip(values, made.encoded, streams, strict=True):
        _count(own, one, stream, others, counts)


def _count(
    values: NDArray[np.float64],
    encoded: Encoded,
    stream: Stream,
    others: Mapping[bytes, NDArray[np.float64]],
    counts: Taken,
) -> None:
    plan = coding.unpack_header(encoded.header, stream.columns)
    for chunk in encoded.chunks:
        rows = values[chunk.first : chunk.first + chunk.frames]
        reader = Reader(chunk.payload, "chunk")
        pieces = coding.read_pieces(reader, chunk, len(plan), others)
        if not pieces:
            counts[AS_APP, None] += 1
            continue
        table, beside = coding.table_of(pieces), coding.beside(rows, pieces)
        found = np.array(_core.mrpa_weights(rows, beside, table, plan))
        for n, (alpha, beta) in enumerate(found.reshape(-1, 2).tolist()):
            parent = pieces[n % len(pieces)].parent
            counts[alpha, None if parent is None else beta] += 1


def shares(counts: Taken) -> list[str]:
    """Give the shares of alphas without a parent, and of betas with one, in percent."""
    as_app = counts[AS_APP, None]
    alone = sum(n for (_, beta), n in counts.items() if beta is None) - as_app
    beside = sum(counts.values()) - alone
    first = [f"{100 * counts[a, None] / alone:.1f}" if alone else "" for a in range(len(ALPHAS))]
    of = [sum(n for (_, beta), n in counts.items() if beta == b) for b in range(len(BETAS))]
    return [
        str(as_app),
        str(alone),
        *first,
        str(beside),
        *(f"{100 * n / beside:.1f}" if beside else "" for n in of),
    ]


def main() -> None:
    """Measure each folder."""
    made = codec("mrpa")
    assert isinstance(made, Mrpa)
    rows, raw, worst = [], Taken(), -np.inf
    takes: list[Clip] = []
    for folder in map(Path, sys.argv[1:]):
        for clips in groups_of(folder):
            streams = [clip.main for clip in clips]
            together = made.encode_together(streams, skeleton=clips[0].skeleton)
            taken(streams, together, raw)
            sizes = [bytes_of(clips, spec) for spec in ("app", "app:mantissa_limit=53", "mrpa")]
            sizes.append(size_of(together))
            needs = sum(len(chunk.needs) for one in together.encoded for chunk in one.chunks)
            against = 100 * (sizes[3] / max(min(sizes[:2]), 1) - 1)
            worst = max(worst, against)
            frames = sum(clip.frames for clip in clips)
            told = [folder.name, len(clips), frames, clips[0].channels, *sizes, needs]
            rows.append([*map(str, told), f"{against:+.2f} %"])
            print(*rows[-1], file=sys.stderr, flush=True)
            names = [c.name for c in (takes[0] if takes else clips[0]).columns]
            if len(takes) < TAKES and [c.name for c in clips[0].columns] == names:
                takes += [clip[:960] for clip in clips if clip.frames > 240][: TAKES - len(takes)]
    head = [
        "library", "clips", "frames", "channels", "APP", "APP in context", "mrpa, no parents",
        "mrpa", "parents", "mrpa against the smaller APP",
    ]  # fmt: skip
    print(markdown(head, rows))
    print(f"At most {worst:+.2f} %.\n")
    planted = Taken()
    if takes:
        copies = plant(takes)
        together = made.encode_together(copies.streams, skeleton=takes[0].skeleton)
        taken(copies.streams, together, planted)
    head = ["pieces of columns", "takes", "edited copies"]
    names = ["chunks as of APP", "without a parent", *(f"α = {a}, %" for a in ALPHAS)]
    names += ["with a parent", *(f"β = {b}, %" for b in BETAS)]
    both = zip(names, shares(raw), shares(planted), strict=True)
    print(markdown(head, [list(cells) for cells in both]))


if __name__ == "__main__":
    main()
