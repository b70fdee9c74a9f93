"""Tables of numbers: CSV and TSV of any program, and OpenSim's MOT and STO."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError, FormatError
from mocapress.formats.bids import channels_beside
from mocapress.formats.contract import Format, LongSplit, Near, Split
from mocapress.formats.encodings import FileText
from mocapress.formats.layout import NO_ROWS
from mocapress.formats.printed_floats import as_printed, rounded_floats
from mocapress.formats.table_cutting import MISSING
from mocapress.formats.table_layout import (
    NUMBERS,
    SAME,
    SERIES,
    TEXTS,
    TableColumn,
    TableLayout,
    read_layout,
    series,
)
from mocapress.formats.table_names import header_of, time_of, unnamed
from mocapress.formats.table_problems import problems_of
from mocapress.formats.table_splitting import find_layout, numbers_of, split_table
from mocapress.formats.table_writing import with_frames, write_csv
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.columns import distinct, numbered_columns
from mocapress.records import Held, Ranges

CSV = "csv"
"""Id of the format."""
TABLE = "table"
"""Name of the stream that holds the columns of numbers."""
_ROWS_AT_LEAST = 3
_NUMBERS_AT_LEAST = 1000
"""So many also tell a table, where rows are too long for three of them to be in the head."""

Values = NDArray[np.float64]


def split(data: bytes, _skeleton: Skeleton | None, file: str | None, *, kind: str = CSV) -> Split:
    """Take a table apart.

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    text = FileText.of(data)
    layout, values = split_table(Held(text.data), kind, file)
    layout = replace(layout, encoding=text.encoding)
    return Split(_clip(layout, values, file), NO_ROWS, tuple(problems_of(layout)), layout)


def split_long(file: Ranges, name: str | None, *, kind: str = CSV) -> LongSplit:
    """Take a table apart, a run of rows at a time.

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    if FileText.of(file.read(0, 4)).encoding:
        raise FormatError("a large table in UTF-16", file=name, expected="UTF-8")
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
    stored = zip(np.ascontiguousarray(values.T), rounded_floats(values).tolist(), strict=True)
    for place, column in enumerate(layout.columns):
        if column.kind == NUMBERS:
            numbers, rounded = next(stored)
            if rounded and not column.others.number:
                numbers = as_printed(numbers, column.format)
            found[place] = numbers
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
    text = column.text.strip()
    return not (MISSING.match(text) and (named or text))


def _number(cell: bytes) -> float:
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def described(layout: Any, clip: Clip, near: Near) -> Clip:
    """Give the columns of numbers, with their names; those of Motion-BIDS stand beside the file."""
    stream = stream_of(clip, TABLE)
    values, (names, units) = full_values(layout, stream.values), header_of(layout)
    time = stream.frame_time
    beside = channels_beside(near, len(names))
    if beside is not None:
        names, units = beside.names or names, beside.units or units
        time = beside.frame_time or time
    kept = {
        place: column
        for place, column in values.items()
        if not _is_text(layout.columns[place], named=names[place] != unnamed(place))
    }
    own = distinct(names[place] for place in kept)
    columns = tuple(
        Column(name, at, "v", units[place])
        for at, (name, place) in enumerate(zip(own, kept, strict=True))
    )
    matrix = np.stack(list(kept.values()), axis=1)
    return replace(clip, streams={TABLE: Stream(matrix, columns, time)})


def stream_of(clip: Clip, name: str) -> Stream:
    """Give the stream that a layout is about; a file that lies may have another."""
    if name not in clip.streams:
        raise CorruptError("streams", expected=repr(name), found=repr(", ".join(clip.streams)))
    return clip.streams[name]


def _recognised(head: bytes) -> bool:
    """Tell a table by rows of equally many numbers, between tabs, commas, semicolons or blanks."""
    if b"\0" in head:
        return False
    whole = head[: max(head.rfind(b"\n"), head.rfind(b"\r")) + 1]
    try:
        layout, values = split_table(Held(whole), CSV, None)
    except FormatError:
        return False
    columns = values.shape[1]
    between = layout.verbatim.items(steps=False)
    if columns < 2 or any(line.strip() for _, line in between):
        return False
    if all(not delimiter.strip(b" ") for delimiter in layout.delimiters):
        # Between blanks stands any text, too.
        others = any(column.kind == TEXTS or column.others.number for column in layout.columns)
        return layout.rows >= _ROWS_AT_LEAST and not others
    return layout.rows >= _ROWS_AT_LEAST or layout.rows * columns >= _NUMBERS_AT_LEAST


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
