"""The body of a motion file as a matrix: reading the rows of AMC and BVH."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.formats.problems import BYTES_AFTER_END, UNREADABLE_ROWS, Problem

# After so many rows in succession that cannot be read, what follows is no motion.
_MOST_UNREADABLE = 64
_ENDS = ("end of data", "word", "number", "line end", "limit", "frame number")


@dataclass(frozen=True, slots=True)
class RowShape:
    """What a row holds: one line per word, with so many numbers behind it (BVH: one empty word)."""

    counter: bool
    words: tuple[bytes, ...]
    counts: tuple[int, ...]

    @property
    def columns(self) -> int:
        """How many numbers there are."""
        return sum(self.counts)


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """The rows of a file, read."""

    values: NDArray[np.float64]
    """(F, C)"""
    counters: NDArray[np.int64]
    """(F,) the frame numbers of an AMC; (0,) where rows have none."""
    offsets: NDArray[np.uint64]
    """(F + 1,) byte offset of every row and of what follows the last."""
    statistics: NDArray[np.uint8]
    """(C, 8) per column: least and most decimals, most significant digits, fewest exponent digits,
    whether a trailing zero, a whole number without a point, a bare point, an ``E`` was seen."""
    stop: str
    """Why reading stopped: ``end of data``, ``limit``, or what was expected."""
    error_offset: int
    error_item: int
    unread: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    """Indices of rows whose numbers cannot be read; they hold the values of the row before."""


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """All rows of a file, and where reading them met an obstacle."""

    body: Body | None
    """None where no row can be read."""
    stops: tuple[Body, ...]
    """What stopped reading at each row of ``body.unread``."""
    end: Body | None
    """What stopped reading before the end of the data; what follows is no part of the body."""


def read_rows(data: bytes, begin: int, shape: RowShape, most_rows: int = 2**62) -> Body:
    """Read rows of one shape from a byte offset on, until one differs or the data ends."""
    values, counters, offsets, statistics, end, offset, item = _core.parse_rows(
        data, begin, shape.counter, list(shape.words), list(shape.counts), most_rows
    )
    return Body(values, counters, offsets, statistics, _ENDS[end], offset, item)


def read_all(
    data: bytes,
    begin: int,
    shape: RowShape,
    resume: Callable[[int], int],
    other: Callable[[int, Body | None], Body | None] = lambda _begin, _before: None,
) -> Reading:
    """Read rows up to the end of the data, and past rows that cannot be read.

    Parameters
    ----------
    data, begin, shape
        As for ``read_rows``.
    resume
        Gives the offset where the next row may begin, from that of a row that cannot be read.
    other
        Reads rows of another shape at an offset, after these rows; None where there are none.

    """
    bodies: list[Body] = []
    stops: list[Body] = []
    waiting: list[Body] = []
    while True:
        body = read_rows(data, begin, shape)
        if not len(body.values) and body.stop != "end of data":
            body = other(begin, bodies[-1] if bodies else None) or body
        begin = int(body.offsets[-1])
        if len(body.values):
            if waiting:
                bodies.append(_held(waiting, bodies[-1] if bodies else None, body))
                stops += waiting
                waiting = []
            bodies.append(body)
            continue
        if body.stop == "end of data" or len(waiting) == _MOST_UNREADABLE:
            break
        waiting.append(body)
        begin = resume(begin)
    end = waiting[0] if waiting else None
    whole = joined(bodies) if bodies else None
    if whole and end:
        offsets = whole.offsets.copy()
        offsets[-1] = end.offsets[-1]
        whole = replace(whole, offsets=offsets)
    return Reading(whole, tuple(stops), end)


def _held(waiting: list[Body], before: Body | None, after: Body) -> Body:
    """Give rows for those that cannot be read, with the values of the row before."""
    count, columns = len(waiting), after.values.shape[1]
    statistics = np.zeros((columns, 8), np.uint8)
    statistics[:, 0] = 255
    values = before.values[-1] if before else after.values[0]
    steps = np.arange(count if len(after.counters) else 0)
    first = before.counters[-1:] + 1 if before else after.counters[:1] - count
    return Body(
        np.tile(values, (count, 1)),
        first + steps,
        np.array([int(body.offsets[-1]) for body in waiting] + [int(after.offsets[0])], np.uint64),
        statistics,
        "",
        0,
        0,
        np.arange(count),
    )


def joined(bodies: list[Body]) -> Body:
    """Put bodies that follow each other in the file, of equal columns, into one."""
    if len(bodies) == 1:
        return bodies[0]
    last = bodies[-1]
    starts = np.cumsum([0, *(len(body.values) for body in bodies)])
    return Body(
        np.concatenate([body.values for body in bodies]),
        np.concatenate([body.counters for body in bodies]),
        np.concatenate([*(body.offsets[:-1] for body in bodies), last.offsets[-1:]]),
        merged_statistics(np.stack([body.statistics for body in bodies])),
        last.stop,
        last.error_offset,
        last.error_item,
        np.concatenate(
            [body.unread + start for body, start in zip(bodies, starts[:-1], strict=True)]
        ),
    )


def merged_statistics(statistics: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Merge statistics along the first axis."""
    merged: NDArray[np.uint8] = statistics.max(axis=0, initial=0)
    merged[..., 0] = statistics[..., 0].min(axis=0, initial=255)
    # A count of 0 says that no exponent was seen.
    digits = np.where(statistics[..., 3] == 0, 255, statistics[..., 3]).min(axis=0, initial=255)
    merged[..., 3] = np.where(digits == 255, 0, digits)
    return merged


