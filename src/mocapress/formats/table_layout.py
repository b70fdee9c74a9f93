"""What a table of numbers holds beside its numbers: header, delimiter, how each column is printed.

A layout also keeps all cells that are printed otherwise. ``table_splitting`` finds it;
docs/format/table.md says how it is stored.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError
from mocapress.formats.contract import StoredLayout
from mocapress.formats.encodings import MARKS, recoded
from mocapress.formats.number_formats import SHORTEST, read_format, record_of
from mocapress.formats.rows import RowsOf
from mocapress.motion.number_format import NumberFormat
from mocapress.records import Reader, Writer

Values = NDArray[np.float64]

NUMBERS, SAME, TEXTS, SERIES = range(4)
"""What a column holds: numbers of the stream, one text, any texts, or first + row * step."""
MOST_COLUMNS = 2**16
_MOST_ROWS = 2**40
_PIECE = 2**16
"""Cells that are printed together."""
_LONGEST_DELIMITER = 255
_COMMAS, _MIXED = 1, 8
_ENCODINGS = {"": 0, "utf-16-le": 2, "utf-16-be": 4}
"""What the options of a layout say, as bits."""
_ENCODED, _MOST_OPTIONS = 6, 15
_EXCHANGED = bytes.maketrans(b",.", b".,")


def exchanged(text: bytes) -> bytes:
    """Give a text with points for commas, and commas for points."""
    return text.translate(_EXCHANGED)


class Texts(NamedTuple):
    """Texts by their places, as they are stored."""

    number: int = 0
    record: bytes = b""

    def items(self, *, steps: bool) -> Iterator[tuple[int, bytes]]:
        """Give places and texts; ``steps``: a place is stored as the steps from the one before."""
        reader, place = Reader(self.record, "texts"), 0
        for _ in range(self.number):
            told = reader.integer()
            place = place + told if steps else told
            yield place, reader.bytes()


_NO_TEXTS = Texts()
_ZERO = Fraction(0)


@dataclass(frozen=True, slots=True)
class TableColumn:
    """How the cells of a column come about."""

    kind: int
    format: NumberFormat = SHORTEST
    width: int = 0
    """To which numbers are padded with blanks on the left."""
    missing: bytes = b""
    """What stands for NaN."""
    text: bytes = b""
    """Of all cells, or all texts with line feeds between them."""
    first: Fraction = _ZERO
    step: Fraction = _ZERO
    others: Texts = _NO_TEXTS
    """Cells that have another text, by row."""

    def told(self) -> tuple[int, bytes, int, bytes, bytes, float, float, float]:
        """Give the column as the compiled core has it."""
        numbers = _parts(self.first, self.step) if self.kind == SERIES else (0.0, 0.0, 1.0)
        return (self.kind, record_of(self.format), self.width, self.missing, self.text, *numbers)


def _parts(first: Fraction, step: Fraction) -> tuple[float, float, float]:
    low = first.denominator * step.denominator
    return float(first * low), float(step * low), float(low)


def series(first: Fraction, step: Fraction, rows: Values) -> Values:
    """Give first + row * step, each number correctly rounded as long as it is a quotient."""
    start, by, low = _parts(first, step)
    found: Values = (start + by * rows) / low
    return found


@dataclass(frozen=True, slots=True, eq=False)
class TableLayout(StoredLayout):
    """A table without its numbers."""

    format: str
    header: bytes
    delimiters: tuple[bytes, ...]
    """Between all cells, or of each two."""
    line_break: bytes
    tail: bytes
    """Behind the last row's cells: a line break, or nothing, or lines that are no rows."""
    columns: tuple[TableColumn, ...]
    rows: int
    """Those of cells."""
    verbatim: Texts
    """Lines between the rows that are no such rows, by their line in the body."""
    decimal_comma: bool = False
    """Whether commas and points of the rows are exchanged in the file."""
    encoding: str = ""
    """Of the file, where it is not UTF-8: one of ``MARKS``."""

    @property
    def sizes(self) -> list[tuple[int, int]]:
        """Give frames and columns of the stream."""
        return [(self.rows, sum(column.kind == NUMBERS for column in self.columns))]

    def pieces(self, rows: RowsOf, most_bytes: int = 2**62) -> Iterator[bytes]:
        """Print the file; see ``StoredLayout``."""
        mark = MARKS.get(self.encoding, b"")
        # A text may be longer in UTF-8 than in UTF-16.
        for piece in self._texts(rows, most_bytes * 2 if mark else most_bytes):
            made = mark + recoded(piece, self.encoding)
            mark, most_bytes = b"", most_bytes - len(made)
            if most_bytes < 0:
                raise CorruptError("the layout makes a longer file than announced")
            yield made

    def _texts(self, rows: RowsOf, most_bytes: int) -> Iterator[bytes]:
        """Print the file in its parts, in UTF-8."""
        left = most_bytes - len(self.header) - len(self.tail)
        try:
            printer = _core.TablePrinter(
                self.delimiters,
                self.line_break,
                [column.told() for column in self.columns],
                [column.others for column in self.columns],
                self.verbatim,
                self.rows,
            )
            yield self.header
            step = max(_PIECE // len(self.columns), 1)
            for first in range(0, max(self.rows, 1), step):
                values = rows(0, first, min(first + step, self.rows))
                piece = printer.print(np.ascontiguousarray(values), max(left, 0))
                left -= len(piece)
                yield exchanged(piece) if self.decimal_comma else piece
        except ValueError as error:
            raise CorruptError(f"the layout does not fit its file: {error}") from error
        if left < 0:
            raise CorruptError("the layout makes a longer file than announced")
        yield self.tail

    def record(self) -> bytes:
        """Give the layout as it is stored."""
        writer = Writer()
        for part in (self.header, self.delimiters[0], self.line_break, self.tail):
            writer.bytes(part)
        writer.integer(self.rows)
        _write_texts(writer, self.verbatim)
        writer.integer(len(self.columns))
        for column in self.columns:
            writer.integer(column.kind)
        for column in self.columns:
            _write_column(writer, column)
        mixed = len(self.delimiters) > 1
        options = _COMMAS * self.decimal_comma + _ENCODINGS[self.encoding] + _MIXED * mixed
        if options:
            writer.integer(options)
        if mixed:
            writer.bytes(b"".join(self.delimiters))
        return bytes(writer.data)


def _write_texts(writer: Writer, texts: Texts) -> None:
    writer.integer(texts.number)
    writer.data += texts.record


def _write_column(writer: Writer, column: TableColumn) -> None:
    if column.kind in (SAME, TEXTS):
        writer.bytes(column.text)
    else:
        writer.data += record_of(column.format)
        writer.integer(column.width)
        writer.bytes(column.missing)
    if column.kind == SERIES:
        for number in (column.first, column.step):
            writer.signed(number.numerator)
            writer.integer(number.denominator)
    _write_texts(writer, column.others)


def read_layout(data: bytes, kind: str) -> TableLayout:
    """Read what ``TableLayout.record`` gave, of a format.

    Raises
    ------
    CorruptError
        When it is not such a record.

    """
    reader = Reader(data, "layout of a table")
    header, delimiter, line_break, tail = (reader.bytes() for _ in range(4))
    if len(delimiter) > _LONGEST_DELIMITER or not line_break:
        raise reader.fail("no way to cut rows")
    rows = reader.integer(_MOST_ROWS)
    verbatim = _read_texts(reader, data, _MOST_ROWS, steps=False)
    kinds = [reader.integer(SERIES) for _ in range(reader.integer(MOST_COLUMNS))]
    if not kinds:
        raise reader.fail("a table without columns")
    columns = tuple(_read_column(reader, data, kind, rows) for kind in kinds)
    options = reader.integer(_MOST_OPTIONS) if reader.left else 0
    delimiters: tuple[bytes, ...] = (delimiter,)
    if options & _MIXED:
        delimiters = tuple(bytes([sign]) for sign in reader.bytes())
        if len(kinds) < 3 or len(delimiters) + 1 != len(kinds):
            raise reader.fail("another number of delimiters")
    encoding = next((name for name, bit in _ENCODINGS.items() if bit == options & _ENCODED), None)
    if encoding is None:
        raise reader.fail("no such encoding")
    reader.end()
    return TableLayout(
        kind,
        header,
        delimiters,
        line_break,
        tail,
        columns,
        rows,
        verbatim,
        bool(options & _COMMAS),
        encoding,
    )


def _read_texts(reader: Reader, data: bytes, most_place: int, *, steps: bool) -> Texts:
    count = reader.count(2)
    if not count:
        return _NO_TEXTS
    begin = reader.position
    try:
        end = _core.pass_texts(data, begin, count, most_place, steps)
    except ValueError as error:
        raise reader.fail(str(error)) from error
    return Texts(count, reader.raw(end - begin))


def _read_column(reader: Reader, data: bytes, kind: int, rows: int) -> TableColumn:
    number_format, width, missing, text = SHORTEST, 0, b"", b""
    first = step = _ZERO
    if kind in (SAME, TEXTS):
        text = reader.bytes()
    else:
        number_format, width, missing = read_format(reader), reader.integer(255), reader.bytes()
    if kind == SERIES:
        numbers = []
        for _ in range(2):
            numerator, denominator = reader.signed(), reader.integer()
            if denominator == 0:
                raise reader.fail("a series divided by 0")
            numbers.append(Fraction(numerator, denominator))
        first, step = numbers
    others = _read_texts(reader, data, max(rows - 1, 0), steps=True)
    if others.number and not rows:
        raise reader.fail("a cell outside the rows")
    return TableColumn(kind, number_format, width, missing, text, first, step, others)
