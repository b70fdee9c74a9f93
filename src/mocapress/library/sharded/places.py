"""Where values stand in the file of an SQLite database, so that parts of the file give them.

https://www.sqlite.org/fileformat2.html: a table is a tree of pages. A leaf has the beginning of
each row, and the rest of a long one is in a chain of overflow pages, each of which begins with the
number of the next.
"""

import mmap
import sqlite3
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from mocapress.errors import CorruptError

_HEADER = 100
"""Bytes of the database's own header, on its first page."""
_LEAF, _INTERIOR = 13, 5
_NEXT = 4
"""Bytes of the number of the next page."""


class Place(NamedTuple):
    """Where bytes of a value stand."""

    begin: int
    """In the file."""
    size: int
    """Bytes, with the numbers of pages among them."""
    chained: bool
    """Whether it is overflow pages, of which each begins with the number of the next."""


class Pages:
    """The pages of a database that nobody writes."""

    def __init__(self, file: Path, page: int) -> None:
        self._data, self._page, self._file = mapped(file), page, file

    def rows(self, root: int) -> Iterator[tuple[int, list[Place], int]]:
        """Give of each row of a table its id, where its record stands, and the record's size."""
        begin = (root - 1) * self._page
        head = begin + _HEADER if root == 1 else begin
        kind, cells = self._data[head], self._number(head + 3, 2)
        if kind not in (_LEAF, _INTERIOR):
            raise CorruptError("damaged: no page of a table", file=str(self._file), offset=begin)
        table = head + (8 if kind == _LEAF else 12)
        for index in range(cells):
            cell = begin + self._number(table + 2 * index, 2)
            if kind == _LEAF:
                yield self._row(cell)
            else:
                yield from self.rows(self._number(cell, 4))
        if kind == _INTERIOR:
            yield from self.rows(self._number(head + 8, 4))

    def _row(self, cell: int) -> tuple[int, list[Place], int]:
        size, at = self._varint(cell)
        number, at = self._varint(at)
        usable = self._page
        local = size
        if size > usable - 35:
            least = (usable - 12) * 32 // 255 - 23
            local = least + (size - least) % (usable - 4)
            if local > usable - 35:
                local = least
        places = [Place(at, local, False)]
        if local < size:
            places += self._chain(self._number(at + local, 4), size - local)
        return number, places, size

    def _chain(self, page: int, rest: int) -> list[Place]:
        """Give the runs of successive pages that hold the rest of a record."""
        pages = []
        held = self._page - _NEXT
        last = rest % held or held
        while rest > 0:
            pages.append(page)
            page = self._number((page - 1) * self._page, _NEXT)
            rest -= held
        starts = [0, *(i + 1 for i, (a, b) in enumerate(pairwise(pages)) if b != a + 1)]
        ends = [*starts[1:], len(pages)]
        places = []
        for start, end in zip(starts, ends, strict=True):
            size = (end - start) * self._page
            if end == len(pages):
                size += _NEXT + last - self._page
            places.append(Place((pages[start] - 1) * self._page, size, True))
        return places

    def _number(self, at: int, size: int) -> int:
        return int.from_bytes(self._data[at : at + size], "big")

    def _varint(self, at: int) -> tuple[int, int]:
        value = 0
        for index in range(8):
            byte = self._data[at + index]
            value = value << 7 | byte & 0x7F
            if byte < 0x80:
                return value, at + index + 1
        return value << 8 | self._data[at + 8], at + 9


def mapped(file: Path) -> mmap.mmap:
    """Give the bytes of a file as they are asked for."""
    with file.open("rb") as stream:
        return mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)


def last_values(
    connection: sqlite3.Connection, file: Path, table: str, sizes: dict[int, int]
) -> dict[int, list[Place]]:
    """Give where the last bytes of rows stand, so many of each row; columns stand in order."""
    page: int = connection.execute("PRAGMA page_size").fetchone()[0]
    root = connection.execute(
        "SELECT rootpage FROM sqlite_schema WHERE type = 'table' AND name = ?", [table]
    ).fetchone()[0]
    found = {}
    for number, places, size in Pages(file, page).rows(root):
        if number in sizes:
            before = size - sizes[number]
            local = places[0]
            cut = min(before, local.size)
            first = Place(local.begin + cut, local.size - cut, False)
            found[number] = [place for place in [first, *places[1:]] if place.size]
    return found


def joined(parts: Sequence[bytes], places: Sequence[Place], size: int, page: int) -> bytes:
    """Give a value of so many bytes of what stands at its places."""
    pieces: list[bytes] = []
    for part, place in zip(parts, places, strict=True):
        if len(part) != place.size:
            raise CorruptError(
                "cut short",
                offset=place.begin,
                expected=f"{place.size} bytes",
                found=str(len(part)),
            )
        if place.chained:
            pieces += [part[at + _NEXT : at + page] for at in range(0, len(part), page)]
        else:
            pieces.append(part)
    return b"".join(pieces)[-size:] if size else b""
