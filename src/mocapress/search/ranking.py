"""Which clips, or which stretches of them, are most like a query."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.search.features import EVERY, Features, read_record
from mocapress.search.index import Entry
from mocapress.search.signatures import BYTES, projected
from mocapress.search.standard import RATE

Array = NDArray[np.float64]

CLOSELY = 100
"""Clips that are compared closely, or five times as many as are wanted."""
_FIRST, _THEIRS = 3, 1.5
"""The best clips, whose own neighbours count, too, and the weight of these."""
_MOST_THEIRS = 3.0
"""How many times a clip's own score they count at most, so that a copy of the query has score 0."""
_AROUND = 30
"""The nearest other candidates, whose mean distance says how crowded it is around a clip."""
_CROWDED = 0.35
"""Power of that distance by which scores are divided."""
_FEW, _LEAST_SPREAD = 5, 0.7
"""Fewer do not say it; and the least part of the median of these distances that counts."""
_SIGNED, _ALIGNED = 55.0, 1.9
"""Distances of signatures and of alignments that count 1: the former is how they spread over the
candidates for a query, the latter ten times that. So scores of different queries can be compared.
"""
_FRAMES = 256
"""Frames of clips that are aligned; longer ones are thinned."""
_ABANDON, _ENOUGH = 3.0, 5
"""Alignments are given up, and count as so bad, when so many times as bad as the fifth best."""
_EXAMPLES = 15
"""The best stretches, by which others are judged as well."""
_CLEAR = 0.73
"""Part of the usual cost, the median over all frames, below which a stretch is an example."""
_OWN = 0.3
"""Weight of the query itself beside the mean of examples."""
_MOST_TIMES = 4.0
"""How many times the cost of aligning a stretch with the query its score is at most, so that the
score of a copy is near 0."""
_SIGNED_STRETCH = 1100.0
"""Distance of signatures that counts as much as a cost of 1."""
_NONE = np.empty(0, np.float32)
_OVERLAP = 0.5
"""Share of the shorter of two stretches by which they may overlap."""


class Hit(NamedTuple):
    """Something found."""

    place: int
    """Which of the clips that were given."""
    score: float
    """The smaller, the more alike."""
    start: float = 0.0
    """Seconds from the clip's first frame."""
    end: float = 0.0
    """Seconds to the end of the last frame; the clip's in a search for clips."""


def rank(
    query: Entry,
    signatures: Sequence[bytes],
    features: Callable[[int], bytes],
    top: int = 20,
    *,
    mirrored: Entry | None = None,
    closely: int | None = None,
) -> list[Hit]:
    """Find the clips that are most like a query.

    The nearest by signature are compared again: each is scored by its signature's distance from the
    query and, on the average, from the three best clips, and by how well it aligns with the query.
    Distances count less where clips are far from each other. A copy of the query has score 0.

    Parameters
    ----------
    query
        What is sought.
    signatures
        Of all clips, 64 bytes each.
    features
        Gives the record of a clip by its place; asked for candidates only.
    top
        How many are wanted at most.
    mirrored
        The query's mirror image, if clips may be like the one or the other.
    closely
        How many are compared again; 100 by default, or five times as many as are wanted.

    Raises
    ------
    CorruptError
        When a record is damaged.

    """
    if not signatures or top < 1:
        return []
    queries = [query] if mirrored is None else [query, mirrored]
    kept = np.frombuffer(b"".join(signatures), np.int8).reshape(len(signatures), BYTES)
    near = np.min(
        [_core.scan_signatures(np.frombuffer(one.signature, np.int8), kept) for one in queries],
        axis=0,
    )
    most = min(closely or max(CLOSELY, 5 * top), len(kept))
    chosen = np.argsort(near, kind="stable")[:most]
    records = [read_record(features(int(place))) for place in chosen]
    aligned = np.min([_alignments(read_record(one.features), records) for one in queries], axis=0)
    candidates = np.ascontiguousarray(kept[chosen])
    apart = np.sqrt([_core.scan_signatures(one, candidates) for one in candidates]) / _SIGNED
    crowded = _spread(apart) ** _CROWDED
    own = (np.sqrt(near[chosen]) / _SIGNED + aligned / _ALIGNED) / crowded
    best = np.argsort(own, kind="stable")[:_FIRST]
    theirs = apart[best].mean(axis=0) / crowded
    scores = own + np.minimum(_THEIRS * theirs, _MOST_THEIRS * own)
    order = np.argsort(scores, kind="stable")[:top]
    return [
        Hit(int(chosen[i]), float(scores[i]), 0.0, len(records[i]) * EVERY / RATE) for i in order
    ]


