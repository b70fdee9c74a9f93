"""The codec ``exact`` (docs/format/exact.md): its header, and what the chunks' columns become."""

import struct
from dataclasses import dataclass

import exact_fast
import exact_model
from lines import Line
from records import CorruptError, Record, unzigzag
from streams import Coded

PREDICTED, CONSTANT, COPY, NOISE = range(4)
JOINT, MIDDLE = 5, (6, 7)
TOGETHER = 1024


@dataclass
class Column:
    """What the coder is told of a column."""

    line: Line
    noise: bool
    unit: float
    """From numbers to levels, a power of two."""
    turns: int
    place: int | None
    """Among the channels of the known skeleton."""
    start: list[float]
    """What it begins with, learned from other clips."""


@dataclass
class Coupling:
    """Columns that follow from others in the same frame."""

    kind: int
    sources: list[int]
    targets: list[int]
    parameters: list[int]

    def ordered(self) -> list[int]:
        """Give the columns that are coded in this order."""
        if self.kind == 0:
            return []
        if self.kind == JOINT:
            return self.sources + self.targets
        return (self.sources[3:] if self.kind in MIDDLE else []) + self.targets


# The couplings that the known skeleton may have, in the order of their bits.
CMU = (
    Coupling(1, [6, 7, 8, 9, 10, 11], [13, 12, 14], []),
    Coupling(6, [6, 7, 8, 9, 11], [10], []),
    Coupling(2, [15, 16, 17, 18, 19, 20], [22, 21, 23], []),
    Coupling(7, [15, 16, 17, 18, 20], [19], []),
    Coupling(4, [31, 32], [34, 35], []),
    Coupling(3, [43, 44], [46, 47], []),
)
# Sources and targets of laws whose joints stand one behind the other.
CHAIN, THUMB, MIDDLE_JOINT = ([*range(6)], [7, 6, 8]), ([0, 1], [2, 3]), ([0, 1, 2, 3, 5], [4])
LAWS = {1: CHAIN, 2: CHAIN, 3: THUMB, 4: THUMB, 6: MIDDLE_JOINT, 7: MIDDLE_JOINT}


