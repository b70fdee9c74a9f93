"""Tables of numbers: CSV and TSV of any program, and OpenSim's MOT and STO."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError, FormatError
from mocapress.formats.bids import channels_beside
from mocapress.formats.contract import Format, LongSplit, Near, Split
from mocapress.formats.layout import NO_ROWS
from mocapress.formats.printed_floats import as_printed
from mocapress.formats.problems import BYTES_AFTER_END, UNREADABLE_ROWS, Problem
from mocapress.formats.table_layout import (
    NUMBERS,
    SAME,
    SERIES,
    TableColumn,
    TableLayout,
    read_layout,
    series,
)
from mocapress.formats.table_splitting import (
    MISSING,
    NUMBER,
    find_layout,
    numbers_of,
    split_table,
)
from mocapress.formats.table_writing import with_frames, write_csv
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.columns import distinct, numbered_columns
from mocapress.motion.frame_time import FrameTime
from mocapress.records import Held, Ranges

CSV = "csv"
"""Id of the format."""
TABLE = "table"
"""Name of the stream that holds the columns of numbers."""
_ROWS_AT_LEAST = 3
_MOST_NAMED = 2**12
"""Lines, and cells of a column, that are looked at to name those that are broken."""
_TIME = re.compile(r"(time|timestamp|t|seconds|time *\(?s(econds)?\)?)\Z", re.IGNORECASE)

Values = NDArray[np.float64]


def split(data: bytes, _skeleton: Skeleton | None, file: str | None, *, kind: str = CSV) -> Split:
    """Take a table apart.

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    layout, values = split_table(Held(data), kind, file)
    return Split(_clip(layout, values, file), NO_ROWS, tuple(problems_of(layout)), layout)


def split_long(file: Ranges, name: str | None, *, kind: str = CSV) -> LongSplit:
    """Take a table apart, a run of rows at a time.

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    layout = find_layout(file, kind, name)
    clip = _clip(layout, np.empty((0, layout.sizes[0][1])), name)

    def parts() -> Iterator[dict[str, Values]]:
        return ({TABLE: values} for values in numbers_of(file, layout))

    return LongSplit(clip, (layout.rows,), tuple(problems_of(layout)), layout, parts)


def _clip(layout: TableLayout, values: Values, name: str | None) -> Clip:
    if not values.shape[1]:
        raise FormatError("no column of numbers", file=name, expected="a table of numbers")
    stream = Stream(values, numbered_columns(values.shape[1], ("v",)), time_of(layout))
    return Clip({TABLE: stream}, None, Path(name).stem if name else "")


def problems_of(layout: TableLayout) -> list[Problem]:
    """Name rows that are left out, cells that are no numbers, and what stands behind the rows."""
    found = []
    first = layout.header.count(b"\n") + 1
    lines = list(islice(layout.verbatim.items(steps=False), _MOST_NAMED))
    broken = [(place, line) for place, line in lines if line.strip()]
    if broken:
        place, line = min(broken)
        cells = line.count(layout.delimiter) + 1
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
        found.append(Problem.of(UNREADABLE_ROWS, what, at, None, "a number", repr(text_of(cell))))
    if layout.tail.strip():
        found.append(Problem.of(BYTES_AFTER_END, "something behind the last row"))
    return found


def _and_more(count: int) -> str:
    least = "at least " if count >= _MOST_NAMED else ""
    return f" (and {least}{count - 1} more)" if count > 1 else ""


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
            found[place] = numbers if column.others.number else as_printed(numbers, column.format)
        elif column.kind == SAME:
            found[place] = np.full(len(values), _number(column.text))
        elif column.kind == SERIES and len(values) == layout.rows:
            rows = np.arange(layout.rows, dtype=np.float64)
            found[place] = series(column.first, column.step, rows)
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
    stream = stream_of(clip, TABLE)
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


def stream_of(clip: Clip, name: str) -> Stream:
    """Give the stream that a layout is about; a file that lies may have another."""
    if name not in clip.streams:
        raise CorruptError("streams", expected=repr(name), found=repr(", ".join(clip.streams)))
    return clip.streams[name]


def named_columns(names: Sequence[str]) -> tuple[Column, ...]:
    """Give columns of names; one that is there again is ``name#2``."""
    return tuple(Column(name, place, "v") for place, name in enumerate(distinct(names)))


def _recognised(head: bytes) -> bool:
    """Tell a table by rows of equally many numbers, between tabs, commas or semicolons."""
    if b"\0" in head:
        return False
    whole = head[: head.rfind(b"\n") + 1]
    try:
        layout, values = split_table(Held(whole), CSV, None)
    except FormatError:
        return False
    enough = layout.rows >= _ROWS_AT_LEAST and values.shape[1] > 1 and not layout.verbatim.number
    return enough and layout.delimiter != b" "


FORMAT = Format(
    id=CSV,
    name="CSV",
    suffixes=(".csv", ".tsv", ".mot", ".sto"),
    recognises=_recognised,
    split=split,
    split_long=split_long,
    fit=with_frames,
    write=write_csv,
    written=(".csv",),
    any_columns=True,
    timed=False,
    read_layout=partial(read_layout, kind=CSV),
    describe=described,
)
