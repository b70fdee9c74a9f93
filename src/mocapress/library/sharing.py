"""Frames that the library has already: found by anchors, checked by their numbers."""

import sqlite3
import threading
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import MocapressError
from mocapress.library.database import Database
from mocapress.library.opened import OpenedClip
from mocapress.library.rows import Run
from mocapress.models import Place

WINDOW = 128
"""Of so many successive frames the one of the smallest hash is an anchor."""
_LEAST_FRAMES = 32
"""A shorter run costs about as much as its frames."""
_LEAST_DIFFERENT = 16
"""A run of fewer different frames is a still, which costs next to nothing as it is."""
_MOST_OWNERS = 16
"""An anchor of more clips is a pose that many take, such as that of calibration."""
_MOST_CANDIDATES = 4
_MOST_SHIFTS = 64
"""Of one clip: a take from which so many pieces were cut is still found in it, piece by piece."""
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_HALF = np.uint64(32)

Values = NDArray[np.float64]
Hashes = NDArray[np.uint32]


def row_hashes(values: Values) -> Hashes:
    """Give the hash of each frame, (F,); frames of equal bits have equal hashes."""
    bits = np.ascontiguousarray(values, "<f8").view(np.uint64)
    weights = _mixed(_mixed(np.arange(1, bits.shape[1] + 1, dtype=np.uint64))) | np.uint64(1)
    return (_mixed(bits @ weights) >> _HALF).astype(np.uint32)


def _mixed(numbers: NDArray[np.uint64]) -> NDArray[np.uint64]:
    mixed: NDArray[np.uint64] = (numbers ^ (numbers >> _HALF)) * _GOLDEN
    return mixed


def anchors(values: Values) -> Hashes:
    """Give the anchors of frames, sorted: docs/format/library.md, "anchors"."""
    smallest = row_hashes(values)
    reach = 1
    while reach < WINDOW and len(smallest) > 1:
        step = min(reach, WINDOW - reach, len(smallest) - 1)
        smallest = np.minimum(smallest[:-step], smallest[step:])
        reach += step
    return np.unique(smallest)


