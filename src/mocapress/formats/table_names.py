"""What the header of a table says: names and units of its columns, and the time from row to row."""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

from mocapress.formats.table_layout import SAME, SERIES, TableLayout
from mocapress.motion.frame_time import FrameTime

_UNITS = (
    "mm|cm|dm|m|km|in|ft|s|sec|secs|seconds?|ms|msec|milliseconds?|us|µs|usec|microseconds?|ns"
    "|nsec|nanoseconds?|min|deg|degrees?|°|rad|radians?|N|kN|N[.*· ]?mm?|Nmm?|N/kg|N[.]?m/kg|V|mV"
    "|uV|µV|g|mg|mG|G|kg|Hz|kHz|%|[mc]?m/s|[mc]?m/s[/^]?(s|2|²)|(deg|rad|°)/s|(deg|rad|°)/s[/^]?(s|2|²)|px"
    "|pixels?|W|W/kg|Pa|kPa|hPa|T|uT|µT|mT|au|a[.]u[.]|n/a|-"
)
_UNIT = re.compile(rf"[\[(]?({_UNITS})[\])]?\Z")
_NAME_AND_UNIT = re.compile(rf".*\S\s*[\[(]\s*({_UNITS})\s*[\])]\Z")
_TIME = re.compile(
    r"%?(time|timestamps?|time ?stamp|t|zeit|seconds|secs?|elapsed ?time)"
    r"[ _]*[\[(,]? *(s|sec|secs|seconds?|ms|msec|milliseconds?|us|µs|usec|microseconds?|ns|nsec"
    r"|nanoseconds?)?[\])]?\Z",
    re.IGNORECASE,
)
_PARTS = {"s": 1, "m": 10**3, "u": 10**6, "µ": 10**6, "n": 10**9}
"""Of a second, by the first letter of a unit of time."""
_UNIT_OF_TIME = re.compile(r"(s|sec|secs|ms|msec|us|µs|usec|ns|nsec|(milli|micro|nano)?seconds?)\Z")
_RATE = re.compile(
    r"(?<!\w)(?:frequency|data ?rate|sampl(?:e|ing) ?(?:rate|frequency)|output ?rate"
    r"|(?:export |capture )?frame ?rate)[\"\s:=,;]+(\d+(?:[.,]\d+)?)",
    re.IGNORECASE,
)
_MARKERS = "MARKER_NAMES"
LINE_BREAK = re.compile(rb"\r\n|\n|\r")
_SIGNS = "\t;,|"
_LONGEST_NAME = 60
"""Characters of a name in which a unit or a time is looked for."""
_MOST_ABOVE = 16
"""Lines above the names that may tell them apart."""
_SLOWEST = 1
"""Seconds from row to row which a time without a unit may say; longer ones are not seconds."""


class Header(NamedTuple):
    """What a header says of all columns."""

    names: list[str]
    units: list[str]


def text_of(data: bytes) -> str:
    """Give a text, which may be in UTF-8 or ISO 8859-1."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def unnamed(place: int) -> str:
    """Give what a column is called that has no name."""
    return f"column {place + 1}"


def header_lines(layout: TableLayout) -> list[list[str]]:
    """Give the cells of the header's lines, without quotes."""
    lines = LINE_BREAK.split(layout.header)[:-1]
    # Where there are several, commas stand within cells.
    outer = next((sign for sign in layout.delimiters if sign != b","), b",")
    sign = text_of(outer.strip(b'" '))
    return [_cells(text_of(line), sign) for line in lines]


def _cells(line: str, sign: str) -> list[str]:
    if not sign or ("\t" in line and sign not in line):
        sign = next((other for other in _SIGNS if other in line), "")
    if sign not in _SIGNS or not sign:
        return line.split(sign or None)
    try:
        cells = next(csv.reader([line], delimiter=sign), []) or [""]
    except csv.Error:
        cells = line.split(sign)
    return [cell.strip().strip('"') for cell in cells]


def header_of(layout: TableLayout) -> Header:
    """Give names and units of all columns, as far as the header has them.

    The last line that has a name for each column names them. Where names repeat, as x, y and z do,
    what stands above them goes before them: ``hip.x``.
    """
    width = len(layout.columns)
    named = _named_columns(layout)
    lines = header_lines(layout)
    last = next((i for i in reversed(range(len(lines))) if _fills(lines[i], named, width)), None)
    if last is None:
        names = _grouped(layout, lines) or _of_markers(lines, width)
        return Header(names or [unnamed(i) for i in range(width)], [""] * width)
    units = [""] * width
    if last and _is_units(lines[last]) and any(map(str, lines[last - 1])):
        above = lines[last - 1]
        if not _is_units(above) and _fills(above, named, width, part=3):
            units, last = _fitted(lines[last], width), last - 1
    names = _distinguished(lines[: last + 1], width)
    for place, name in enumerate(names):
        found = _NAME_AND_UNIT.match(name[-_LONGEST_NAME:])
        if found and not units[place]:
            units[place] = found[1]
    plain = ["" if unit in ("n/a", "-") else unit.strip("[]()") for unit in units]
    return Header([name or unnamed(i) for i, name in enumerate(names)], plain)


