"""Gaps: runs of rows in which columns have no number (the quiet NaN without a payload), or 0.

Floats lie so close around 0 that a 0 would cost more bits than any number. Columns with the same
gaps share a mask; a chunk tells the runs of each mask. What a column holds in its gaps while it is
coded is the number before, which costs next to nothing.
"""

import struct

import numpy as np
from numpy.typing import NDArray

from mocapress.records import Writer

Values = NDArray[np.float64]
Mask = NDArray[np.bool_]

_NONE = float("nan")
_FEWEST = 4
"""Zeros that are worth a mask."""


class Masks:
    """Masks that columns share, each of a value that stands in the rows that it names."""

    def __init__(self) -> None:
        self.masks: list[Mask] = []
        self.values: list[float] = []
        self._known: dict[bytes, int] = {}

    def take(self, column: Values, value: float) -> tuple[Values, int]:
        """Take a value out of a column, (F,).

        Returns
        -------
        tuple
            The column with other numbers in its place, and the number of the mask, from 1 on; 0
            where the value is nowhere, or nothing else is there.

        """
        bits = struct.pack("<d", value)
        mask = column.view(np.uint64) == np.frombuffer(bits, np.uint64)
        if not mask.any() or mask.all():
            return column, 0
        number = self._known.setdefault(bits + mask.tobytes(), len(self.masks) + 1)
        if number > len(self.masks):
            self.masks.append(mask)
            self.values.append(value)
        return filled(column, mask), number

    def take_gaps(self, column: Values) -> tuple[Values, int]:
        """Take out what says that there is no number."""
        return self.take(column, _NONE)

    def take_zeros(self, column: Values, zero: float) -> tuple[Values, int]:
        """Take out zeros of a sign, of which a column of floats has so many that they cost much."""
        if np.count_nonzero((column == 0) & (np.signbit(column) == np.signbit(zero))) < _FEWEST:
            return column, 0
        return self.take(column, zero)


def filled(values: Values, mask: Mask) -> Values:
    """Give a column with the number before in its gaps, (F,); at the beginning the one behind."""
    places = np.where(mask, -1, np.arange(len(mask)))
    before = np.maximum.accumulate(places)
    before[before < 0] = int(np.argmin(mask))
    found: Values = values[before]
    return found


def write_runs(writer: Writer, mask: Mask) -> None:
    """Append the lengths of runs, the first of rows that are there, without the last."""
    ends = np.flatnonzero(np.diff(mask, prepend=False))
    writer.integer(len(ends))
    for length in np.diff(ends, prepend=0).tolist():
        writer.integer(length)
