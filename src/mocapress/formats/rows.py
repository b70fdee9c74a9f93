"""The body of a motion file as a matrix; rows that are asked for when they are needed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress import _core

RowsOf = Callable[[int, int, int], NDArray[np.float64]]
"""Gives rows [first, last) of a stream: by its place among the streams, first, last."""


def rows_of(streams: Sequence[NDArray[np.float64]]) -> RowsOf:
    """Give rows of streams that are held as a whole."""
    return lambda stream, first, last: streams[stream][first:last]


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
    """(C, 11) per column: how its numbers are written, see ``core/formats/body.hpp``."""
    unread: NDArray[np.int64]
    """Indices of rows whose numbers cannot be read; they hold the values of the row before."""

    @classmethod
    def of(cls, body: _core.Body) -> "Body":
        """Take over what the core read."""
        return cls(body.values(), body.counters(), body.offsets(), body.statistics(), body.unread())


def read_rows(data: bytes, begin: int, columns: int) -> Body:
    """Read rows of so many numbers, a line each, until one differs or the data ends."""
    return Body.of(_core.read_rows(data, begin, columns))
