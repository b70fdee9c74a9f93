"""A library in which it is known what recurs: takes, and edited copies of parts of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.codecs import Together
from mocapress.codecs.mrpa import Mrpa, Thresholds, analyse, som
from mocapress.codecs.mrpa.together import Relation, encode_spans, spans_of
from mocapress.formats.number_formats import printed
from mocapress.motion import Clip, Stream

_SHORTEST, _LONGEST = 240, 960
_ENOUGH = 0.8
"""IoU on both sides from which a pair counts as found."""


@dataclass(frozen=True, slots=True, eq=False)
class Planted:
    """Streams, and which frames were copied from which."""

    streams: list[Stream]
    starts: NDArray[np.int64]
    pairs: list[Relation]
    """Frames of the database one behind the other; those of copies are behind their originals."""


def plant(takes: Sequence[Clip], seed: int = 1) -> Planted:
    """Cut a part of each take, edit it, and put it behind the takes as a clip of its own.

    A smooth offset of up to a degree is added to a third of the channels, numbers are rounded to
    the format of the take again, and every other copy starts in the middle: its second half comes
    first.
    """
    random = np.random.default_rng(seed)
    streams = [take.main for take in takes]
    origins = np.cumsum([0, *(stream.frames for stream in streams)])
    pairs, copies = [], []
    end = int(origins[-1])
    for number, take in enumerate(takes):
        count = min(int(random.integers(_SHORTEST, _LONGEST)), take.frames)
        first = int(random.integers(0, take.frames - count + 1))
        halves = [np.arange(first, first + count)]
        if number % 2:
            halves = [halves[0][count // 2 :], halves[0][: count // 2]]
        values = np.concatenate([edited(take.values[half], random) for half in halves])
        copies.append(replace(take.main, values=rounded(values, take.main)))
        for half in halves:
            pairs.append(Relation(end, half + int(origins[number])))
            end += len(half)
    streams += copies
    starts = np.cumsum([0, *(stream.frames for stream in streams)]).astype(np.int64)
    return Planted(streams, starts, pairs)


def edited(values: NDArray[np.float64], random: np.random.Generator) -> NDArray[np.float64]:
    """Add a smooth offset to a third of the channels."""
    frames, channels = values.shape
    time = np.arange(frames)[:, None] / 120
    waves = np.cos(random.uniform(0.3, 2, channels) * time + random.uniform(0, 6, channels))
    moved = random.random(channels) < 1 / 3
    return np.asarray(values + np.where(moved, random.uniform(0, 1, channels) * waves, 0))


def rounded(values: NDArray[np.float64], stream: Stream) -> NDArray[np.float64]:
    """Round to what the source's format of each column prints."""
    columns = []
    for column, numbers in zip(stream.columns, values.T, strict=True):
        texts = printed(numbers, column.decimal) if column.decimal else numbers
        columns.append(np.array([float(text) for text in texts]))
    return np.stack(columns, axis=1)


def measure_planted(takes: Sequence[Clip]) -> dict[str, Any]:
    """Say how many planted pairs are found, and what parents bring against the oracle."""
    made = plant(takes)
    codec = codecs.codec("mrpa")
    assert isinstance(codec, Mrpa)
    found = analyse(made.streams, takes[0].skeleton, Thresholds(), deepest=True)
    h, v = found.paths.h, found.paths.v
    hits = 0
    for first, at in made.pairs:
        alike = som.iou(h, first, first + len(at) - 1), som.iou(v, int(at[0]), int(at[-1]))
        turned = som.iou(v, first, first + len(at) - 1), som.iou(h, int(at[0]), int(at[-1]))
        best = max((np.minimum(*both).max(initial=0) for both in (alike, turned)), default=0)
        hits += bool(best >= _ENOUGH)
    spans = spans_of(made.pairs, made.starts, codec.chunk)
    alone = size_of(
        replace(codec, depth=0).encode_together(made.streams, skeleton=takes[0].skeleton)
    )
    own = size_of(codec.encode_together(made.streams, skeleton=takes[0].skeleton))
    oracle = size_of(encode_spans(codec, made.streams, takes[0].skeleton, made.starts, spans))
    return {
        "frames": int(made.starts[-1]),
        "planted": len(made.pairs),
        "found": hits,
        "no parents, bytes": alone,
        "mrpa, bytes": own,
        "oracle, bytes": oracle,
        "of what the oracle saves": (alone - own) / (alone - oracle),
    }


def size_of(made: Together) -> int:
    """Give the bytes of the codec's headers and of all chunks, with what they need."""
    chunks = [chunk for encoded in made.encoded for chunk in encoded.chunks]
    heads = sum(len(encoded.header) for encoded in made.encoded)
    return heads + sum(len(chunk.payload) + 32 * len(chunk.needs) for chunk in chunks)
