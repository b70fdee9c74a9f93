"""Coding the clips of a library together: which pieces have which parents, and what it brings.

A parent's frames lie in chunks that are coded before, so nothing goes round in a circle, across
clips neither; and no chunk has more than ``depth`` chunks in a row above it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.contract import Chunk, Encoded, Origin, Together, digest_of
from mocapress.codecs.mrpa import coding
from mocapress.codecs.mrpa.coding import Parent, Piece, Plan, Values
from mocapress.codecs.mrpa.forest import alignment
from mocapress.codecs.mrpa.patterns import Patterns, Thresholds, analyse
from mocapress.motion import Skeleton, Stream

if TYPE_CHECKING:
    from mocapress.codecs.mrpa.codec import Mrpa

_LEAST_FRAMES = 16
"""A shorter piece costs more than its parent can save."""
_NEED_BITS = 8 * 128
"""About what naming a parent costs: 32 bytes in the chunk, and a row of the library."""


class Relation(NamedTuple):
    """Frames of the database, and those that predict them."""

    first: int
    at: NDArray[np.int64]
    """For each frame from ``first`` on, the one that predicts it."""


class Span(NamedTuple):
    """A chunk to be: frames of the database, and what of them has parents, in order."""

    first: int
    stop: int
    relations: tuple[Relation, ...] = ()


def encode_together(
    codec: "Mrpa", streams: Sequence[Stream], skeleton: Skeleton | None
) -> Together:
    """Code streams of the same columns; see ``Codec.encode_together``."""
    radius = codec.radius or None
    thresholds = Thresholds(codec.valid_path, codec.length, codec.iou, radius)
    published = codec.mode == "published"
    found = analyse(streams, skeleton, thresholds, deepest=not published)
    if published:
        spans = published_spans(found, codec.depth)
    else:
        spans = best_spans(found, codec.chunk)
    return encode_spans(codec, streams, skeleton, found.starts, spans)


def published_spans(found: Patterns, depth: int) -> list[Span]:
    """Give a chunk for each segment of the forest, parents before their children.

    A segment below the allowed depth becomes a root.
    """
    built = found.forest()
    levels = np.zeros(len(built.segments), np.int64)
    spans = []
    for segment in built.breadth_first().tolist():
        first, last = built.segments[segment].tolist()
        parent = int(built.parents[segment])
        relations: tuple[Relation, ...] = ()
        if parent >= 0 and levels[parent] < depth:
            levels[segment] = levels[parent] + 1
            relations = (Relation(first, alignment(built, found.paths, segment)),)
        spans.append(Span(first, last + 1, relations))
    return spans


def best_spans(found: Patterns, chunk: int) -> list[Span]:
    """Give chunks of so many frames, with the paths to frames before them, the deepest first."""
    return spans_of(covering(found), found.starts, chunk)


def spans_of(relations: Sequence[Relation], starts: NDArray[np.int64], chunk: int) -> list[Span]:
    """Give chunks of so many frames, with their parts of relations that lead back in time.

    Parameters
    ----------
    relations
        None of which have frames in common; the frames of each follow each other in one clip, and
        so do those that predict them.
    starts
        (clips + 1,) first frame of each clip.
    chunk
        Frames.

    """
    relations = sorted(relations, key=lambda relation: relation.first)
    spans = []
    at = 0
    for start, end in zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True):
        for first in range(start, end, chunk):
            stop = min(first + chunk, end)
            inside = []
            while at < len(relations) and relations[at].first < stop:
                begin, pairs = relations[at]
                here = max(first - begin, 0)
                part = Relation(begin + here, pairs[here : stop - begin])
                # A parent lies in chunks before this one.
                part = part._replace(at=part.at[: np.searchsorted(part.at, first)])
                if len(part.at) >= _LEAST_FRAMES:
                    inside.append(part)
                if begin + len(pairs) > stop:
                    break
                at += 1
            spans.append(Span(first, stop, tuple(inside)))
    return spans


def covering(found: Patterns) -> list[Relation]:
    """Choose paths back in time so that no frame is in two, the deepest first."""
    paths = found.paths
    h, v = paths.h, paths.v
    order = np.lexsort((paths.distance / np.maximum(paths.depth, 1), -paths.depth))
    free = np.ones(len(found.clips), np.bool_)
    chosen = []
    for path in order[v[order, 1] < h[order, 0]].tolist():
        first, last = h[path].tolist()
        edges = np.flatnonzero(np.diff(free[first : last + 1], prepend=False, append=False))
        for begin, end in zip(edges[0::2].tolist(), edges[1::2].tolist(), strict=True):
            if end - begin >= _LEAST_FRAMES:
                matches = paths.matches(path)[begin:end].astype(np.int64)
                chosen.append(Relation(first + begin, matches))
                free[first + begin : first + end] = False
    return chosen


@dataclass(slots=True)
class _Library:
    """What was coded so far."""

    codec: "Mrpa"
    values: list[Values]
    starts: NDArray[np.int64]
    plans: list[Plan]
    levels: NDArray[np.int64]
    """(F,) how many chunks each frame's chunk has above it."""
    origins: dict[bytes, Origin] = field(default_factory=dict)


