"""Templates of rows: the bytes around numbers, and how numbers fill their places."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from mocapress.motion.number_format import NumberFormat

Slot = tuple[int, int, int]
"""A number in a row's bytes: its column (-1: the frame's number), where it begins and ends."""
Row = tuple[bytes, list[Slot]]
"""A row's bytes, and its numbers."""

BLANK_SIGN = 128
"""The width that says: a blank where there is no sign. Above it: padded on the right."""
_ROWS_COMPARED = 16


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
    """Of each slot: 0 as it is, to 127 padded on the left to this width, 128 a blank where there is
    no sign, above padded on the right to the width less 128."""
    counter_width: int = 0
    """To which zeros pad the frame's number."""

    def as_tuple(self) -> tuple[bool, list[bytes], list[int], list[int], int]:
        """Give it as the compiled core takes it."""
        literals, columns, widths = list(self.literals), list(self.columns), list(self.widths)
        return self.counter, literals, columns, widths, self.counter_width


def templates_of(rows: Iterator[Row], formats: Sequence[NumberFormat]) -> Iterator[RowTemplate]:
    """Give templates by which rows may be written, the first of them for certain one of them.

    Those of numbers that are padded in some way follow from another row whose numbers are longer or
    shorter, where one of the next has such.
    """
    first = next(rows)
    plain = _plain(first, formats)
    for row in islice(rows, _ROWS_COMPARED):
        other = _plain(row, formats)
        if other.literals == plain.literals or len(other.literals) != len(plain.literals):
            yield plain
            continue
        for padded in (_right, _signed, _left):
            template = padded(plain, first, other, row)
            if template is not None:
                yield template
        break
    yield plain


def _plain(row: Row, formats: Sequence[NumberFormat]) -> RowTemplate:
    text, slots = row
    ends = [0, *(end for _, _, end in slots)]
    starts = [*(start for _, start, _ in slots), len(text)]
    columns = tuple(column for column, _, _ in slots if column >= 0)
    counter = len(columns) < len(slots)
    lengths = [end - start for _, start, end in slots[counter:]]
    number = text[slots[0][1] : slots[0][2]] if counter else b""
    padded = number.lstrip(b"-").startswith(b"0") and number != b"0"
    return RowTemplate(
        counter,
        tuple(text[end:start] for end, start in zip(ends, starts, strict=True)),
        columns,
        tuple(
            min(length, BLANK_SIGN - 1) if formats[column].zeros else 0
            for column, length in zip(columns, lengths, strict=True)
        ),
        min(len(number), 127) if padded else 0,
    )


def _of(plain: RowTemplate, literals: list[bytes], widths: list[int]) -> RowTemplate:
    return RowTemplate(
        plain.counter, tuple(literals), plain.columns, tuple(widths), plain.counter_width
    )


def _numbers(plain: RowTemplate, row: Row) -> list[bytes]:
    return [row[0][start:end] for _, start, end in row[1][plain.counter :]]


def _right(plain: RowTemplate, first: Row, other: RowTemplate, row: Row) -> RowTemplate | None:
    """Read two rows as numbers padded on the left to fixed widths, where they can be read so."""
    literals, widths = list(plain.literals), []
    pairs = zip(_numbers(plain, first), _numbers(plain, row), strict=True)
    for k, (mine, others) in enumerate(pairs, plain.counter):
        kept = literals[k].rstrip(b" ")
        width = len(literals[k]) - len(kept) + len(mine)
        theirs = len(other.literals[k]) - len(other.literals[k].rstrip(b" ")) + len(others)
        if width != theirs or not 0 < width < BLANK_SIGN:
            return None
        # The width may take in the one separating blank; what is left of it stays a literal.
        literals[k] = kept
        widths.append(width)
    return _of(plain, literals, widths)


def _signed(plain: RowTemplate, first: Row, other: RowTemplate, row: Row) -> RowTemplate | None:
    """Read two rows as numbers with a sign or a blank before them."""
    made = []
    for template, own in ((plain, first), (other, row)):
        literals = list(template.literals)
        for k, number in enumerate(_numbers(plain, own), plain.counter):
            if number[:1] not in b"+-" and literals[k].endswith(b" "):
                literals[k] = literals[k][:-1]
        made.append(literals)
    return _of(plain, made[0], [BLANK_SIGN] * len(plain.columns)) if made[0] == made[1] else None


def _left(plain: RowTemplate, first: Row, other: RowTemplate, row: Row) -> RowTemplate | None:
    """Read two rows as numbers padded on the right to fixed widths."""
    literals, widths = list(plain.literals), []
    pairs = zip(_numbers(plain, first), _numbers(plain, row), strict=True)
    for k, (mine, others) in enumerate(pairs, plain.counter + 1):
        kept = literals[k].lstrip(b" ")
        width = len(literals[k]) - len(kept) + len(mine)
        theirs = len(other.literals[k]) - len(other.literals[k].lstrip(b" ")) + len(others)
        if width != theirs or width >= BLANK_SIGN:
            return None
        literals[k] = kept
        widths.append(BLANK_SIGN + width)
    return _of(plain, literals, widths)
