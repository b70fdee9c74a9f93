"""What of a stream's columns is told beside the numbers that are coded: their gaps and tables."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.exact.gaps import Mask, Masks, write_runs
from mocapress.codecs.exact.tables import Table, Tables, coded, has_floats, write_tables
from mocapress.codecs.palette import write_palette
from mocapress.records import Writer

Values = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Told:
    """The masks and tables of columns."""

    values: Sequence[float] = ()
    """What stands in the rows that a mask names, per mask."""
    masks_of: Sequence[tuple[int, int]] = ()
    """Per column the numbers of up to two masks, from 1 on, or 0; nothing without masks."""
    tables: Sequence[Table] = field(default=())
    table_of: Sequence[int] = ()
    """Per column the number of its table, likewise."""

    @classmethod
    def find(cls, values: Values) -> tuple[Self, Values, list[Mask]]:
        """Find them; give the numbers to code, (F, C), and the masks, too."""
        masks, tables = Masks(), Tables()
        numbers = np.array(values.T, order="C")
        masks_of, table_of = [(0, 0)] * len(numbers), [0] * len(numbers)
        for column in np.flatnonzero(has_floats(numbers) | np.isnan(numbers).any(axis=1)).tolist():
            left, gap = masks.take_gaps(numbers[column])
            floats = has_floats(left)
            left, zero = masks.take_zeros(left, -0.0) if floats else (left, 0)
            table = tables.find(left) if floats else 0
            if floats and not table and not zero and not (np.rint(left) == left).all():
                left, zero = masks.take_zeros(left, 0.0)
                table = tables.find(left) if zero else 0
            numbers[column] = coded(tables.made[table - 1], left) if table else left
            masks_of[column] = gap, zero
            table_of[column] = table
        used = masks_of if masks.masks else []
        told = cls(masks.values, used, tables.made, table_of if tables.made else [])
        return told, np.ascontiguousarray(numbers.T), masks.masks

    def write(self, writer: Writer) -> None:
        """Append them to a header: nothing where there are none."""
        if not self.values and not self.tables:
            return
        writer.integer(len(self.values))
        for value in self.values:
            writer.double(value)
        if self.values:
            for place in (0, 1):
                write_palette(writer, [masks[place] for masks in self.masks_of])
        writer.integer(len(self.tables))
        if self.tables:
            write_tables(writer, self.tables)
            write_palette(writer, self.table_of)

    def pack(self, payload: bytes, masks: Sequence[Mask]) -> bytes:
        """Give a chunk's payload with the runs of its masks before it."""
        if not self.values:
            return payload
        writer = Writer()
        for mask in masks:
            write_runs(writer, mask)
        return bytes(writer.data) + payload