def read_coupling(record: Record) -> Coupling:
    """Take a coupling of any columns."""
    kind, listed = divmod(record.integer(), 2)
    parameters: list[int] = []
    if kind == 0:
        count, more = record.integer(), record.integer()
        sources, targets = [*range(count)], [*range(count, count + more)]
    elif kind == JOINT:
        told, given = divmod(record.integer(), 32)
        told, bits = divmod(told, 11)
        shape, two = divmod(told, 2)
        numbers = [record.signed() if given >> i & 1 else 0 for i in range(5)]
        parameters = [shape, 4 * bits, *numbers]
        source, target = divmod(shape // 27 % 9, 3)
        sources, targets = [source, 3 - source - target][: 1 + two], [target]
    else:
        sources, targets = LAWS[kind]
    if listed:
        sources, targets = ([record.integer() for _ in side] for side in (sources, targets))
    else:
        first = record.integer()
        sources, targets = ([first + c for c in side] for side in (sources, targets))
    return Coupling(kind, sources, targets, parameters)


def palette(record: Record, count: int) -> list[int]:
    """Take a list of so many numbers of which few differ."""
    numbers = [record.integer() for _ in range(record.integer())]
    return [numbers[index] for index in palette_indices(record, count, len(numbers))]


def palette_indices(record: Record, count: int, size: int) -> list[int]:
    """Take which numbers of a palette of some size follow each other."""
    indices = [0] * count if size < 2 else list[int]()
    while len(indices) < count:
        times, index = divmod(record.integer(), size)
        indices += [index] * (times or count - len(indices))
    return indices


class Header:
    """The codec header."""

    def __init__(self, data: bytes, count: int) -> None:
        record = Record(data)
        flags = record.integer()
        self.trained, self.skeleton = flags & 1 == 1, flags // 4
        codes = palette(record, count)
        self.roles = [code % 4 for code in codes]
        self.turns = [code // 4 for code in codes]
        moving = [c for c, role in enumerate(self.roles) if role in (PREDICTED, NOISE)]
        lines = [Line(*divmod(code, 32)) for code in palette(record, len(moving))]
        self.lines = dict(zip(moving, lines, strict=True))
        predicted, copies, constants = map(self.of, (PREDICTED, COPY, CONSTANT))
        steps = palette(record, len(predicted))
        self.exponents = {c: 8 * unzigzag(step) for c, step in zip(predicted, steps, strict=True)}
        back = palette(record, len(copies))
        self.originals = {c: c - 1 - own for c, own in zip(copies, back, strict=True)}
        numbers = record.numbers(size) if (size := record.integer()) else []
        indices = palette_indices(record, len(constants), size)
        self.constants = {c: numbers[i] for c, i in zip(constants, indices, strict=True)}
        if flags & 2:
            used = record.integer()
            self.couplings = [own for i, own in enumerate(CMU) if used >> i & 1]
        else:
            self.couplings = [read_coupling(record) for _ in range(record.integer())]
        record.end()

    def of(self, role: int) -> list[int]:
        """Give the columns of a role."""
        return [c for c, own in enumerate(self.roles) if own == role]

    def coded(self) -> list[int]:
        """Give the columns of the chunks, in the order of coding."""
        columns = self.of(PREDICTED) + self.of(NOISE)
        for coupling in self.couplings:
            moved = coupling.ordered()
            places = sorted(columns.index(column) for column in moved)
            for place, column in zip(places, moved, strict=True):
                columns[place] = column
        return columns

    def column(self, c: int, start: list[float]) -> Column:
        """Give a column as the coder wants it."""
        noise, unit = self.roles[c] == NOISE, 2.0 ** self.exponents.get(c, 0)
        return Column(
            self.lines[c], noise, unit, self.turns[c], c if self.skeleton else None, start
        )


def decode(
    header: bytes,
    parameters: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
    model: bytes | None = None,
) -> list[list[float]]:
    """Give the rows of chunks; of the number formats, only how many there are counts."""
    level = int(parameters.get("level", "6"))
    head = Header(header, len(formats))
    if head.trained and model is None:
        raise CorruptError("decoding needs the model that the file names")
    shared, starts = read_model(model) if model else ([], {})
    coded = head.coded()
    columns = [head.column(c, starts.get(c, [])) for c in coded]
    couplings = [
        Coupling(
            own.kind,
            [coded.index(c) for c in own.sources],
            sorted(coded.index(c) for c in own.targets),
            own.parameters,
        )
        for own in head.couplings
    ]
    rows = []
    for frames, payload in chunks:
        for numbers in chunk_rows(payload, frames, columns, couplings, level, shared):
            values = head.constants | dict(zip(coded, numbers, strict=True))
            values.update((c, values[original]) for c, original in head.originals.items())
            rows.append([values[c] for c in range(len(formats))])
    return rows


def chunk_rows(
    payload: bytes,
    frames: int,
    columns: list[Column],
    couplings: list[Coupling],
    level: int,
    shared: list[float],
) -> list[list[float]]:
    """Decode a chunk."""
    if not columns:
        return [[] for _ in range(frames)]
    if level <= 2:
        return exact_fast.decode(payload, frames, columns, level)
    stream = Coded(payload)
    rows: list[list[float]] = [[] for _ in range(frames)]
    for start in range(0, len(columns), TOGETHER):
        part = columns[start : start + TOGETHER]
        inside = within(couplings, start, start + len(part))
        model = exact_model.Model(stream, part, inside, level, shared)
        for row in rows:
            row += model.next_frame()
    stream.end()
    return rows


def within(couplings: list[Coupling], start: int, end: int) -> list[Coupling]:
    """Give the couplings that lie within some columns, as counted from the first of these."""
    own = [c for c in couplings if all(start <= i < end for i in c.sources + c.targets)]
    return [
        Coupling(
            c.kind, [i - start for i in c.sources], [i - start for i in c.targets], c.parameters
        )
        for c in own
    ]


def read_model(payload: bytes) -> tuple[list[float], dict[int, list[float]]]:
    """Read what was learned from other clips: by all columns, and by each."""
    record = Record(payload)

    def numbers() -> list[float]:
        return [number for (number,) in struct.iter_unpack("<f", record.bytes())]

    shared = numbers()
    columns = {}
    for _ in range(record.integer()):
        column = record.integer()
        columns[column] = numbers()
    record.end()
    return shared, columns
