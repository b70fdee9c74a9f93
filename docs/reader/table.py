"""From a stream to a table of numbers (docs/format/table.md)."""

import codecs
import math

from printing import printed
from records import CorruptError, Record

NUMBERS, SAME, TEXTS, SERIES = range(4)
COMMAS, SEVERAL = 1, 8
ENCODINGS = ((2, codecs.BOM_UTF16_LE, "utf-16-le"), (4, codecs.BOM_UTF16_BE, "utf-16-be"))


class Column:
    """How the cells of a column come about."""

    def __init__(self, record: Record, kind: int) -> None:
        self.kind, self.series = kind, (0.0, 0.0, 1.0)
        if kind in (SAME, TEXTS):
            self.text = record.bytes()
        else:
            self.format, self.width, self.missing = record.raw(4), record.integer(), record.bytes()
        if kind == SERIES:
            a, b, c, d = record.signed(), record.integer(), record.signed(), record.integer()
            self.series = float(a * d), float(c * b), float(b * d)
        self.others, row = dict[int, bytes](), 0
        for _ in range(record.integer()):
            row += record.integer()
            self.others[row] = record.bytes()

    def cells(self, numbers: list[float], rows: int) -> list[bytes]:
        """Give the cells of all rows."""
        if self.kind == SAME:
            cells = [self.text] * rows
        elif self.kind == TEXTS:
            cells = self.text.split(b"\n")
        else:
            if self.kind == SERIES:
                first, step, divisor = self.series
                numbers = [(first + step * float(row)) / divisor for row in range(rows)]
            cells = [self._cell(number) for number in numbers]
        for row, text in self.others.items():
            cells[row] = text
        return cells

    def _cell(self, number: float) -> bytes:
        text = self.missing if math.isnan(number) else printed(number, self.format).encode()
        return text.rjust(self.width)


class Layout:
    """A table without its numbers."""

    def __init__(self, data: bytes) -> None:
        record = Record(data)
        self.header, self.delimiter, self.line_break, self.tail = (record.bytes() for _ in range(4))
        self.rows = record.integer()
        self.verbatim = [(record.integer(), record.bytes()) for _ in range(record.integer())]
        kinds = [record.integer() for _ in range(record.integer())]
        self.columns = [Column(record, kind) for kind in kinds]
        self.options = record.integer() if record.at < len(record.data) else 0
        self.delimiters = [self.delimiter] * (len(kinds) - 1)
        if self.options & SEVERAL:
            self.delimiters = [bytes([sign]) for sign in record.bytes()]
            if len(self.delimiters) + 1 != len(kinds):
                raise CorruptError("another number of delimiters")
        record.end()

    def printed(self, rows: list[list[float]]) -> bytes:
        """Print the table."""
        if len(rows) != self.rows:
            raise CorruptError("a stream of another number of rows")
        numbers = iter([list(column) for column in zip(*rows, strict=True)])
        cells = [
            column.cells(next(numbers) if column.kind == NUMBERS else [], self.rows)
            for column in self.columns
        ]
        before = [b"", *self.delimiters]
        lines = [
            b"".join(sign + cell for sign, cell in zip(before, row, strict=True))
            for row in zip(*cells, strict=True)
        ]
        for place, line in self.verbatim:
            lines.insert(place, line)
        body = self.line_break.join(lines)
        if self.options & COMMAS:
            body = body.translate(bytes.maketrans(b",.", b".,"))
        made = self.header + body + self.tail
        for option, mark, encoding in ENCODINGS:
            if self.options & option:
                made = mark + made.decode().encode(encoding)
        return made