def after_rows(data: bytes, body: Body) -> bytes:
    """Give what follows the last row, without blanks around it."""
    return data[int(body.offsets[-1]) :].strip()


def is_padding(rest: bytes) -> bool:
    """Whether this is what programs leave behind the text: NULs, or the Ctrl-Z of DOS."""
    return not rest.strip(b"\0\x1a \t\r\n")


def unreadable(
    data: bytes, reading: Reading, expected: Callable[[Body], str], *, cut: bool
) -> Problem:
    """Give the problem of rows that cannot be read; ``cut``: the one where reading ended, too."""
    frames = len(reading.body.values) if reading.body else 0
    unread = reading.body.unread.tolist() if reading.body else []
    if cut and reading.end:
        unread.append(frames)
    stop = (*reading.stops, reading.end)[0]
    if stop is None:
        raise ValueError("all rows can be read")
    what = f"frame {unread[0] + 1} cannot be read"
    if len(unread) > 1:
        what = f"{len(unread)} frames cannot be read, the first of them frame {unread[0] + 1}"
    offset = min(stop.error_offset, len(data))
    token = data[offset : offset + 40].split(maxsplit=1)
    if data[offset : offset + 1] in (b"\n", b"\r"):
        found = "the end of the line"
    elif not token:
        found = "the end of the file"
    else:
        found = repr(token[0].decode("latin-1"))
    return Problem.of(UNREADABLE_ROWS, what, line_of(data, offset), offset, expected(stop), found)


def bytes_after_end(data: bytes, body: Body) -> Problem:
    """Give the problem of something behind the last row."""
    rest = after_rows(data, body) or data[int(body.offsets[-1]) :]
    offset = data.index(rest, int(body.offsets[-1]))
    found = f"{len(rest)} bytes that begin with {rest[:16].decode('latin-1')!r}"
    what, expected = "bytes after the last frame", "the end of the file"
    return Problem.of(BYTES_AFTER_END, what, line_of(data, offset), offset, expected, found)


def line_of(data: bytes, offset: int) -> int:
    """Give the number of the line in which a byte stands, counted from 1."""
    return data.count(b"\n", 0, offset) + 1
