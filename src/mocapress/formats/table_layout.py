"""Tables of numbers as text: cells between delimiters, in rows behind a header of any lines.

What a table holds beside the numbers is its layout: header, delimiter, how each column is printed,
and all cells that are printed otherwise. docs/format/table.md says how it is stored.
"""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError, FormatError
from mocapress.formats.number_formats import (
    SHORTEST,
    printed,
    read_format,
    unpacked,
    write_format,
)
from mocapress.formats.printed_floats import as_floats
from mocapress.formats.rows import read_rows
from mocapress.motion.number_format import NumberFormat
from mocapress.records import Reader, Writer

Values = NDArray[np.float64]
Cells = list[bytes]

NUMBERS, SAME, TEXTS, SERIES = range(4)
"""What a column holds: numbers of the stream, one text, any texts, or first + row * step."""

_DELIMITERS = (b"\t", b",", b";", b" ")
NUMBER = re.compile(rb"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\Z")
MISSING = re.compile(rb"([-+]?(nan|na|n/a|null|none|-)(\(ind\))?)?\Z", re.IGNORECASE)
_MOST_DATA = 2**28
_MOST_COLUMNS = 2**16
_SAMPLE = 48
_LONGEST_HEADER = 16


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
    first: Fraction = Fraction(0)
    step: Fraction = Fraction(0)
    others: dict[int, bytes] = field(default_factory=dict)
    """Cells that have another text, by row."""

    def printed(self, rows: int, values: Values | None) -> Cells:
        """Give the cells of so many rows, of numbers where it holds such, (rows,)."""
        if self.kind == SAME:
            cells = [self.text] * rows
        elif self.kind == TEXTS:
            cells = self.text.split(b"\n")
            if len(cells) != rows:
                raise CorruptError("a column of texts with another number of rows")
        else:
            numbers = series(self.first, self.step, rows) if values is None else values
            cells = printed(numbers, self.format)
            for row in np.flatnonzero(np.isnan(numbers)).tolist():
                cells[row] = self.missing
            if self.width:
                cells = [cell.rjust(self.width) for cell in cells]
        for row, text in self.others.items():
            cells[row] = text
        return cells


def series(first: Fraction, step: Fraction, rows: int) -> Values:
    """Give first + row * step, each number correctly rounded as long as it is a quotient."""
    low = first.denominator * step.denominator
    start, by = first * low, step * low
    found: Values = (float(start) + float(by) * np.arange(rows, dtype=np.float64)) / float(low)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class TableLayout:
    """A table without its numbers."""

    format: str
    header: bytes
    delimiter: bytes
    line_break: bytes
    tail: bytes
    """Behind the last row's cells: a line break, or nothing, or lines that are no rows."""
    columns: tuple[TableColumn, ...]
    rows: int
    """Those of cells."""
    verbatim: dict[int, bytes]
    """Lines between the rows that are no such rows, by their line in the body."""

    def join(self, streams: Sequence[Values], most_bytes: int = 2**62) -> bytes:
        """Give the file's bytes from the values of the stream, (F, C).

        Raises
        ------
        CorruptError
            When they do not fit, or more than ``most_bytes`` would come out.

        """
        numbered = [i for i, column in enumerate(self.columns) if column.kind == NUMBERS]
        values = streams[0] if streams else np.empty((self.rows, 0))
        if len(streams) > 1 or values.shape != (self.rows, len(numbered)):
            raise CorruptError("values do not fit the layout")
        of_column = dict(zip(numbered, np.ascontiguousarray(values.T), strict=True))
        cells = [
            column.printed(self.rows, of_column.get(i)) for i, column in enumerate(self.columns)
        ]
        lines = [self.delimiter.join(row) for row in zip(*cells, strict=True)]
        for place, line in sorted(self.verbatim.items()):
            lines.insert(place, line)
        data = self.header + self.line_break.join(lines) + self.tail
        if len(data) > most_bytes:
            raise CorruptError("the layout makes a longer file than announced")
        return data

    def record(self) -> bytes:
        """Give the layout as it is stored."""
        writer = Writer()
        for part in (self.header, self.delimiter, self.line_break, self.tail):
            writer.bytes(part)
        writer.integer(self.rows)
        writer.integer(len(self.verbatim))
        for place, line in sorted(self.verbatim.items()):
            writer.integer(place)
            writer.bytes(line)
        writer.integer(len(self.columns))
        for column in self.columns:
            writer.integer(column.kind)
        for column in self.columns:
            _write_column(writer, column)
        return bytes(writer.data)


def _write_column(writer: Writer, column: TableColumn) -> None:
    if column.kind in (SAME, TEXTS):
        writer.bytes(column.text)
    else:
        write_format(writer, column.format)
        writer.integer(column.width)
        writer.bytes(column.missing)
    if column.kind == SERIES:
        for number in (column.first, column.step):
            writer.signed(number.numerator)
            writer.integer(number.denominator)
    writer.integer(len(column.others))
    last = 0
    for row, text in sorted(column.others.items()):
        writer.integer(row - last)
        writer.bytes(text)
        last = row


