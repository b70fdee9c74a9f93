"""From streams to a file of arrays (docs/format/arrays.md)."""

import math
import struct
import zlib

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


def with_right_digests(archive: bytes) -> bytes:
    """Give a zip archive the CRC-32 of each file in it that is stored as it is."""
    changed = bytearray(archive)
    (entry,) = struct.unpack_from("<I", archive, archive.rindex(b"PK\5\6") + 16)
    while archive.startswith(b"PK\1\2", entry):
        flags, kind = struct.unpack_from("<HH", archive, entry + 8)
        size, _, *lengths = struct.unpack_from("<IIHHH", archive, entry + 20)
        (header,) = struct.unpack_from("<I", archive, entry + 42)
        begin = header + 30 + sum(struct.unpack_from("<HH", archive, header + 26))
        own = header + 14
        if flags & 8:  # pragma: no cover
            own = begin + size + (4 if archive.startswith(b"PK\7\x08", begin + size) else 0)
        if kind == 0:  # pragma: no branch
            digest = struct.pack("<I", zlib.crc32(archive[begin : begin + size]))
            changed[own : own + 4] = changed[entry + 16 : entry + 20] = digest
        entry += 46 + sum(lengths)
    return bytes(changed)