class Known:
    """What is in a library, by the hashes of its files and by its anchors."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._last = 0
        self._files: dict[bytes, int] = {}
        self._hashes: Hashes = np.empty(0, np.uint32)
        self._owners: NDArray[np.int64] = np.empty(0, np.int64)
        self._recent: list[tuple[int, Hashes]] = []

    def refresh(self, connection: sqlite3.Connection) -> int:
        """Take in what was added since the last time; give the id of the newest clip."""
        with self._lock:
            return self._refresh(connection)

    def _refresh(self, connection: sqlite3.Connection) -> int:
        for clip, sha256 in connection.execute(
            "SELECT id, sha256 FROM clips WHERE id > ? ORDER BY id", [self._last]
        ).fetchall():
            if sha256 is not None:
                self._files[sha256] = clip
        newest = connection.execute(
            "SELECT coalesce(max(id), ?) FROM clips", [self._last]
        ).fetchone()[0]
        self._recent += [
            (clip, np.frombuffer(hashes[: len(hashes) // 4 * 4], "<u4"))
            for clip, hashes in connection.execute(
                "SELECT clip, hashes FROM anchors WHERE clip > ?", [self._last]
            )
        ]
        self._last = max(self._last, newest)
        if len(self._recent) > 64:
            self._sort()
        return self._last

    def learn(self, clip: int, hashes: Hashes) -> None:
        """Take in anchors of a clip that has changed."""
        with self._lock:
            self._recent.append((clip, hashes))

    def _all_recent(self) -> tuple[Hashes, NDArray[np.int64]]:
        """Give the anchors that are not sorted in yet, and whose they are."""
        sizes = [len(hashes) for _, hashes in self._recent]
        owners = np.repeat(np.array([clip for clip, _ in self._recent], np.int64), sizes)
        return np.concatenate([*(hashes for _, hashes in self._recent), self._hashes[:0]]), owners

    def _sort(self) -> None:
        recent, owners = self._all_recent()
        hashes = np.concatenate([self._hashes, recent])
        order = np.argsort(hashes, kind="stable")
        self._hashes, self._owners = hashes[order], np.concatenate([self._owners, owners])[order]
        self._recent = []

    def candidates(
        self,
        connection: sqlite3.Connection,
        sha256: bytes | None,
        hashes: Hashes,
        after: int = 0,
    ) -> list[int]:
        """Give ids of clips above ``after`` that may share frames, the most promising first."""
        with self._lock:
            shared = self._shared(hashes)
            equal = self._files.get(sha256 or b"")
        ranked = [clip for clip, _ in shared.most_common()]
        first_of_all = [] if equal is None else [equal, *_sources(connection, equal)]
        found = dict.fromkeys([*first_of_all, *ranked[:_MOST_CANDIDATES]])
        return [clip for clip in found if clip > after]

    def _shared(self, hashes: Hashes) -> Counter[int]:
        """Count the anchors that each clip shares."""
        begin = np.searchsorted(self._hashes, hashes, "left")
        end = np.searchsorted(self._hashes, hashes, "right")
        owners = [
            self._owners[first:last].tolist()
            for first, last in zip(begin.tolist(), end.tolist(), strict=True)
        ]
        recent, recent_owners = self._all_recent()
        places = np.minimum(np.searchsorted(hashes, recent), max(len(hashes) - 1, 0))
        if len(hashes):
            for i in np.flatnonzero(hashes[places] == recent):
                owners[places[i]].append(int(recent_owners[i]))
        shared: Counter[int] = Counter()
        for of_one in map(set, owners):
            if len(of_one) <= _MOST_OWNERS:
                shared.update(of_one)
        return shared


def _sources(connection: sqlite3.Connection, clip: int) -> list[int]:
    rows = connection.execute("SELECT DISTINCT source FROM runs WHERE clip = ?", [clip])
    return [int(source) for (source,) in rows]


def find_runs(
    db: Database,
    stream: int,
    values: Values,
    candidates: Sequence[int],
    models: Sequence[Place] = (),
) -> list[Run]:
    """Find the frames that a stream of clips of a library has in chunks of their own.

    Parameters
    ----------
    db, stream
        The library, and the index of the stream.
    values
        (F, C) of that stream.
    candidates
        Ids of clips to look at.
    models
        Where models may be that the library lacks.

    Returns
    -------
    list
        Runs in the order of their frames; none overlap.

    """
    free = np.ones(len(values), np.bool_)
    hashes = row_hashes(values)
    runs: list[Run] = []
    for clip in candidates:
        if not free.any():
            break
        try:
            opened = OpenedClip(db, clip, models)
            if not _fits(opened, stream, values):
                continue
            rows = opened.own_rows(stream).values
        except (MocapressError, OSError, sqlite3.Error):
            continue  # it is damaged, or gone: nothing is shared with it
        others = row_hashes(rows)
        for shift in _shifts(hashes, others):
            runs += [
                Run(stream, first, last - first, clip, first + shift)
                for first, last in _equal(values, hashes, rows, others, shift, free)
            ]
    return sorted(runs)


def _fits(opened: OpenedClip, stream: int, values: Values) -> bool:
    """Say whether a clip has a stream of as many columns that no codec has changed."""
    return (
        stream < len(opened.streams)
        and len(opened.streams[stream].columns) == values.shape[1]
        and opened.codec(stream).lossless
    )


def _shifts(hashes: Hashes, others: Hashes) -> list[int]:
    """Give by how much frames of another clip stand later there, the most frequent first."""
    if not len(others):
        return []
    order = np.argsort(others, kind="stable")
    places = np.searchsorted(others[order], hashes)
    places[places == len(others)] = 0
    hit = others[order][places] == hashes
    found = order[places[hit]] - np.flatnonzero(hit)
    shifts, counts = np.unique(found, return_counts=True)
    best = np.argsort(-counts, kind="stable")[:_MOST_SHIFTS]
    frequent = [int(shifts[i]) for i in best if counts[i] >= _LEAST_DIFFERENT]
    return [*dict.fromkeys([*frequent, 0])]


def _equal(
    values: Values,
    hashes: Hashes,
    rows: Values,
    others: Hashes,
    shift: int,
    free: NDArray[np.bool_],
) -> list[tuple[int, int]]:
    """Give the runs of frames i that are the rows i + shift; they are then no longer free."""
    first, last = max(0, -shift), min(len(values), len(rows) - shift)
    if first >= last:
        return []
    equal = (hashes[first:last] == others[first + shift : last + shift]) & free[first:last]
    alike = np.flatnonzero(equal) + first
    mine, theirs = (
        np.ascontiguousarray(part).view(np.int64) for part in (values[alike], rows[alike + shift])
    )
    equal[alike - first] = (mine == theirs).all(axis=1)
    edges = np.flatnonzero(np.diff(equal, prepend=False, append=False)) + first
    runs = []
    for begin, end in zip(edges[0::2].tolist(), edges[1::2].tolist(), strict=True):
        whole = end - begin == len(values)
        different = len(np.unique(hashes[begin:end]))
        if whole or (end - begin >= _LEAST_FRAMES and different >= _LEAST_DIFFERENT):
            free[begin:end] = False
            runs.append((begin, end))
    return runs