def read_layout(data: bytes, kind: str) -> TableLayout:
    """Read what ``TableLayout.record`` gave, of a format.

    Raises
    ------
    CorruptError
        When it is not such a record.

    """
    reader = Reader(data, "layout of a table")
    header, delimiter, line_break, tail = (reader.bytes() for _ in range(4))
    rows = reader.integer(2**40)
    verbatim = {}
    for _ in range(reader.count(2)):
        place = reader.integer()
        verbatim[place] = reader.bytes()
    kinds = [reader.integer(SERIES) for _ in range(reader.count())]
    columns = tuple(_read_column(reader, kind, rows) for kind in kinds)
    reader.end()
    return TableLayout(kind, header, delimiter, line_break, tail, columns, rows, verbatim)


def _read_column(reader: Reader, kind: int, rows: int) -> TableColumn:
    number_format, width, missing, text = SHORTEST, 0, b"", b""
    first = step = Fraction(0)
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
    others = {}
    row = 0
    for _ in range(reader.count(2)):
        row += reader.integer(rows)
        others[row] = reader.bytes()
    if others and row >= rows:
        raise reader.fail("a cell outside the rows")
    return TableColumn(kind, number_format, width, missing, text, first, step, others)


def split_table(
    data: bytes, kind: str, file: str | None
) -> tuple[TableLayout, Values, list[bytes]]:
    """Take a table apart.

    Returns
    -------
    tuple
        Layout, the numbers of the columns that hold such, (F, C), and the lines of the header.

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    if len(data) > _MOST_DATA:
        raise FormatError("a table too large to be taken apart", file=file)
    line_break = b"\r\n" if data.count(b"\r\n") * 2 > data.count(b"\n") else b"\n"
    lines = data.split(line_break)
    found = max((_rows(lines, delimiter) for delimiter in _DELIMITERS), key=lambda one: one[0])
    count, delimiter, begin, end, width = found
    if count < 1 or width > _MOST_COLUMNS:
        raise FormatError("no table of numbers", file=file, expected="rows of numbers")
    rows, verbatim = [], {}
    for place, line in enumerate(lines[begin:end]):
        cells = line.split(delimiter)
        if len(cells) == width:
            rows.append(cells)
        else:
            verbatim[place] = line
    of_columns = list(map(list, zip(*rows, strict=True)))
    columns, numbers = _columns(of_columns)
    header = b"".join(line + line_break for line in lines[:begin])
    tail = b"".join(line_break + line for line in lines[end:])
    layout = TableLayout(kind, header, delimiter, line_break, tail, columns, len(rows), verbatim)
    values = np.stack(numbers, axis=1) if numbers else np.empty((len(rows), 0))
    return layout, values, lines[:begin]


def _rows(lines: list[bytes], delimiter: bytes) -> tuple[int, bytes, int, int, int]:
    """Give how many numbers there are with a delimiter, and which lines are rows."""
    nothing = (0, delimiter, 0, 0, 0)
    end = len(lines)
    while end and not lines[end - 1].strip():
        end -= 1
    if not end:
        return nothing
    widths = Counter(line.count(delimiter) + 1 for line in lines[end // 2 : end])
    width = widths.most_common(1)[0][0]
    if width < 2 and delimiter != b"\t":
        return nothing
    numeric = [
        line.count(delimiter) + 1 == width and _is_row(line, delimiter) for line in lines[:end]
    ]
    if sum(numeric) * 2 < end - (numeric.index(True) if any(numeric) else end):
        return nothing
    if not any(numeric):
        return nothing
    begin = numeric.index(True)
    # Headers have rows of numbers, too; behind the last line that is none, all are.
    for place in range(begin, min(end, _LONGEST_HEADER)):
        if lines[place].strip() and not numeric[place]:
            begin = place + 1
    if not any(numeric[begin:]):
        return nothing
    end = len(numeric) - numeric[::-1].index(True)
    return sum(numeric[begin:]) * width, delimiter, begin, end, width


def _is_row(line: bytes, delimiter: bytes) -> bool:
    """Tell whether most cells of a line are numbers, or no cell at all is anything else."""
    cells = [cell.strip() for cell in line.split(delimiter)]
    numbers = sum(1 for cell in cells if NUMBER.match(cell))
    others = sum(1 for cell in cells if cell and not NUMBER.match(cell) and not MISSING.match(cell))
    return numbers > 0 and numbers >= others


def _columns(of_columns: list[Cells]) -> tuple[tuple[TableColumn, ...], list[Values]]:
    """Find how the cells of columns come about, and the numbers of those that hold such."""
    columns: list[TableColumn | None] = []
    numeric: list[int] = []
    for cells in of_columns:
        column = _column_of_texts(cells)
        if column is None:
            numeric.append(len(columns))
        columns.append(column)
    kept: list[Values] = []
    if numeric:
        missing = {i: [not NUMBER.match(cell.strip()) for cell in of_columns[i]] for i in numeric}
        stripped = [
            [
                b"0" if gone else cell.strip()
                for cell, gone in zip(of_columns[i], missing[i], strict=True)
            ]
            for i in numeric
        ]
        values, formats = _parsed(stripped, [missing[i] for i in numeric])
        for place, i in enumerate(numeric):
            numbers = values[:, place].copy()
            numbers[missing[i]] = np.nan
            column = _column_of_numbers(of_columns[i], numbers, formats[place], missing[i])
            columns[i] = column
            if column.kind == NUMBERS:
                kept.append(numbers if column.others else as_floats(numbers, column.format))
    return tuple(column for column in columns if column is not None), kept


def _column_of_texts(cells: Cells) -> TableColumn | None:
    """Give the column where it holds no numbers, or one text."""
    if len(set(cells)) == 1 and not NUMBER.match(cells[0].strip()):
        return TableColumn(SAME, text=cells[0])
    numbers = missing = 0
    for cell in cells:
        bare = cell.strip()
        if NUMBER.match(bare):
            numbers += 1
        elif MISSING.match(bare):
            missing += 1
    if numbers and 10 * (numbers + missing) >= 9 * len(cells):
        return None
    return TableColumn(TEXTS, text=b"\n".join(cells))


def _parsed(
    columns: list[Cells], missing: list[list[bool]]
) -> tuple[Values, tuple[NumberFormat, ...]]:
    """Give the numbers of cells, (F, C), and their formats; of other cells, 0."""
    bare = [[cell if NUMBER.match(cell) else b"0" for cell in cells] for cells in columns]
    rows = list(zip(*bare, strict=True))
    lines = [b" ".join(row) for row in rows]
    text = b"\n".join(lines) + b"\n"
    body = read_rows(text, 0, len(columns))
    if len(body.values) != len(rows):
        raise FormatError("numbers that cannot be read")
    begins = np.cumsum([0, *(len(line) + 1 for line in lines)])
    sample = np.unique(np.linspace(0, len(rows) - 1, _SAMPLE).astype(np.int64))
    places = np.full((len(sample), len(columns), 2), -1, np.int64)
    for found, row in zip(places, sample.tolist(), strict=True):
        ends = begins[row] + np.cumsum([len(cell) + 1 for cell in rows[row]]) - 1
        found[:, 0] = ends - [len(cell) for cell in rows[row]]
        found[:, 1] = ends
        found[[gone[row] for gone in missing]] = -1
    values = body.values
    return values, unpacked(
        _core.detect_formats(text, body.statistics, np.ascontiguousarray(values[sample]), places)
    )


def _column_of_numbers(
    cells: Cells, numbers: Values, number_format: NumberFormat, missing: list[bool]
) -> TableColumn:
    """Give a column of numbers: a series where they are one."""
    widths = Counter(len(cell) for cell, gone in zip(cells, missing, strict=True) if not gone)
    padded = any(cell[:1] == b" " for cell in cells)
    width = max(widths, key=lambda size: (widths[size], size)) if padded and widths else 0
    gone = Counter(cell for cell, own in zip(cells, missing, strict=True) if own)
    text, count = gone.most_common(1)[0] if gone else (b"", 0)
    if count == 1 and not MISSING.match(text.strip()):
        text = b""  # no mark of what is missing, but one broken cell
    width = width if width < 2**8 else 0

    def with_others(column: TableColumn, values: Values | None) -> TableColumn:
        made = column.printed(len(cells), values)
        others = {row: cell for row, cell in enumerate(cells) if made[row] != cell}
        return TableColumn(
            column.kind,
            column.format,
            column.width,
            column.missing,
            b"",
            column.first,
            column.step,
            others,
        )

    for first, step in _steps(numbers):
        column = TableColumn(SERIES, number_format, width, text, b"", first, step)
        made = with_others(column, None)
        if 100 * len(made.others) <= len(cells):
            return made
    return with_others(TableColumn(NUMBERS, number_format, width, text), numbers)


def _steps(numbers: Values) -> list[tuple[Fraction, Fraction]]:
    """Give series that numbers may be: a first one and the step to the next."""
    if len(numbers) < 3 or not np.isfinite(numbers).all() or not (np.diff(numbers) > 0).all():
        return []
    mean = float(numbers[-1] - numbers[0]) / (len(numbers) - 1)
    moves = np.diff(numbers)
    if moves.max() > 3 * mean or mean <= 0:
        return []
    found = []
    for rate in dict.fromkeys(
        (round(1 / mean), round(1 / mean, 1), round(1 / mean, 2), round(1 / mean, 3))
    ):
        if rate > 0:
            step = 1 / Fraction(str(rate))
            # The first number is a multiple of the step, or as it is printed.
            start = round(float(numbers[0]) / float(step)) * step
            found += [(start, step), (Fraction(str(float(numbers[0]))), step)]
    plain = Fraction(str(float(f"{mean:.6g}")))
    found.append((Fraction(str(float(numbers[0]))), plain))
    small = 2**40
    return [
        pair for pair in found if all(max(abs(n.numerator), n.denominator) < small for n in pair)
    ]