def _named_columns(layout: TableLayout) -> int:
    """Count the columns without empty ones at the end, which a delimiter there makes."""
    width = len(layout.columns)
    while width > 1:
        column = layout.columns[width - 1]
        if column.kind != SAME or column.text.strip():
            break
        width -= 1
    return width


def _fills(cells: Sequence[str], named: int, width: int, part: int = 2) -> bool:
    """Tell whether a line has a cell for each column, most of them (one of ``part``) not empty."""
    return len(cells) >= named and sum(map(bool, cells[:width])) * part > named


def _fitted(cells: Sequence[str], width: int) -> list[str]:
    return [*cells[:width], *[""] * (width - len(cells))]


def _is_units(cells: Sequence[str]) -> bool:
    some = [cell for cell in cells if cell]
    return bool(some) and all(_UNIT.match(cell) for cell in some)


def _distinguished(lines: Sequence[Sequence[str]], width: int) -> list[str]:
    """Give the cells of the last line; before those that repeat, what tells them apart."""
    names = _fitted(lines[-1], width)
    counts = Counter(names)
    places = [i for i, name in enumerate(names) if name and counts[name] > 1]
    if not places:
        return names
    above: list[list[str]] = []
    for cells in reversed(lines[-1 - _MOST_ABOVE : -1]):
        if len(cells) < max(places[0] + 2, width // 2) or not any(cells):
            break
        above.insert(0, _filled(_fitted(cells, width)))
    chosen: list[list[str]] = []
    told: set[tuple[str, ...]] = {(names[i],) for i in places}
    for cells in above:
        more = {tuple(row[i] for row in (*chosen, cells, names)) for i in places}
        if len(more) > len(told):
            chosen, told = [*chosen, cells], more
    for i in places:
        parts = [*(row[i] for row in chosen), names[i]]
        names[i] = ".".join(part for part in parts if part)
    return names


def _filled(cells: list[str]) -> list[str]:
    """Give a line in which a cell counts up to the next that is not empty."""
    last, made = "", []
    for cell in cells:
        last = cell or last
        made.append(last)
    return made


def _grouped(layout: TableLayout, lines: Sequence[Sequence[str]]) -> list[str] | None:
    """Give names of cells that hold several numbers with a delimiter of their own."""
    signs = layout.delimiters
    if len(signs) == 1:
        return None
    outer = [0]
    for sign in signs:
        outer.append(outer[-1] + (sign != b","))
    cells = next((cells for cells in reversed(lines) if len(cells) == outer[-1] + 1), None)
    if cells is None:
        return None
    counts, seen = Counter(outer), Counter[int]()
    names = []
    for group in outer:
        seen[group] += 1
        names.append(f"{cells[group]}.{seen[group]}" if counts[group] > 1 else cells[group])
    return names


def _of_markers(lines: Sequence[Sequence[str]], width: int) -> list[str] | None:
    """Give x, y and z of the markers that Qualisys lists in one line."""
    for cells in lines:
        count = sum(map(bool, cells[1:]))
        if cells[:1] == [_MARKERS] and 3 * count == width:
            return [f"{label}.{axis}" for label in cells[1 : count + 1] for axis in "xyz"]
    return None


def time_of(layout: TableLayout) -> FrameTime:
    """Give the seconds per row: of a column of times, or of a rate that the header states."""
    header = header_of(layout)
    for name, unit, column in zip(header.names, header.units, layout.columns, strict=True):
        if column.kind != SERIES:
            continue
        found = _TIME.match(name) if len(name) < _LONGEST_NAME else None
        if found:
            told = found[2] or unit
            step = Fraction(column.step) / _PARTS.get(told[:1].lower(), 1)
            if told or step < _SLOWEST:
                return step
        elif _UNIT_OF_TIME.match(unit):
            return Fraction(column.step) / _PARTS[unit[0]]
    return _rate_of(layout)


def _rate_of(layout: TableLayout) -> FrameTime:
    lines = header_lines(layout)[:16]
    alone = [cells[0] for cells in lines[:2] if sum(map(bool, cells)) == 1]
    if len(alone) == 2 and not alone[0][:1].isdigit() and re.fullmatch(r"\d{1,6}", alone[1]):
        found = {alone[1]}  # as Vicon's Nexus has it: what it is, and its rate
    else:
        found = set(_RATE.findall(text_of(layout.header)))
    rates = {Decimal(rate.replace(",", ".")) for rate in found}
    rate = rates.pop() if len(rates) == 1 else Decimal(0)
    return 1 / Fraction(rate) if rate else None
