"""The body of a motion file as a matrix: reading the rows of AMC and BVH."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import FormatError

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


def read_rows(data: bytes, begin: int, shape: RowShape, most_rows: int = 2**62) -> Body:
    """Read rows of one shape from a byte offset on, until one differs or the data ends."""
    values, counters, offsets, statistics, end, offset, item = _core.parse_rows(
        data, begin, shape.counter, list(shape.words), list(shape.counts), most_rows
    )
    return Body(values, counters, offsets, statistics, _ENDS[end], offset, item)


def joined(bodies: list[Body]) -> Body:
    """Put bodies that follow each other in the file, of equal columns, into one."""
    if len(bodies) == 1:
        return bodies[0]
    last = bodies[-1]
    return Body(
        np.concatenate([body.values for body in bodies]),
        np.concatenate([body.counters for body in bodies]),
        np.concatenate([*(body.offsets[:-1] for body in bodies), last.offsets[-1:]]),
        merged_statistics(np.stack([body.statistics for body in bodies])),
        last.stop,
        last.error_offset,
        last.error_item,
    )


def merged_statistics(statistics: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Merge statistics along the first axis."""
    merged: NDArray[np.uint8] = statistics.max(axis=0, initial=0)
    merged[..., 0] = statistics[..., 0].min(axis=0, initial=255)
    # A count of 0 says that no exponent was seen.
    digits = np.where(statistics[..., 3] == 0, 255, statistics[..., 3]).min(axis=0, initial=255)
    merged[..., 3] = np.where(digits == 255, 0, digits)
    return merged


def row_error(data: bytes, body: Body, file: str | None, frame: int, expected: str) -> FormatError:
    """Give the error for the place where reading stopped."""
    offset = min(body.error_offset, len(data))
    token = data[offset : offset + 40].split(maxsplit=1)
    if data[offset : offset + 1] in (b"\n", b"\r"):
        found = "the end of the line"
    elif not token:
        found = "the end of the file"
    else:
        found = repr(token[0].decode("latin-1"))
    return FormatError(
        f"frame {frame} cannot be read",
        file=file,
        line=data.count(b"\n", 0, offset) + 1,
        offset=offset,
        expected=expected,
        found=found,
    )
