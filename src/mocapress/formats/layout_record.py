"""A layout as bytes: docs/format/layout.md."""

from array import array

import numpy as np

from mocapress.errors import CorruptError
from mocapress.formats.header_pattern import pattern_of
from mocapress.formats.layout import MOST_TEMPLATES, Layout
from mocapress.formats.number_formats import read_format, record_of
from mocapress.formats.patterns import (
    BREAK,
    COUNT,
    MOST_FORMATS,
    NAME,
    VALUE,
    References,
    Style,
    encoded,
    pieces,
    print_header,
    raw,
)
from mocapress.formats.row_templates import RowTemplate
from mocapress.motion.number_format import NumberFormat
from mocapress.records import Reader, Writer

_COUNTED, _UTF8 = 1, 2
_ENCODINGS = {"": 0, "utf-16-le": 4, "utf-16-be": 8}
_COLUMNS, _WIDTHS, _COUNTER_WIDTH = 1, 2, 4


def write_layout(layout: Layout, references: References) -> bytes:
    """Give the layout of a file whose head says what is referred to."""
    counted = any(template.counter for template in layout.templates)
    pattern, style = pattern_of(layout, references)
    writer = Writer()
    names = _UTF8 * (style.encoding == "utf-8")
    writer.integer(_COUNTED * counted | names | _ENCODINGS[layout.encoding])
    writer.bytes(style.line_break)
    writer.bytes(style.indentation)
    writer.integer(len(style.formats))
    for number_format in style.formats:
        writer.data += record_of(number_format)
    writer.bytes(pattern)
    writer.bytes(layout.tail)
    writer.integer(len(layout.templates))
    for template in layout.templates:
        _write_template(writer, template, references, style, len(layout.formats))
    writer.runs(layout.assigned.astype(np.int64) + 1)
    if counted:
        steps = np.diff(layout.counters, prepend=0)
        writer.runs(np.where(steps >= 0, steps << 1, (-steps << 1) - 1))
    writer.integer(len(layout.cells))
    last = 0
    for row_index, slot, text in zip(
        layout.cell_rows.tolist(), layout.cell_slots.tolist(), layout.cells, strict=True
    ):
        writer.integer(row_index - last)
        writer.integer(slot)
        writer.bytes(text)
        last = row_index
    for row_bytes in layout.raw_rows:
        writer.bytes(row_bytes)
    return bytes(writer.data)