def find(query: Entry, features: Iterable[tuple[int, bytes]], top: int = 20) -> list[Hit]:
    """Find the stretches of clips that are most like a query.

    All clips are aligned with the query, and with those of the best hits that are far better than
    what else there is. The best stretches are compared by signatures, too. A stretch may be half to
    twice as long as the query. Those of one clip overlap by half at most.

    Parameters
    ----------
    query
        What is sought.
    features
        Places of clips, and their records.
    top
        How many stretches are wanted at most.

    Raises
    ------
    CorruptError
        When a record is damaged.

    """
    wanted = read_record(query.features)
    records = [*features]
    matches = [_core.find_stretches(wanted, read_record(data), damped=True) for _, data in records]
    costs = [own for own, _ in matches]
    known = np.concatenate([own[np.isfinite(own)] for own in [*costs, _NONE]])
    if not len(known):
        return []
    clear = _CLEAR * float(np.median(known))
    first = [hit for hit in _stretches(matches, _EXAMPLES) if hit.cost <= clear]
    if first:
        examples = [
            _as_long(read_record(records[hit.record][1]), hit, len(wanted)) for hit in first
        ]
        for number, (_, data) in enumerate(records):
            motion = read_record(data)
            others = [_core.find_stretches(one, motion, damped=True)[0] for one in examples]
            costs[number] = _OWN * costs[number] + (1 - _OWN) * np.mean(others, axis=0)
    again = [(own, starts) for own, (_, starts) in zip(costs, matches, strict=True)]
    hits = _stretches(again, max(CLOSELY, top))
    own = np.array([matches[hit.record][0][hit.last] for hit in hits])
    judged = _scores(wanted, records, hits)
    scores = np.minimum(judged, _MOST_TIMES * own)
    order = np.argsort(scores, kind="stable")[:top]
    seconds = EVERY / RATE
    return [
        Hit(
            records[hits[i].record][0],
            float(scores[i]),
            hits[i].first * seconds,
            (hits[i].last + 1) * seconds,
        )
        for i in order
    ]


def likeness(query: Entry, other: Entry) -> float:
    """Give the mean distance of a query's frames from the stretch of another that is most alike.

    Infinite where the other is less than half as long.
    """
    costs, _ = _core.find_stretches(read_record(query.features), read_record(other.features))
    return float(costs.min(initial=np.inf))


class _Stretch(NamedTuple):
    """A stretch of a record."""

    cost: float
    record: int
    first: int
    last: int


def _stretches(matches: Sequence[tuple[Features, NDArray[np.int32]]], top: int) -> list[_Stretch]:
    """Give the best stretches of all records, the best first."""
    found = [
        _Stretch(float(costs[last]), record, first, last)
        for record, (costs, starts) in enumerate(matches)
        for first, last in _apart(costs, starts, top)
    ]
    return sorted(found)[:top]


def _as_long(motion: Features, hit: _Stretch, frames: int) -> Features:
    """Give a stretch with so many frames."""
    places = np.rint(np.linspace(hit.first, hit.last, frames)).astype(np.intp)
    return np.ascontiguousarray(motion[places])


def _scores(wanted: Features, records: Sequence[tuple[int, bytes]], hits: list[_Stretch]) -> Array:
    """Score stretches by cost, by their signatures' distance from the query's and from the best's.

    The signatures are those of 15 frames a second, which no library keeps.
    """
    if not hits:
        return np.zeros(0)
    read: dict[int, Features] = {}
    made = np.empty((len(hits), BYTES))
    for number, hit in enumerate(hits):
        if hit.record not in read:
            read[hit.record] = read_record(records[hit.record][1])
        made[number] = projected(read[hit.record][hit.first : hit.last + 1].astype(np.float64))
    own = np.linalg.norm(made - projected(wanted.astype(np.float64)), axis=1)
    apart = np.array([np.linalg.norm(made - one, axis=1) for one in made])
    crowded = _spread(apart / _SIGNED) ** _CROWDED
    scores = (np.array([hit.cost for hit in hits]) + own / _SIGNED_STRETCH) / crowded
    best = np.argsort(scores, kind="stable")[:_EXAMPLES]
    added: Array = scores + apart[best].mean(axis=0) / _SIGNED_STRETCH / crowded
    return added


def _apart(costs: Features, starts: NDArray[np.int32], top: int) -> list[tuple[int, int]]:
    """Give the best stretches that hardly overlap, as first and last frames, the best first."""
    found: list[tuple[int, int]] = []
    left = np.where(np.isfinite(costs), costs, np.inf)
    ends = np.arange(len(costs))
    lengths = ends - starts + 1
    while len(found) < top and len(left):
        end = int(left.argmin())
        if not np.isfinite(left[end]):
            break
        first = int(starts[end])
        found.append((first, end))
        common = np.minimum(ends, end) - np.maximum(starts, first) + 1
        left[common > _OVERLAP * np.minimum(lengths, end - first + 1)] = np.inf
        left[end] = np.inf
    return found


def _spread(apart: Array) -> Array:
    """Give for each clip how far the nearest others are on average, of distances (N, N).

    No less than a part of the median, so that copies of a clip hardly harm each other.
    """
    most = min(_AROUND, len(apart) // 3)
    if most < _FEW:
        return np.ones(len(apart))
    spread: Array = np.sort(apart, axis=1)[:, 1 : most + 1].mean(axis=1)
    return np.maximum(spread, max(_LEAST_SPREAD * float(np.median(spread)), 1 / _SIGNED))


def _alignments(wanted: Features, others: Sequence[Features]) -> Array:
    query = _thinned(wanted)
    costs: list[float] = []
    limit = np.inf
    for other in others:
        costs.append(min(_core.warp(query, _thinned(other), limit), limit))
        if len(costs) >= _ENOUGH:
            limit = _ABANDON * sorted(costs)[_ENOUGH - 1]
    return np.array(costs)


def _thinned(features: Features) -> Features:
    step = -(-len(features) // _FRAMES)
    return np.ascontiguousarray(features[:: max(step, 1)])