def encode_spans(
    codec: "Mrpa",
    streams: Sequence[Stream],
    skeleton: Skeleton | None,
    starts: NDArray[np.int64],
    spans: Sequence[Span],
) -> Together:
    """Code chunks in their order: each parent lies in chunks that come before."""
    values = [np.ascontiguousarray(stream.values, dtype=np.float64) for stream in streams]
    plans = [
        coding.plan_for(own, stream.columns, skeleton)
        for own, stream in zip(values, streams, strict=True)
    ]
    levels = np.zeros(int(starts[-1]), np.int64)
    library = _Library(codec, values, starts, plans, levels)
    chunks: list[list[Chunk]] = [[] for _ in streams]
    for span in spans:
        clip = int(np.searchsorted(starts, span.first, "right")) - 1
        chunks[clip].append(_encode_span(library, clip, span))
    encoded = (
        Encoded(coding.pack_header(plan, own), tuple(sorted(own, key=lambda chunk: chunk.first)))
        for plan, own in zip(plans, chunks, strict=True)
    )
    return Together(tuple(encoded), library.origins)


def _encode_span(library: _Library, clip: int, span: Span) -> Chunk:
    codec, start = library.codec, int(library.starts[clip])
    rows = library.values[clip][span.first - start : span.stop - start]
    allowed = [
        relation
        for relation in span.relations
        if library.levels[relation.at.min() : relation.at.max() + 1].max() < codec.depth
    ]
    if codec.choice == coding.BEST and allowed:
        cut = _pieces(library, span, allowed)
        worth = _worth(rows, [piece for piece, _ in cut], library.plans[clip])
        relations = [relation for _, relation in cut]
        allowed = [r for r, good in zip(relations, worth, strict=True) if r is not None and good]
    chunk = _chunk(library, clip, span, allowed)
    if codec.choice == coding.BEST and allowed:
        alone = _chunk(library, clip, span, [])
        if len(alone.payload) <= len(chunk.payload) + len(chunk.needs) * _NEED_BITS // 8:
            return alone
    for relation in allowed:
        level = library.levels[relation.at.min() : relation.at.max() + 1].max() + 1
        reached = library.levels[span.first : span.stop]
        np.maximum(reached, level, out=reached)
        _note_origin(library, relation)
    return chunk


def _chunk(library: _Library, clip: int, span: Span, relations: Sequence[Relation]) -> Chunk:
    codec, start = library.codec, int(library.starts[clip])
    rows = library.values[clip][span.first - start : span.stop - start]
    pieces = [piece for piece, _ in _pieces(library, span, relations)]
    return coding.encode_chunk(
        span.first - start, rows, pieces, library.plans[clip], codec.mantissa_limit, codec.choice
    )


def _worth(rows: Values, pieces: Sequence[Piece], plan: Plan) -> list[bool]:
    """Say of each piece whether its parent saves more than naming it costs."""
    table = coding.table_of(pieces)
    bits = _core.mrpa_estimated_bits(rows, coding.beside(rows, pieces), table, plan)
    return [
        alone - with_parent > _NEED_BITS + piece.frames
        for piece, alone, with_parent in zip(pieces, bits[0::2], bits[1::2], strict=True)
    ]


def _pieces(
    library: _Library, span: Span, relations: Sequence[Relation]
) -> list[tuple[Piece, Relation | None]]:
    """Cut a chunk into pieces, with and without parents."""
    pieces: list[tuple[Piece, Relation | None]] = []
    reached = span.first
    for relation in relations:
        if relation.first > reached:
            pieces.append((Piece(relation.first - reached), None))
        first, rows = _rows(library, relation)
        pieces.append((Piece(len(relation.at), Parent(rows, relation.at - first)), relation))
        reached = relation.first + len(relation.at)
    if reached < span.stop:
        pieces.append((Piece(span.stop - reached), None))
    return pieces


def _rows(library: _Library, relation: Relation) -> tuple[int, Values]:
    """Give the frames that a relation needs, and the first of them."""
    first, last = int(relation.at.min()), int(relation.at.max())
    clip = int(np.searchsorted(library.starts, first, "right")) - 1
    start = int(library.starts[clip])
    return first, library.values[clip][first - start : last + 1 - start]


def _note_origin(library: _Library, relation: Relation) -> None:
    first, rows = _rows(library, relation)
    clip = int(np.searchsorted(library.starts, first, "right")) - 1
    origin = Origin(clip, first - int(library.starts[clip]), len(rows))
    library.origins.setdefault(digest_of(rows), origin)
