"""A file of arrays without their numbers: docs/format/arrays.md."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError
from mocapress.formats.contract import StoredLayout
from mocapress.formats.rows import RowsOf
from mocapress.records import Reader, Writer

Values = NDArray[np.float64]

KINDS = ("<f8", "<f4", "<f2", "|i1", "|u1", "<i2", "<u2", "<i4", "<u4")
"""Numbers that float64 holds, as NumPy names them; stored by their place here."""
_MOST_ARRAYS = 2**8
_MOST_NUMBERS = 2**40
_BLOCK_NUMBERS = 2**17


class Array(NamedTuple):
    """An array of the file."""

    kind: int
    """Of its numbers, in ``KINDS``."""
    by_columns: bool
    """Whether all numbers of a column stand together, not those of a row."""
    rows: int
    columns: int
    stream: int
    """The place of its stream."""

    @property
    def size(self) -> int:
        """Give its bytes."""
        return self.rows * self.columns * np.dtype(KINDS[self.kind]).itemsize

    def values(self, data: bytes) -> Values:
        """Give the numbers of its bytes, (rows, columns)."""
        numbers = np.frombuffer(data, KINDS[self.kind])
        shaped = numbers.reshape((self.rows, self.columns), order="F" if self.by_columns else "C")
        with np.errstate(invalid="ignore"):
            return shaped.astype(np.float64, order="C")

    def blocks(self) -> Iterator[tuple[int, int]]:
        """Give runs of rows to print at a time: the first, and one behind the last."""
        step = self.rows if self.by_columns else max(_BLOCK_NUMBERS // self.columns, 1)
        return ((first, min(first + step, self.rows)) for first in range(0, self.rows, step))

    def printed(self, values: Values) -> bytes:
        """Give the bytes of some rows, of all where they stand by columns."""
        kind = np.dtype(KINDS[self.kind])
        with np.errstate(invalid="ignore", over="ignore"):
            if kind.kind != "f":  # what a lossy codec or damage made of whole numbers
                limits = np.iinfo(kind)
                values = np.clip(np.nan_to_num(np.rint(values)), limits.min, limits.max)
            return values.astype(kind).tobytes("F" if self.by_columns else "C")


@dataclass(frozen=True, slots=True, eq=False)
class ArrayLayout(StoredLayout):
    """A file of arrays without their numbers."""

    format: str
    arrays: tuple[Array, ...]
    """In the order of the file."""
    between: tuple[bytes, ...]
    """What stands before the first array, between arrays, and behind the last."""

    @property
    def sizes(self) -> list[tuple[int, int]]:
        """Give frames and columns of each stream."""
        in_order = sorted(self.arrays, key=lambda array: array.stream)
        return [(array.rows, array.columns) for array in in_order]

    def pieces(self, rows: RowsOf, most_bytes: int = 2**62) -> Iterator[bytes]:
        """Print the file; see ``StoredLayout``."""
        size = sum(array.size for array in self.arrays) + sum(map(len, self.between))
        if size > most_bytes:
            raise CorruptError("the layout makes a longer file than announced")
        yield self.between[0]
        for array, behind in zip(self.arrays, self.between[1:], strict=True):
            for first, last in array.blocks():
                yield array.printed(rows(array.stream, first, last))
            yield behind

    def record(self) -> bytes:
        """Give the layout as it is stored."""
        writer = Writer()
        writer.integer(len(self.arrays))
        for array in self.arrays:
            writer.integer(2 * array.kind + array.by_columns)
            for number in array[2:]:
                writer.integer(number)
        for part in self.between:
            writer.bytes(part)
        return bytes(writer.data)


def read_layout(data: bytes, kind: str) -> ArrayLayout:
    """Read what ``ArrayLayout.record`` gave, of a format.

    Raises
    ------
    CorruptError
        When it is not such a record.

    """
    reader = Reader(data, "layout of arrays")
    count = reader.integer(_MOST_ARRAYS)
    arrays = []
    for _ in range(count):
        told = reader.integer(2 * len(KINDS) - 1)
        rows, columns, stream = (
            reader.integer(most) for most in (_MOST_NUMBERS, _MOST_NUMBERS, count - 1)
        )
        if not rows or not columns:
            raise reader.fail("an array without numbers")
        arrays.append(Array(told // 2, bool(told % 2), rows, columns, stream))
    if sorted(array.stream for array in arrays) != [*range(count)] or not arrays:
        raise reader.fail("not one stream for each array")
    between = tuple(reader.bytes() for _ in range(count + 1))
    reader.end()
    return ArrayLayout(kind, tuple(arrays), between)
