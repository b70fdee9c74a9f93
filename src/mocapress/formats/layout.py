"""Everything of a motion file that is not a number, so that bytes come back as they were.

Taking a file apart is each format's own; here is what they share: templates of rows, the numbers
that are not written as their column is, and the way back to bytes.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import compress, islice

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError
from mocapress.formats.encodings import FileText, encoded
from mocapress.formats.number_formats import SHORTEST, packed, unpacked
from mocapress.formats.row_templates import Row, RowTemplate, Slot, templates_of
from mocapress.formats.rows import Body, RowsOf, rows_of
from mocapress.motion.clip import Clip
from mocapress.motion.number_format import NumberFormat

MOST_TEMPLATES = 64
_PIECE = 2**16
"""Numbers that are printed together."""
_MOST_COUNTER = 2**59
# Of how many rows the texts are looked at to find formats.
_SAMPLE = 48
# A template that leaves fewer numbers than one in so many written otherwise is good enough.
_FEW = 50


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """A file without its numbers."""

    format: str
    """Its id."""
    header: bytes
    """Up to the first row, verbatim."""
    tail: bytes
    """Behind the last row, verbatim."""
    formats: tuple[NumberFormat, ...]
    """One per column."""
    templates: tuple[RowTemplate, ...]
    assigned: NDArray[np.int32]
    """(F,) the template of each row, -1 for rows kept verbatim."""
    counters: NDArray[np.int64]
    """(F,) frame numbers, (0,) where the format has none."""
    cell_rows: NDArray[np.uint64]
    cell_slots: NDArray[np.uint32]
    cells: tuple[bytes, ...]
    """Numbers written otherwise than their column: row, slot, text; sorted."""
    raw_rows: tuple[bytes, ...]
    """Rows kept verbatim, in order."""
    encoding: str = ""
    """``utf-16-le`` or ``utf-16-be``, after a byte order mark, where the text is not bytes as they
    are but UTF-8 of such a file."""

    def verbatim_bytes(self) -> int:
        """Give how many bytes of the body are kept as they are."""
        return sum(map(len, self.cells)) + sum(map(len, self.raw_rows))

    def join(self, values: NDArray[np.float64], most_bytes: int = 2**62) -> bytes:
        """Give the file's bytes from all rows of values, (F, C).

        Raises
        ------
        CorruptError
            When more than ``most_bytes`` would come out.

        """
        if values.shape != (len(self.assigned), len(self.formats)):
            raise CorruptError(
                "values do not fit the layout",
                expected=f"{len(self.assigned)} x {len(self.formats)}",
                found=f"{values.shape[0]} x {values.shape[1]}",
            )
        return b"".join(self.pieces(rows_of([values]), most_bytes))

    def pieces(self, rows: RowsOf, most_bytes: int = 2**62) -> Iterator[bytes]:
        """Give the file's bytes one part after the other, asking for rows as they are printed.

        Raises
        ------
        CorruptError
            When more than ``most_bytes`` would come out.

        """
        parts = self._parts(rows, 2 * most_bytes if self.encoding else most_bytes)
        if self.encoding:
            parts = iter((encoded(b"".join(parts), self.encoding),))
        for part in parts:
            most_bytes -= len(part)
            if most_bytes < 0:
                raise CorruptError("the layout makes a longer file than announced")
            yield part

    def _parts(self, rows: RowsOf, most_bytes: int) -> Iterator[bytes]:
        yield self.header
        step = max(_PIECE // max(len(self.formats), 1), 1)
        templates = [template.as_tuple() for template in self.templates]
        formats, raw = packed(self.formats), iter(self.raw_rows)
        for first in range(0, len(self.assigned), step):
            assigned = self.assigned[first : first + step]
            last = first + len(assigned)
            low, high = np.searchsorted(self.cell_rows, [first, last])
            part: bytes = _core.print_rows(
                np.ascontiguousarray(rows(0, first, last)),
                self.counters[first:last],
                assigned,
                templates,
                formats,
                self.cell_rows[low:high] - np.uint64(first),
                self.cell_slots[low:high],
                list(self.cells[low:high]),
                list(islice(raw, int((assigned < 0).sum()))),
                most_bytes,
            )
            most_bytes = max(most_bytes - len(part), 0)
            yield part
        yield self.tail

    def of_other_numbers(self, values: NDArray[np.float64]) -> "Layout":
        """Give the layout for other numbers than these, (F, C).

        They are printed as their columns are; what is no number stays as it is written.
        """
        columns = [
            self.templates[self.assigned[row]].columns[slot]
            for row, slot in zip(self.cell_rows.tolist(), self.cell_slots.tolist(), strict=True)
        ]
        keep = ~np.isfinite(values[self.cell_rows.astype(np.int64), columns])
        return replace(
            self,
            cell_rows=self.cell_rows[keep],
            cell_slots=self.cell_slots[keep],
            cells=tuple(compress(self.cells, keep)),
        )

    def rows(self, keep: NDArray[np.bool_]) -> "Layout":
        """Give the layout of those rows alone that are to be kept, (F,)."""
        cells = keep[self.cell_rows.astype(np.int64)]
        raw = keep[self.assigned < 0]
        return replace(
            self,
            assigned=self.assigned[keep],
            counters=self.counters[keep] if len(self.counters) else self.counters,
            cell_rows=(np.cumsum(keep) - 1)[self.cell_rows[cells].astype(np.int64)].astype(
                np.uint64
            ),
            cell_slots=self.cell_slots[cells],
            cells=tuple(compress(self.cells, cells)),
            raw_rows=tuple(compress(self.raw_rows, raw)),
        )


NO_ROWS = Layout(
    "",
    b"",
    b"",
    (),
    (),
    np.empty(0, np.int32),
    np.empty(0, np.int64),
    np.empty(0, np.uint64),
    np.empty(0, np.uint32),
    (),
    (),
)
"""The layout of no text."""


def build(
    kind: str,
    file: FileText | bytes,
    body: Body,
    slots_of_row: Callable[[bytes], list[Slot]],
    places_of_rows: Callable[[NDArray[np.int64]], NDArray[np.int64]] | None = None,
) -> Layout:
    """Find the layout of a file whose rows are read.

    Parameters
    ----------
    kind, file, body
        Id of the format, the file and its rows.
    slots_of_row
        Gives where the numbers of a row's bytes stand, in order.
    places_of_rows
        Gives where the numbers of some rows stand in the file, (R, C, 2) begin and end, or -1;
        by default ``slots_of_row`` is asked.

    """
    data, encoding = file if isinstance(file, FileText) else (file, "")
    offsets = body.offsets.astype(np.int64)
    slots: dict[int, Row] = {}

    def row(index: int) -> Row:
        if index not in slots:
            text = data[offsets[index] : offsets[index + 1]]
            slots[index] = text, slots_of_row(text)
        return slots[index]

    def places_by_slots(rows: NDArray[np.int64]) -> NDArray[np.int64]:
        places = np.full((len(rows), body.values.shape[1], 2), -1, np.int64)
        for found, index in zip(places, rows.tolist(), strict=True):
            for column, begin, end in row(index)[1]:
                if column >= 0:
                    found[column] = offsets[index] + begin, offsets[index] + end
        return places

    frames = len(body.values)
    # Steps between frame numbers have a limit in files; a row of a number beyond it stays a text.
    absurd = (body.counters > _MOST_COUNTER) | (body.counters < -_MOST_COUNTER)
    counters = np.where(absurd, 0, body.counters)
    pending = np.setdiff1d(np.arange(frames), [*body.unread, *np.flatnonzero(absurd)])
    some = np.linspace(0, len(pending) - 1, min(len(pending), _SAMPLE)).astype(np.int64)
    sample = pending[np.unique(some)]
    places = (places_of_rows or places_by_slots)(sample)
    coded = _core.detect_formats(data, body.statistics, body.values[sample], places)
    formats = unpacked(coded)

    templates: list[RowTemplate] = []
    assigned = np.full(frames, -1, np.int32)
    cells: list[tuple[int, int, bytes]] = []
    while len(pending) and len(templates) < MOST_TEMPLATES:
        best = None
        numbers = len(pending) * body.values.shape[1]
        for template in templates_of(map(row, pending.tolist()), formats):
            matched, rows, at, found = _core.match_rows(
                data,
                body.offsets,
                counters,
                body.values,
                pending,
                template.as_tuple(),
                coded,
            )
            score = int(matched.sum()) * body.values.shape[1] - len(found)
            if matched.any() and (best is None or score > best[0]):
                best = score, template, matched, rows, at, found
            if score >= numbers - numbers // _FEW:
                break
        if best is None:
            break
        _, template, matched, rows, at, found = best
        assigned[pending[matched == 1]] = len(templates)
        templates.append(template)
        cells += zip(rows.tolist(), at.tolist(), found, strict=True)
        pending = pending[matched == 0]
    cells.sort(key=lambda cell: cell[:2])
    return Layout(
        kind,
        data[: offsets[0]],
        data[offsets[-1] :],
        formats,
        tuple(templates),
        assigned,
        counters,
        np.array([cell[0] for cell in cells], np.uint64),
        np.array([cell[1] for cell in cells], np.uint32),
        tuple(cell[2] for cell in cells),
        tuple(row(index)[0] for index in np.flatnonzero(assigned < 0).tolist()),
        encoding,
    )


def print_clip(clip: Clip, header: bytes, literals: Sequence[bytes], *, counter: bool) -> bytes:
    """Print a clip with all rows alike; numbers in their columns' formats, else the fewest digits.

    Parameters
    ----------
    clip
        Its columns are those of the format, in the order of the rows.
    header
        What stands before the first row.
    literals
        The bytes before, between and behind a row's numbers.
    counter
        Whether each row begins with the frame's number, from 1.

    """
    unpadded = (0,) * clip.channels
    layout = Layout(
        "",
        header,
        b"",
        tuple(column.decimal or SHORTEST for column in clip.columns),
        (RowTemplate(counter, tuple(literals), tuple(range(clip.channels)), unpadded),),
        np.zeros(clip.frames, np.int32),
        np.arange(1, clip.frames + 1) if counter else np.empty(0, np.int64),
        np.empty(0, np.uint64),
        np.empty(0, np.uint32),
        (),
        (),
    )
    return layout.join(clip.values)
