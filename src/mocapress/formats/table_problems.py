"""What is not as it should be in a table of numbers."""

import re
from itertools import islice

from mocapress.formats.problems import BYTES_AFTER_END, UNREADABLE_ROWS, Problem
from mocapress.formats.table_cutting import MISSING, NUMBER
from mocapress.formats.table_layout import NUMBERS, TableLayout, exchanged
from mocapress.formats.table_names import LINE_BREAK, text_of

_LONGEST_LINE = 2**12
"""Bytes of a line outside the rows that are looked at."""
_MOST_NAMED = 2**12
"""Lines, and cells of a column, that are looked at to name those that are broken."""
_ROWS_OF_A_MATRIX = 6
"""So many in a header may be a matrix of a calibration."""
_PART_OF_A_TABLE = 0.1
"""More, but fewer than this part of the rows, are a header's own."""


def problems_of(layout: TableLayout) -> list[Problem]:
    """Name rows that are left out, cells that are no numbers, and what stands behind the rows."""
    found = []
    first = len(LINE_BREAK.findall(layout.header)) + 1
    lines = list(islice(layout.verbatim.items(steps=False), _MOST_NAMED))
    broken = [(place, line) for place, line in lines if line.strip()]
    if broken:
        place, line = min(broken)
        cells = _cells_of(line, layout.delimiters[0])
        what = "a row of another length, which is left out" + _and_more(len(broken))
        width = f"{len(layout.columns)} cells"
        found.append(Problem.of(UNREADABLE_ROWS, what, first + place, None, width, str(cells)))
    odd = [
        (row, text)
        for column in layout.columns
        if column.kind == NUMBERS
        for row, text in islice(column.others.items(steps=True), _MOST_NAMED)
        if not (NUMBER.match(text.strip()) or MISSING.match(text.strip()))
    ]
    if odd:
        row, cell = min(odd)
        at = first + row + sum(place <= row for place, _ in lines)
        what = "a cell that is no number" + _and_more(len(odd))
        told = exchanged(cell) if layout.decimal_comma else cell
        found.append(Problem.of(UNREADABLE_ROWS, what, at, None, "a number", repr(text_of(told))))
    last = first + layout.rows + layout.verbatim.number - 1
    apart = (
        f": lines {first} to {last} are read; save the others in a file of their own to read them"
    )
    above = _rows(layout.header)
    if len(above) > _ROWS_OF_A_MATRIX and len(above) >= _PART_OF_A_TABLE * layout.rows:
        what = "rows of another table before the first row, which are left out" + apart
        found.append(Problem.of(UNREADABLE_ROWS, what, above[0]))
    if layout.tail.strip(b' \t\r\n"'):
        if len(_rows(layout.tail)) > 1:
            what = "rows of another table behind the last row, which are left out" + apart
            found.append(Problem.of(UNREADABLE_ROWS, what, last + 1))
        else:
            found.append(Problem.of(BYTES_AFTER_END, "something behind the last row"))
    return found


def _rows(lines: bytes) -> list[int]:
    """Give the lines, counted from 1, that are rows of numbers."""
    listed = LINE_BREAK.split(lines)[:_MOST_NAMED]
    return [place for place, line in enumerate(listed, 1) if _is_row(line)]


def _is_row(line: bytes) -> bool:
    """Tell whether a line is mostly numbers, several of them, however it is cut."""
    cells = re.split(rb"[\t,;| ]+", line[:_LONGEST_LINE])
    numbers = sum(1 for cell in cells if NUMBER.match(cell.strip(b'"\r')))
    return numbers > 1 and 2 * numbers >= len(cells)


def _cells_of(line: bytes, delimiter: bytes) -> int:
    return line.count(delimiter) + 1 if delimiter else len(line.split())


def _and_more(count: int) -> str:
    least = "at least " if count >= _MOST_NAMED else ""
    return f" (and {least}{count - 1} more)" if count > 1 else ""
