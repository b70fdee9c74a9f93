"""From streams to a C3D file (docs/format/c3d.md)."""

import math
import struct

from lines import bits32_within
from records import CorruptError, Record

DEC, MIPS = 1, 2
Rows = list[list[float]]


class Layout:
    """A C3D file without its numbers."""

    def __init__(self, data: bytes) -> None:
        record = Record(data)
        self.processor, self.floats = divmod(record.integer(), 2)
        self.points, self.channels, self.samples, self.frames, self.rotations, self.turns = (
            record.integer() for _ in range(6)
        )
        self.gap = record.integer()
        self.head, self.between, self.tail = record.bytes(), record.bytes(), record.bytes()
        self.differing, place = dict[int, int](), 0
        for _ in range(record.integer()):
            place += record.integer()
            self.differing[place] = record.integer()
        record.end()

    def printed(self, streams: list[Rows]) -> bytes:
        """Print the file."""
        left = iter(streams)
        points, residuals, cameras = (next(left) if self.points else [] for _ in range(3))
        analog = next(left) if self.channels else []
        words: list[int] = []
        for f in range(self.frames):
            for p in range(self.points):
                place = points[f][3 * p : 3 * p + 3]
                missing = all(map(math.isnan, place))
                words += [self.gap] * 3 if missing else map(self._word, place)
                residual, seen = residuals[f][p], cameras[f][p]
                words.append(self._word(residual if seen == 256 else 256 * seen + residual))
            for sample in analog[f * self.samples : (f + 1) * self.samples]:
                words += map(self._word, sample)
        first = len(words)
        if self.rotations and self.turns:
            for row in next(left):
                words += map(self._word, row)
        if next(left, None) is not None:
            raise CorruptError("more streams than the layout has")
        for at, word in self.differing.items():
            words[at] = word
        frames, turns = (
            b"".join(map(self._bytes, part)) for part in (words[:first], words[first:])
        )
        return self.head + frames + self.between + turns + self.tail

    def _word(self, number: float) -> int:
        if self.floats:
            if math.isnan(number):
                bits = int(struct.unpack("<Q", struct.pack("<d", number))[0])
                return bits >> 63 << 31 | 0x7FC00000 | bits >> 29 & 0x3FFFFF
            return bits32_within(4 * number if self.processor == DEC else number)
        return 0 if not abs(number) <= 2**15 else round(number) & 0xFFFF

    def _bytes(self, word: int) -> bytes:
        if not self.floats:
            return struct.pack(">H" if self.processor == MIPS else "<H", word)
        if self.processor == DEC:
            return struct.pack("<HH", word >> 16, word & 0xFFFF)
        return struct.pack(">I" if self.processor == MIPS else "<I", word)
