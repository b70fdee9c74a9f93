"""From streams to a file of arrays (docs/format/arrays.md)."""

import math
import struct

from records import CorruptError, Record

KINDS = "dfebBhHiI"
Rows = list[list[float]]


class Layout:
    """A file of arrays without their numbers."""

    def __init__(self, data: bytes) -> None:
        record = Record(data)
        self.arrays = [
            (*divmod(record.integer(), 2), record.integer(), record.integer(), record.integer())
            for _ in range(record.integer())
        ]
        self.parts = [record.bytes() for _ in range(len(self.arrays) + 1)]
        record.end()

    def printed(self, streams: list[Rows]) -> bytes:
        """Print the file."""
        file = self.parts[0]
        for (kind, by_columns, rows, columns, stream), behind in zip(
            self.arrays, self.parts[1:], strict=True
        ):
            values = streams[stream]
            if len(values) != rows or any(len(row) != columns for row in values):
                raise CorruptError("a stream does not fit its array")
            if by_columns:
                values = [list(column) for column in zip(*values, strict=True)]
            numbers = [number for row in values for number in row]
            code = KINDS[kind]
            if kind >= KINDS.index("b"):
                numbers = [_whole(number, code) for number in numbers]
            file += struct.pack(f"<{len(numbers)}{code}", *numbers) + behind
        return file


def _whole(number: float, code: str) -> int:
    bits = 8 * struct.calcsize(code)
    low, high = (0, 2**bits - 1) if code.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return 0 if math.isnan(number) else min(max(round(number), low), high)