def read_layout(
    data: bytes,
    kind: str,
    frames: int,
    formats: tuple[NumberFormat, ...],
    references: References,
    most: int,
    rows_printed: int | None = None,
) -> Layout:
    """Read a layout.

    Parameters
    ----------
    data
        What ``write_layout`` gave.
    kind
        Id of the file's format.
    frames, formats
        Of the first stream.
    references
        What the layout may refer to.
    most
        Bytes that the file may have.
    rows_printed
        How many rows the header is to announce, where some of them are lost.

    Raises
    ------
    CorruptError
        When the bytes are not a layout, or refer to what is not there.

    """
    reader = Reader(data, "layout")
    flags = reader.integer(15)
    of_file = {code: name for name, code in _ENCODINGS.items()}.get(flags & 12)
    if of_file is None:
        raise reader.fail("a text in two encodings")
    most = 2 * most if of_file else most
    line_break, indentation = reader.bytes(), reader.bytes()
    of_header = tuple(read_format(reader) for _ in range(reader.integer(MOST_FORMATS)))
    encoding = "utf-8" if flags & _UTF8 else "latin-1"
    style = Style(line_break, indentation, encoding, of_header)
    pattern, tail = reader.bytes(), reader.bytes()
    counted = bool(flags & _COUNTED)
    room = _Room(most)
    templates = tuple(
        _read_template(reader, len(formats), references, style, counted, room)
        for _ in range(reader.integer(MOST_TEMPLATES))
    )
    assigned = reader.runs(frames, len(templates)) - 1
    counters = np.empty(0, np.int64)
    if counted:
        zigzag = reader.runs(frames, 2**62)
        counters = np.cumsum(np.where(zigzag & 1, -((zigzag + 1) >> 1), zigzag >> 1))
    # Compact, and equal texts once: a cell that is stored in three bytes must not cost a hundred.
    rows, slots, texts = array("Q"), array("I"), []
    known: dict[bytes, bytes] = {}
    row = 0
    for _ in range(reader.integer(min(reader.left // 3, frames * (len(formats) + 1)))):
        row += reader.integer(frames)
        rows.append(row)
        slots.append(reader.integer(2**32 - 1))
        text = reader.bytes()
        texts.append(known.setdefault(text, text))
    if row and row >= frames:
        raise reader.fail("a number outside the rows")
    raw_rows = tuple(reader.bytes() for _ in range(int((assigned < 0).sum())))
    reader.end()
    announced = frames if rows_printed is None else rows_printed
    return Layout(
        kind,
        print_header(pattern, references, style, announced, most),
        tail,
        formats,
        templates,
        assigned.astype(np.int32),
        counters.astype(np.int64),
        np.array(rows, np.uint64),
        np.array(slots, np.uint32),
        tuple(texts),
        raw_rows,
        of_file,
    )


class _Room:
    """How many bytes the literals of all templates may still have."""

    def __init__(self, most: int) -> None:
        self.left = most

    def take(self, count: int) -> None:
        self.left -= count
        if self.left < 0:
            raise CorruptError("layout: longer row templates than may be")


def _write_template(
    writer: Writer, template: RowTemplate, references: References, style: Style, columns: int
) -> None:
    in_order = template.columns == tuple(range(columns))
    padded = any(template.widths)
    writer.integer(
        _COLUMNS * (not in_order) | _WIDTHS * padded | _COUNTER_WIDTH * bool(template.counter_width)
    )
    slots = [-1] * template.counter + list(template.columns)
    pattern = bytearray()
    for slot, literal in zip(slots, template.literals, strict=False):
        bone = references.bones[slot] if slot >= 0 and references.bones else ""
        before, name, behind = b"", b"", literal
        if bone:
            before, name, behind = literal.rpartition(encoded(bone, style.encoding))
        pattern += _row_text(before, style) + bytes([NAME] * bool(name)) + _row_text(behind, style)
        pattern.append(VALUE if slot >= 0 else COUNT)
    pattern += _row_text(template.literals[-1], style)
    writer.bytes(bytes(pattern))
    if not in_order:
        writer.integer(len(template.columns))
        expected = 0
        for column in template.columns:
            writer.signed(column - expected)
            expected = column + 1
    if padded:
        writer.data += bytes(template.widths)
    if template.counter_width:
        writer.data.append(template.counter_width)


def _row_text(text: bytes, style: Style) -> bytes:
    return bytes([BREAK]).join(raw(part) for part in text.split(style.line_break))


def _read_template(
    reader: Reader,
    columns: int,
    references: References,
    style: Style,
    counted: bool,
    room: _Room,
) -> RowTemplate:
    flags = reader.integer(_COLUMNS | _WIDTHS | _COUNTER_WIDTH)
    pattern = reader.bytes()
    of_slots = list(range(columns))
    if flags & _COLUMNS:
        of_slots = []
        expected = 0
        for _ in range(reader.count(1)):
            column = expected + reader.signed()
            if not 0 <= column < columns:
                raise reader.fail("a number without a column")
            of_slots.append(column)
            expected = column + 1
    widths = tuple(reader.raw(len(of_slots))) if flags & _WIDTHS else (0,) * len(of_slots)
    counter_width = reader.raw(1)[0] if flags & _COUNTER_WIDTH else 0
    slots = [-1] * counted + of_slots
    texts, codes = pieces(pattern)
    literals = [bytearray(texts[0])]
    for code, text in zip(codes, texts[1:], strict=True):
        at = len(literals) - 1
        if code == BREAK:
            literals[-1] += style.line_break + text
        elif code == NAME and at < len(slots) and slots[at] >= 0 and references.bones:
            literals[-1] += encoded(references.bones[slots[at]], style.encoding) + text
        elif code in (VALUE, COUNT) and at < len(slots) and (slots[at] >= 0) == (code == VALUE):
            room.take(len(literals[-1]))
            literals.append(bytearray(text))
        else:
            raise reader.fail("a row's pattern refers to what is not there")
        if len(literals[-1]) > room.left:
            raise reader.fail("longer row templates than may be")
    if len(literals) != len(slots) + 1:
        raise reader.fail("a row of another number of values")
    return RowTemplate(counted, tuple(map(bytes, literals)), tuple(of_slots), widths, counter_width)
