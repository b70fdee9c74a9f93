"""How a table is cut into rows and cells: found from its first lines.

Between cells stand tabs, commas, semicolons or blanks, with blanks behind them or quotes around all
cells; or as many blanks as align the columns. Numbers may have decimal commas.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from mocapress.errors import FormatError
from mocapress.formats.table_layout import MOST_COLUMNS, exchanged
from mocapress.records import Ranges

NUMBER = re.compile(rb"[-+]?(\d++(\.\d*+)?|\.\d++)([eE][-+]?\d++)?\Z")
MISSING = re.compile(
    rb"([-+]?(nan|na|#?n/a|null|none|-)(\(ind\))?|[-+]?1\.#(qnan|ind)0*)?\Z", re.IGNORECASE
)
_MARK = b"\xef\xbb\xbf"
_SIGNS = (b"\t", b",", b";", b"|")
_ALIGNED = re.compile(rb"[^ ]+")
_HEAD = 2**18
"""Bytes from which the cut and the header are found."""
_BLOCK = 2**20
_LONGEST_LINE = 2**24
_LONGEST_HEADER = 16
_SAMPLE = 32
"""Lines that are cut in all ways to choose one."""


class Cut(NamedTuple):
    """Where the rows of a table are, and how they are cut into cells."""

    delimiters: tuple[bytes, ...]
    """Between all cells, or of each two; an empty one stands before blanks that align cells."""
    line_break: bytes
    width: int
    begin: int = 0
    end: int = 0
    """Behind the last row's cells."""
    decimal_comma: bool = False
    """Whether commas and points are exchanged before a row is cut."""

    def blocks(self, file: Ranges) -> Iterator[bytes]:
        """Give the lines, many at a time, without the line break behind the last."""
        rest, at = b"", self.begin
        while at < self.end:
            stop = min(at + max(_BLOCK, len(rest)), self.end)
            part, at = rest + file.read(at, stop), stop
            end = part.rfind(self.line_break) if at < self.end else len(part)
            if end < 0:
                if len(part) > _LONGEST_LINE:
                    raise FormatError("a line too long for a table", offset=at - len(part))
                rest = part
                continue
            rest = part[end + len(self.line_break) :]
            yield exchanged(part[:end]) if self.decimal_comma else part[:end]


class _Way(NamedTuple):
    """A way to cut lines: what stands before, between and behind their cells."""

    delimiters: tuple[bytes, ...]
    width: int = 0
    before: bytes = b""
    behind: bytes = b""
    decimal_comma: bool = False

    def cells(self, line: bytes) -> list[bytes] | None:
        """Give the cells of a row without the blanks around them; None where it is no row."""
        inner = line[len(self.before) : len(line) - len(self.behind)]
        if self.before + inner + self.behind != line:
            return None
        if self.decimal_comma:
            inner = exchanged(inner)
        if len(self.delimiters) > 1:
            cells, at = [], 0
            for delimiter in self.delimiters:
                end = inner.find(delimiter, at)
                if end < 0:
                    return None
                cells.append(inner[at:end])
                at = end + len(delimiter)
            cells.append(inner[at:])
        elif self.delimiters[0]:
            cells = inner.split(self.delimiters[0])
        else:
            cells = _ALIGNED.findall(inner)
        if self.width and len(cells) != self.width:
            return None
        return [cell.strip() for cell in cells]

    def numbers(self, line: bytes) -> int:
        """Count the numbers of a row: most cells are such, or no cell at all is anything else."""
        cells = self.cells(line)
        if cells is None:
            return 0
        numbers = sum(1 for cell in cells if NUMBER.match(cell))
        others = sum(
            1 for cell in cells if cell and not NUMBER.match(cell) and not MISSING.match(cell)
        )
        return numbers if numbers >= others else 0


