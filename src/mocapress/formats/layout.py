"""Everything of a motion file that is not a number, so that bytes come back as they were.

Taking a file apart is each format's own; here is what they share: templates of rows, the numbers
that are not written as their column is, and the way back to bytes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError
from mocapress.formats.number_formats import SHORTEST, detect, packed
from mocapress.formats.rows import Body
from mocapress.motion.clip import Clip
from mocapress.motion.number_format import NumberFormat

MOST_TEMPLATES = 64
# Of how many rows the texts are looked at to find formats.
_SAMPLE = 48

Slot = tuple[int, int, int]
"""A number in a row's bytes: its column (-1: the frame's number), where it begins and ends."""


@dataclass(frozen=True, slots=True)
class RowTemplate:
    """The bytes of one kind of row around its numbers."""

    counter: bool
    """Whether the first slot is the frame's number."""
    literals: tuple[bytes, ...]
    """One before every slot and one behind the last."""
    columns: tuple[int, ...]
    """Column of each slot."""
    widths: tuple[int, ...]
    """Width to which a slot's number is padded on the left, 0 for none."""

    def as_tuple(self) -> tuple[bool, list[bytes], list[int], list[int]]:
        """Give it as the compiled core takes it."""
        return self.counter, list(self.literals), list(self.columns), list(self.widths)


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
        body: bytes = _core.print_rows(
            np.ascontiguousarray(values),
            self.counters,
            self.assigned,
            [template.as_tuple() for template in self.templates],
            packed(self.formats),
            self.cell_rows,
            self.cell_slots,
            list(self.cells),
            list(self.raw_rows),
            most_bytes,
        )
        if len(self.header) + len(body) + len(self.tail) > most_bytes:
            raise CorruptError("the layout makes a longer file than announced")
        return self.header + body + self.tail

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
    data: bytes,
    body: Body,
    slots_of_row: Callable[[bytes], list[Slot]],
) -> Layout:
    """Find the layout of a file whose rows are read.

    Parameters
    ----------
    kind, data, body
        Id of the format, the file and its rows.
    slots_of_row
        Gives where the numbers of a row's bytes stand, in order.

    """
    offsets = body.offsets.astype(np.int64)
    slots: dict[int, tuple[bytes, list[Slot]]] = {}

    def row(index: int) -> tuple[bytes, list[Slot]]:
        if index not in slots:
            text = data[offsets[index] : offsets[index + 1]]
            slots[index] = text, slots_of_row(text)
        return slots[index]

    frames = len(body.values)
    pending = np.setdiff1d(np.arange(frames), body.unread)
    places = np.linspace(0, len(pending) - 1, min(len(pending), _SAMPLE)).astype(np.int64)
    sample = pending[np.unique(places)]

    def texts_of(index: int) -> Sequence[bytes | None]:
        text, numbers = row(index)
        places = {column: text[start:end] for column, start, end in numbers}
        return [places.get(column) for column in range(body.values.shape[1])]

    texts = [texts_of(index) for index in sample.tolist()]
    formats = detect(body.statistics, body.values[sample], texts)

    templates: list[RowTemplate] = []
    assigned = np.full(frames, -1, np.int32)
    cells: list[tuple[int, int, bytes]] = []
    while len(pending) and len(templates) < MOST_TEMPLATES:
        first, second = row(int(pending[0])), row(int(pending[min(1, len(pending) - 1)]))
        for template in (_padded_template(first, second), _template(*first)):
            if template is None:
                continue
            matched, rows, at, found = _core.match_rows(
                data,
                body.offsets,
                body.counters,
                body.values,
                pending,
                template.as_tuple(),
                packed(formats),
            )
            if matched.any():
                break
        if template is None or not matched.any():
            break
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
        body.counters,
        np.array([cell[0] for cell in cells], np.uint64),
        np.array([cell[1] for cell in cells], np.uint32),
        tuple(cell[2] for cell in cells),
        tuple(row(index)[0] for index in np.flatnonzero(assigned < 0).tolist()),
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


def _template(text: bytes, slots: list[Slot]) -> RowTemplate:
    ends = [0, *(end for _, _, end in slots)]
    starts = [*(start for _, start, _ in slots), len(text)]
    columns = tuple(column for column, _, _ in slots if column >= 0)
    return RowTemplate(
        len(columns) < len(slots),
        tuple(text[end:start] for end, start in zip(ends, starts, strict=True)),
        columns,
        (0,) * len(columns),
    )


def _padded_template(
    first: tuple[bytes, list[Slot]], second: tuple[bytes, list[Slot]]
) -> RowTemplate | None:
    """Read two rows as numbers padded to fixed widths, where they can be read so."""
    template, other = _template(*first), _template(*second)
    if template.literals == other.literals or len(template.literals) != len(other.literals):
        return None
    skip = 1 if template.counter else 0
    literals, widths = list(template.literals), []
    for k in range(len(template.columns)):
        padding, width = _width(template.literals[k + skip], first[1][k + skip])
        _, other_width = _width(other.literals[k + skip], second[1][k + skip])
        if width != other_width or not 0 < width < 256:
            return None
        # The width may take in the one separating blank; what is left of it stays a literal.
        literals[k + skip] = template.literals[k + skip][: len(padding)]
        widths.append(width)
    return RowTemplate(template.counter, tuple(literals), template.columns, tuple(widths))


def _width(literal: bytes, slot: Slot) -> tuple[bytes, int]:
    kept = literal.rstrip(b" ")
    return kept, len(literal) - len(kept) + slot[2] - slot[1]
