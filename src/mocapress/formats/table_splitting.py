"""Taking tables of numbers apart, a run of lines at a time: cells between delimiters, in rows.

A table may be larger than memory. It is gone through to see what its columns hold, then to find
all that they do not print, and then for its numbers.
"""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from mocapress import _core
from mocapress.errors import FormatError
from mocapress.formats.number_formats import printed, unpacked
from mocapress.formats.printed_floats import as_floats, coarser_floats
from mocapress.formats.table_cutting import Cut, find_cut
from mocapress.formats.table_layout import (
    NUMBERS,
    SAME,
    SERIES,
    TEXTS,
    TableColumn,
    TableLayout,
    Texts,
    Values,
    series,
)
from mocapress.records import Ranges

_SAMPLE = 48
"""Rows of the first block of which all cells are looked at again; of others, few."""
_SAMPLE_OF_OTHERS = 4
_MOST_KEPT = 2**16
"""Bytes that any table may have beside its numbers; others half of their size."""


def split_table(file: Ranges, kind: str, name: str | None) -> tuple[TableLayout, Values]:
    """Take a table apart: its layout, and the numbers of the columns that hold such, (F, C).

    Raises
    ------
    FormatError
        When it is no table of numbers.

    """
    kept: list[Values] = []
    layout = find_layout(file, kind, name, kept)
    return layout, _floats(layout, np.concatenate(kept))


def find_layout(
    file: Ranges, kind: str, name: str | None, kept: list[Values] | None = None
) -> TableLayout:
    """Find the layout of a table; its numbers go to ``kept``.

    Raises
    ------
    FormatError
        When it is no table of numbers, or mostly something else.

    """
    cut = find_cut(file, name)
    columns = _columns(file, cut)
    while True:
        if kept is not None:
            kept.clear()
        matcher = _matcher(cut, columns)
        for block in cut.blocks(file):
            numbers = matcher.match(block)
            if kept is not None:
                kept.append(numbers)
            if matcher.kept > max(file.size // 2, _MOST_KEPT):
                raise FormatError("no table of numbers", file=name, expected="mostly numbers")
        wrong = [
            place
            for place, count in enumerate(matcher.counts)
            if columns[place].kind == SERIES and 100 * count > matcher.rows
        ]
        if not wrong:
            break
        for place in wrong:
            columns[place] = replace(columns[place], kind=NUMBERS)
    counts = matcher.counts
    for place, column in enumerate(columns):
        if column.kind == TEXTS or counts[place]:
            text = matcher.texts(place) if column.kind == TEXTS else column.text
            columns[place] = replace(column, text=text, others=Texts(*matcher.others(place)))
    return TableLayout(
        kind,
        file.read(0, cut.begin),
        cut.delimiters,
        cut.line_break,
        file.read(cut.end, file.size),
        tuple(columns),
        matcher.rows,
        Texts(*matcher.verbatim()),
        cut.decimal_comma,
    )


def numbers_of(file: Ranges, layout: TableLayout) -> Iterator[Values]:
    """Give the numbers of a table whose layout is found, a run of rows after the other."""
    begin, end = len(layout.header), file.size - len(layout.tail)
    width = len(layout.columns)
    cut = Cut(layout.delimiters, layout.line_break, width, begin, end, layout.decimal_comma)
    columns = [column if column.kind == NUMBERS else TableColumn(SAME) for column in layout.columns]
    for block in cut.blocks(file):
        # A new one, so that it keeps nothing.
        yield _floats(layout, _matcher(cut, columns).match(block))


def _floats(layout: TableLayout, numbers: Values) -> Values:
    """Give the float32 that were printed, where columns are such."""
    stored = [column for column in layout.columns if column.kind == NUMBERS]
    formats = [column.format for column in stored]
    for place in coarser_floats(numbers, formats):
        if not stored[place].others.number:
            numbers[:, place] = as_floats(np.ascontiguousarray(numbers[:, place]), formats[place])
    return numbers


def _matcher(cut: Cut, columns: list[TableColumn]) -> _core.TableMatcher:
    told = [column.told() for column in columns]
    return _core.TableMatcher(cut.delimiters, cut.line_break, told)


def _columns(file: Ranges, cut: Cut) -> list[TableColumn]:
    """Find how the cells of columns come about."""
    survey = _core.TableSurvey(cut.delimiters, cut.line_break, cut.width)
    sampled = _SAMPLE
    for block in cut.blocks(file):
        survey.add(block, sampled)
        sampled = _SAMPLE_OF_OTHERS
    formats = unpacked(survey.formats())
    columns = []
    for place, told in enumerate(survey.columns):
        numbers, missing, texts, same, cell, width, gone, rises, *steps = told
        if same and not numbers:
            columns.append(TableColumn(SAME, text=cell))
        elif not numbers or 10 * texts > numbers + missing + texts:
            columns.append(TableColumn(TEXTS))
        else:
            made = TableColumn(NUMBERS, formats[place], width, gone)
            if rises:
                made = _series(made, _steps(numbers, *steps), survey.sample(place))
            columns.append(made)
    return columns


def _series(
    column: TableColumn,
    steps: list[tuple[Fraction, Fraction]],
    sample: list[tuple[int, bytes]],
) -> TableColumn:
    """Give the column as a series where one has the cells of the sample, else as it is."""
    rows = np.array([row for row, _ in sample], np.float64)
    for first, step in steps:
        numbers = series(first, step, rows)
        cells = [cell.rjust(column.width) for cell in printed(numbers, column.format)]
        if cells == [cell for _, cell in sample]:
            return replace(column, kind=SERIES, first=first, step=step)
    return column


def _steps(
    count: int, begin: float, last: float, longest: float
) -> list[tuple[Fraction, Fraction]]:
    """Give series that so many rising numbers may be: a first one and the step to the next."""
    if count < 3:
        return []
    mean = (last - begin) / (count - 1)
    if not (1e-18 < mean < 1e18 and longest <= 3 * mean):
        return []
    found = []
    for rate in dict.fromkeys(round(1 / mean, decimals) for decimals in range(4)):
        if rate > 0:
            step = 1 / Fraction(str(rate))
            # The first number is a multiple of the step, or as it is printed.
            start = round(begin / float(step)) * step
            found += [(start, step), (Fraction(str(begin)), step)]
    found.append((Fraction(str(begin)), Fraction(str(float(f"{mean:.6g}")))))
    small = 2**40
    return [
        pair for pair in found if all(max(abs(n.numerator), n.denominator) < small for n in pair)
    ]
