"""Tables of numbers: CSV and TSV of any program, and OpenSim's MOT and STO."""

import re
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError
from mocapress.formats.bids import channels_beside
from mocapress.formats.contract import Format, Near, Split
from mocapress.formats.layout import NO_ROWS
from mocapress.formats.printed_floats import as_printed
from mocapress.formats.problems import BYTES_AFTER_END, UNREADABLE_ROWS, Problem
from mocapress.formats.table_layout import (
    MISSING,
    NUMBER,
    NUMBERS,
    SAME,
    SERIES,
    TableColumn,
    TableLayout,
    read_layout,
    series,
    split_table,
)
from mocapress.formats.table_writing import with_frames, write_csv
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.columns import distinct, numbered_columns
from mocapress.motion.frame_time import FrameTime

CSV = "csv"
"""Id of the format."""
TABLE = "table"
"""Name of the stream that holds the columns of numbers."""
_ROWS_AT_LEAST = 3
_TIME = re.compile(r"(time|timestamp|t|seconds|time *\(?s(econds)?\)?)\Z", re.IGNORECASE)

Values = NDArray[np.float64]


def split(data: bytes, _skeleton: Skeleton | None, file: str | None, *, kind: str = CSV) -> Split:
    """Take a table apart.

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    layout, values, _ = split_table(data, kind, file)
    if not values.shape[1]:
        raise FormatError("no column of numbers", file=file, expected="a table of numbers")
    stream = Stream(values, numbered_columns(values.shape[1], ("v",)), time_of(layout))
    clip = Clip({TABLE: stream}, None, Path(file).stem if file else "")
    return Split(clip, NO_ROWS, tuple(problems_of(layout)), layout)


def problems_of(layout: TableLayout) -> list[Problem]:
    """Name rows that are left out, cells that are no numbers, and what stands behind the rows."""
    found = []
    first = layout.header.count(b"\n") + 1
    broken = [(place, line) for place, line in layout.verbatim.items() if line.strip()]
    if broken:
        place, line = min(broken)
        cells = line.count(layout.delimiter) + 1
        what = "a row of another length, which is left out" + _and_more(len(broken))
        width = f"{len(layout.columns)} cells"
        found.append(Problem.of(UNREADABLE_ROWS, what, first + place, None, width, str(cells)))
    odd = [
        (row, text)
        for column in layout.columns
        for row, text in column.others.items()
        if column.kind == NUMBERS
        and not (NUMBER.match(text.strip()) or MISSING.match(text.strip()))
    ]
    if odd:
        row, cell = min(odd)
        at = first + row + sum(place <= row for place in layout.verbatim)
        what = "a cell that is no number" + _and_more(len(odd))
        found.append(Problem.of(UNREADABLE_ROWS, what, at, None, "a number", repr(text_of(cell))))
    if layout.tail.strip():
        found.append(Problem.of(BYTES_AFTER_END, "something behind the last row"))
    return found


def _and_more(count: int) -> str:
    return f" (and {count - 1} more)" if count > 1 else ""


def header_lines(layout: TableLayout) -> list[list[str]]:
    """Give the cells of the header's lines, without quotes."""
    lines = layout.header.split(layout.line_break)[:-1]
    return [
        [text_of(cell).strip().strip('"') for cell in line.split(layout.delimiter)]
        for line in lines
    ]


def text_of(data: bytes) -> str:
    """Give a text, which may be in UTF-8 or ISO 8859-1."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def names_of(layout: TableLayout) -> list[str]:
    """Give the names of all columns: the last line of the header that has one for each."""
    width = len(layout.columns)
    for cells in reversed(header_lines(layout)):
        named = cells[:width]
        if len(named) == width and sum(map(bool, named)) * 2 > width:
            return [name or _unnamed(i) for i, name in enumerate(named)]
    return [_unnamed(i) for i in range(width)]


def time_of(layout: TableLayout) -> FrameTime:
    """Give the seconds per row, of a column of times."""
    for name, column in zip(names_of(layout), layout.columns, strict=True):
        if column.kind == SERIES and _TIME.match(name):
            return Fraction(column.step)
    return None


def full_values(layout: TableLayout, values: Values) -> dict[int, Values]:
    """Give the numbers of all columns that hold such, by their place in the table.

    Parameters
    ----------
    layout
        Of the table.
    values
        (F, C) of the stream; where these are not all rows, columns that are series are left out.

    """
    found = {}
    stored = iter(np.ascontiguousarray(values.T))
    for place, column in enumerate(layout.columns):
        if column.kind == NUMBERS:
            numbers = next(stored)
            found[place] = numbers if column.others else as_printed(numbers, column.format)
        elif column.kind == SAME:
            found[place] = np.full(len(values), _number(column.text))
        elif column.kind == SERIES and len(values) == layout.rows:
            found[place] = series(column.first, column.step, layout.rows)
    return found


def _is_text(column: TableColumn, *, named: bool) -> bool:
    """Tell a column that is one text from a channel that has no number in any row."""
    if column.kind != SAME or not np.isnan(_number(column.text)):
        return False
    return not (named and MISSING.match(column.text.strip()))


def _unnamed(place: int) -> str:
    return f"column {place + 1}"


def _number(cell: bytes) -> float:
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def described(layout: Any, clip: Clip, near: Near) -> Clip:
    """Give the columns of numbers, with their names; those of Motion-BIDS stand beside the file."""
    stream = clip.streams[TABLE]
    values, names = full_values(layout, stream.values), names_of(layout)
    units, time = [""] * len(names), stream.frame_time
    beside = channels_beside(near, len(names))
    if beside is not None:
        names, units = beside.names or names, beside.units or units
        time = beside.frame_time or time
    kept = {
        place: column
        for place, column in values.items()
        if not _is_text(layout.columns[place], named=names[place] != _unnamed(place))
    }
    named = named_columns([names[place] for place in kept])
    columns = tuple(
        replace(column, unit=units[place]) for place, column in zip(kept, named, strict=True)
    )
    matrix = np.stack(list(kept.values()), axis=1)
    return replace(clip, streams={TABLE: Stream(matrix, columns, time)})


def named_columns(names: Sequence[str]) -> tuple[Column, ...]:
    """Give columns of names; one that is there again is ``name#2``."""
    return tuple(Column(name, place, "v") for place, name in enumerate(distinct(names)))


def _recognised(head: bytes) -> bool:
    """Tell a table by rows of equally many numbers, between tabs, commas or semicolons."""
    if b"\0" in head:
        return False
    whole = head[: head.rfind(b"\n") + 1]
    try:
        layout, values, _ = split_table(whole, CSV, None)
    except FormatError:
        return False
    enough = layout.rows >= _ROWS_AT_LEAST and values.shape[1] > 1 and not layout.verbatim
    return enough and layout.delimiter != b" "


FORMAT = Format(
    id=CSV,
    name="CSV",
    suffixes=(".csv", ".tsv", ".mot", ".sto"),
    recognises=_recognised,
    split=split,
    fit=with_frames,
    write=write_csv,
    written=(".csv",),
    timed=False,
    read_layout=partial(read_layout, kind=CSV),
    describe=described,
)
