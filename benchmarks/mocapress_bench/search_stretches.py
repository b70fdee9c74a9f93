"""Search for stretches of long takes: cuts joined into takes, and takes labelled frame by frame."""

import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress_bench.search_alignment import separate, stretches
from mocapress_bench.search_data import EVERY, Take, take_of
from mocapress_bench.search_measures import average_precision, by_class
from mocapress_bench.search_rivals import between_clouds, clouds

Array = NDArray[np.float64]

_STEP = 2 * EVERY
"""Rivals align 15 frames a second."""
_LABEL_FRAMES = 12
"""Frames that one label of a take covers: 0.1 s."""
_MOST = 200
_ALIKE = 0.5


@dataclass(frozen=True, slots=True)
class Mark:
    """A labelled stretch of a take."""

    first: int
    last: int
    """Behind the last frame."""
    label: str
    cut: int
    """Number of the query that this is."""


@dataclass(frozen=True, slots=True, eq=False)
class Long:
    """A long take and its marks."""

    take: Take
    marks: tuple[Mark, ...]


@dataclass(frozen=True, slots=True)
class Hit:
    """A stretch that was found."""

    cost: float
    take: int
    first: int
    last: int


Finder = Callable[[Take, int], list[Hit]]
"""Gives so many stretches that are like a query, the best first."""


def joined(takes: Sequence[Take], seed: int) -> list[Long]:
    """Join the cuts of each actor in a random order. Queries are the cuts, in their order."""
    random = np.random.default_rng(seed)
    longs = []
    for actor in sorted({take.actor for take in takes}):
        order = random.permutation([i for i, take in enumerate(takes) if take.actor == actor])
        parts = [takes[i] for i in order]
        ends = np.cumsum([part.clip.frames for part in parts])
        values = np.concatenate([part.clip.values for part in parts])
        clip = parts[0].clip.with_frames(values, parts[0].clip.frame_time)
        marks = tuple(
            Mark(int(end - part.clip.frames), int(end), part.label, int(i))
            for end, part, i in zip(ends, parts, order, strict=True)
        )
        longs.append(Long(take_of(Path(f"{actor}.amc"), clip, "", actor), marks))
    return longs


def labelled(folder: Path, skeleton: Path) -> tuple[list[Take], list[Long]]:
    """Read takes with a label every 0.1 s beside them; each run of a label is a query."""
    queries: list[Take] = []
    longs = []
    for path in sorted(folder.glob("*.amc")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mp.MotionWarning)
            clip = mp.read(path, asf_path=skeleton)
        marks = []
        at = 0
        for label, run in groupby(path.with_suffix(".txt").read_text().split()):
            last = min(at + _LABEL_FRAMES * len(list(run)), clip.frames)
            if last - at >= 2 * _STEP:
                marks.append(Mark(at, last, label, len(queries)))
                part = clip.with_frames(clip.values[at:last], clip.frame_time)
                queries.append(take_of(path, part, label, path.stem))
            at = last
        longs.append(Long(take_of(path, clip, "", path.stem), tuple(marks)))
    return queries, longs


def match_webs(longs: Sequence[Long]) -> Finder:
    """Find stretches as ``search_rivals.match_webs`` compares clips."""
    rows = [clouds(long.take) for long in longs]

    def find(query: Take, most: int) -> list[Hit]:
        own = clouds(query)
        hits = []
        for number, row in enumerate(rows):
            ends, begins = stretches(between_clouds(own, row))
            frames = longs[number].take.clip.frames
            hits += [
                Hit(cost, number, _STEP * first, min(_STEP * last, frames))
                for cost, first, last in separate(ends, begins, most)
            ]
        return sorted(hits, key=lambda hit: hit.cost)[:most]

    return find