def find_cut(file: Ranges, name: str | None) -> Cut:
    """Find how a table is cut.

    Raises
    ------
    FormatError
        When there are no rows of numbers in its beginning.

    """
    head = file.read(0, min(_HEAD, file.size))
    marked = len(_MARK) if head.startswith(_MARK) else 0
    line_break = _line_break(head)
    if len(head) < file.size:
        head = head[: head.rfind(line_break) + len(line_break)]
    lines = head[marked:].split(line_break)
    end = len(lines)
    while end and not lines[end - 1].strip():
        end -= 1
    way = _way([line for line in lines[end // 2 : end] if line.strip()])
    first = _first_row(lines[:end], way) if way else None
    if way is None or first is None or way.width > MOST_COLUMNS:
        raise FormatError("no table of numbers", file=name, expected="rows of numbers")

    start = marked + sum(len(line) + len(line_break) for line in lines[:first])
    stop = _end(file, start, line_break, lambda line: way.numbers(line) > 0)
    return Cut(
        way.delimiters,
        way.behind + line_break + way.before,
        way.width,
        start + len(way.before),
        stop - len(way.behind),
        way.decimal_comma,
    )


def _line_break(head: bytes) -> bytes:
    """Give what ends most lines; where lines end in both ways, what all of them end with."""
    second = head[len(head) // 2 :]
    pairs, feeds, returns = (second.count(end) for end in (b"\r\n", b"\n", b"\r"))
    if not head.count(b"\n"):
        return b"\r" if returns else b"\n"
    return b"\r\n" if (pairs and pairs == feeds) or pairs * 32 > feeds * 31 else b"\n"


def _way(lines: list[bytes]) -> _Way | None:
    """Choose the way in which most numbers are found in lines that are rows, mostly."""
    sample = lines[:: max(len(lines) // _SAMPLE, 1)]

    def score(way: _Way) -> tuple[int, int]:
        # 1,5;2,5 are two numbers by commas, too, with a text between them.
        return sum(map(way.numbers, sample)), -way.width

    best = max(_ways(sample), key=score, default=None)
    if best is None or not score(best)[0]:
        return None
    mixed = _mixed(sample, best)
    return mixed if mixed and score(mixed) > score(best) else best


def _ways(lines: Sequence[bytes]) -> Iterator[_Way]:
    """Give ways to cut lines; of equally good ones the narrowest counts, then the first."""
    for sign in _SIGNS:
        found = [line for line in lines if sign in line]
        if 2 * len(found) <= len(lines) and sign != b"\t":
            continue
        quoted = b'"' + sign + b'"'
        ends = all(line[:1] == line[-1:] == b'"' for line in found)
        if found and ends and all(line.count(quoted) == line.count(sign) for line in found):
            made = _Way((quoted,), 0, b'"', b'"')
        elif found and all(
            line.count(sign + b" ") == line.count(sign) and sign + b"  " not in line
            for line in found
        ):
            made = _Way((sign + b" ",))
        else:
            made = _Way((sign,))
        yield from _wide(made, lines)
        if sign != b",":
            yield from _wide(made._replace(decimal_comma=True), lines)
    runs = [re.findall(rb"(?<=[^ ]) +(?=[^ ])", line) for line in lines]
    lengths = {len(run) for found in runs for run in found}
    if not lengths:
        return
    before = _same(line[: len(line) - len(line.lstrip(b" "))] for line in lines)
    behind = _same(line[len(line.rstrip(b" ")) :] for line in lines) or b""
    if len(lengths) == 1 and before is not None:
        made = _Way((b" " * lengths.pop(),), 0, before, behind)
    else:
        made = _Way((b"",), 0, b"", behind)
    for way in (made, made._replace(decimal_comma=True)):
        yield from _wide(way, lines)


def _same(texts: Iterator[bytes]) -> bytes | None:
    found = set(texts)
    return found.pop() if len(found) == 1 else None


def _wide(way: _Way, lines: Sequence[bytes]) -> Iterator[_Way]:
    """Give a way with the width that most lines have."""
    widths = Counter(len(cells) for cells in map(way.cells, lines) if cells is not None)
    if not widths:
        return
    width = widths.most_common(1)[0][0]
    if width > 1 or way.delimiters == (b"\t",):
        yield way._replace(width=width)


def _mixed(lines: Sequence[bytes], best: _Way) -> _Way | None:
    """Give a way with several delimiters, where cells hold several numbers: ``1,2,3<tab>4,5,6``.

    Cells of two numbers may be numbers with decimal commas.
    """
    line = next((line for line in lines if best.numbers(line)), b"")
    found = re.findall(rb"[\t,;]", line)
    cells = re.split(rb"[\t;]", line)
    if len(set(found)) < 2 or max(cell.count(b",") for cell in cells) < 2:
        return None
    return _Way(tuple(found), len(found) + 1)


def _first_row(lines: list[bytes], way: _Way) -> int | None:
    """Give the line of the first row of numbers; None where less than half of the lines are such.

    Headers have rows of numbers, too; behind the last line that is none, all are.
    """
    numeric = [way.numbers(line) > 0 for line in lines]
    if not any(numeric):
        return None
    begin = numeric.index(True)
    if sum(numeric) * 2 < sum(1 for line in lines[begin:] if line.strip()):
        return None
    for place in range(begin, min(len(lines), _LONGEST_HEADER)):
        if lines[place].strip() and not numeric[place]:
            begin = place + 1
    return begin if begin < len(lines) else None


def _end(file: Ranges, begin: int, line_break: bytes, is_row: Callable[[bytes], bool]) -> int:
    """Give where the last row of numbers ends, which is looked for near the end of the file."""
    start = max(file.size - _BLOCK, begin)
    lines = file.read(start, file.size).split(line_break)
    end = file.size
    for place in range(len(lines) - 1, 0 if start > begin else -1, -1):
        if is_row(lines[place]):
            return end
        end -= len(lines[place]) + len(line_break)
    return file.size