def measure(
    finder: Callable[[Sequence[Long]], Finder],
    queries: Sequence[Take],
    orders: Sequence[Sequence[Long]],
) -> dict[str, Any]:
    """Give ``measure_cuts`` on average over several orders of the cuts, and the time it takes."""
    start = time.process_time()
    rows = [measure_cuts(finder(longs), queries, longs) for longs in orders]
    spent = time.process_time() - start
    known = [row["IoU"] for row in rows if row["IoU"] is not None]
    return {
        "recall at R": float(np.mean([row["recall at R"] for row in rows])),
        "IoU": float(np.mean(known)) if known else None,
        "ms a query in takes": 1000 * spent / (len(queries) * len(orders)),
    }


def measure_cuts(find: Finder, queries: Sequence[Take], longs: Sequence[Long]) -> dict[str, Any]:
    """Search for each cut in the joined takes: recall at R, the number of relevant stretches.

    A relevant one counts as found where a hit shares half of their union with it. The stretch that
    the query itself was cut from does not count, nor does a hit there. IoU is the mean over
    those found.
    """
    recalls: list[float] = []
    overlaps: list[float] = []
    for number, query in enumerate(queries):
        relevant = {
            (t, mark)
            for t, long in enumerate(longs)
            for mark in long.marks
            if mark.label == query.label and mark.cut != number
        }
        found: dict[tuple[int, Mark], float] = {}
        place = 0
        for hit in find(query, _MOST):
            shared = [(iou(hit, mark), (hit.take, mark)) for mark in longs[hit.take].marks]
            best, (_, mark) = max(shared, key=lambda pair: pair[0])
            if mark.cut == number and best > 0:
                continue
            place += 1
            if place > len(relevant):
                break
            if best >= _ALIKE and (hit.take, mark) in relevant:
                found[hit.take, mark] = max(best, found.get((hit.take, mark), 0))
        recalls.append(len(found) / len(relevant) if relevant else np.nan)
        overlaps += found.values()
    labels = np.array([query.label for query in queries])
    return {
        "recall at R": by_class(recalls, labels),
        "IoU": float(np.mean(overlaps)) if overlaps else None,
    }


def measure_labels(find: Finder, queries: Sequence[Take], longs: Sequence[Long]) -> dict[str, Any]:
    """Search for each labelled run: frame average precision, and how often the first hit is right.

    A frame's score is that of the best hit on it. Frames of the run itself do not count.
    """
    precisions, right = [], []
    for number, query in enumerate(queries):
        scores = [np.full(long.take.clip.frames, -np.inf) for long in longs]
        labels = [np.full(long.take.clip.frames, "", dtype="U8") for long in longs]
        counts = [np.ones(long.take.clip.frames, dtype=bool) for long in longs]
        for t, long in enumerate(longs):
            for mark in long.marks:
                labels[t][mark.first : mark.last] = mark.label
                if mark.cut == number:
                    counts[t][mark.first : mark.last] = False
        first = None
        for hit in find(query, _MOST):
            part = slice(hit.first, hit.last)
            scores[hit.take][part] = np.maximum(scores[hit.take][part], -hit.cost)
            if first is None and counts[hit.take][part].mean() > _ALIKE:
                first = (labels[hit.take][part] == query.label).mean() > _ALIKE
        counted = np.concatenate(counts)[::_LABEL_FRAMES]
        wanted = (np.concatenate(labels)[::_LABEL_FRAMES] == query.label)[counted]
        order = np.argsort(-np.concatenate(scores)[::_LABEL_FRAMES][counted], kind="stable")
        if wanted.any():
            precisions.append(average_precision(wanted[order].astype(float)))
            right.append(float(bool(first)))
        else:
            precisions.append(np.nan)
            right.append(np.nan)
    names = np.array([query.label for query in queries])
    return {"frame AP": by_class(precisions, names), "first right": by_class(right, names)}


def iou(hit: Hit, mark: Mark) -> float:
    """Give the shared part of the union of two stretches of one take."""
    shared = min(hit.last, mark.last) - max(hit.first, mark.first)
    union = max(hit.last, mark.last) - min(hit.first, mark.first)
    return max(shared, 0) / union
