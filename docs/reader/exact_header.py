"""The codec header and the model of ``exact`` (docs/format/exact.md)."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace

from exact_laws import Joint
from lines import Line
from records import CorruptError, Record, unzigzag

PREDICTED, CONSTANT, COPY, NOISE = range(4)
# Kind, sources and targets of the known skeleton's own couplings.
OWN_COUPLINGS: list[tuple[int, list[int], list[int]]] = [
    (1, [6, 7, 8, 9, 10, 11], [13, 12, 14]),
    (6, [6, 7, 8, 9, 11], [10]),
    (2, [15, 16, 17, 18, 19, 20], [22, 21, 23]),
    (7, [15, 16, 17, 18, 20], [19]),
    (4, [31, 32], [34, 35]),
    (3, [43, 44], [46, 47]),
]
# Of laws: sources and targets, counted from their first column.
CHAIN: tuple[Sequence[int], Sequence[int]] = (range(6), (7, 6, 8))
THUMB, MIDDLE = (range(2), (2, 3)), ((0, 1, 2, 3, 5), (4,))
SHAPES = {1: CHAIN, 2: CHAIN, 3: THUMB, 4: THUMB, 6: MIDDLE, 7: MIDDLE}


@dataclass
class Column:
    """A column that is coded."""

    line: Line
    place: int = 0
    """Which column of the clip it is."""
    noise: bool = False
    unit: float = 1.0
    """2^exponent."""
    turns: int = 0


@dataclass
class Coupling:
    """Columns of which some tell others."""

    kind: int
    sources: list[int]
    targets: list[int]
    joint: Joint | None = None

    def counted(self, at: dict[int, int]) -> "Coupling":
        """Give the same by other numbers of the columns."""
        sources, targets = [at[c] for c in self.sources], sorted(at[c] for c in self.targets)
        return replace(self, sources=sources, targets=targets)

    def ordered(self) -> list[int]:
        """Order of coding: give the columns that it puts in an order."""
        sources = {0: [], 5: self.sources, 6: self.sources[3:], 7: self.sources[3:]}
        return [*sources.get(self.kind, []), *(self.targets if self.kind else [])]


class Header:
    """The codec header of so many columns."""

    def __init__(self, record: Record, count: int) -> None:
        flags = record.integer()
        self.skeleton, self.learned = flags >> 3 & 1, flags & 1
        self.level = 5 if flags >> 4 else 0
        """Where it is not that of the parameters."""
        if flags & 4:
            self.level = record.integer() % 10 or 10
        roles = palette(record, count)
        of_role = [[c for c in range(count) if roles[c] % 4 == role] for role in range(4)]
        coded = sorted(of_role[PREDICTED] + of_role[NOISE])
        lines = [Line(*divmod(told, 32)) for told in palette(record, len(coded))]
        columns = {c: Column(line, c) for c, line in zip(coded, lines, strict=True)}
        exponents = palette(record, len(of_role[PREDICTED]))
        for c, exponent in zip(of_role[PREDICTED], exponents, strict=True):
            columns[c].unit, columns[c].turns = 2.0 ** (8 * unzigzag(exponent)), roles[c] // 4
        for c in of_role[NOISE]:
            columns[c].noise = True
        before = palette(record, len(of_role[COPY]))
        self.copies = {c: c - 1 - n for c, n in zip(of_role[COPY], before, strict=True)}
        different = record.integer()
        numbers = record.numbers(different) if different else []
        constant = entries(record, len(of_role[CONSTANT]), different)
        self.constants = {c: numbers[i] for c, i in zip(of_role[CONSTANT], constant, strict=True)}
        couplings = read_couplings(record, own=flags & 2 > 0)
        order = of_role[PREDICTED] + of_role[NOISE]
        for ordered in (coupling.ordered() for coupling in couplings):
            places = sorted(order.index(c) for c in ordered)
            for place, c in zip(places, ordered, strict=True):
                order[place] = c
        self.columns = [columns[c] for c in order]
        """In the order of coding, in which couplings count them."""
        at = {c: place for place, c in enumerate(order)}
        self.couplings = [coupling.counted(at) for coupling in couplings]

    def part(self, start: int, end: int) -> tuple[list[Column], list[Coupling]]:
        """Payload: give the columns of a part and the couplings that it keeps."""
        at = {c: c - start for c in range(start, end)}
        kept = [one for one in self.couplings if {*one.sources, *one.targets} <= at.keys()]
        return self.columns[start:end], [coupling.counted(at) for coupling in kept]

    def row(self, coded: list[float]) -> list[float]:
        """Give all columns of a frame in the order of the file."""
        told = {column.place: x for column, x in zip(self.columns, coded, strict=True)}
        told |= self.constants
        told |= {c: told[original] for c, original in self.copies.items()}
        return [told[c] for c in sorted(told)]


def palette(record: Record, count: int) -> list[int]:
    """Take a palette of so many entries."""
    different = record.integer()
    numbers = [record.integer() for _ in range(different)]
    return [numbers[i] for i in entries(record, count, different)]


def entries(record: Record, count: int, different: int) -> list[int]:
    """Take which of the numbers of a palette each entry is."""
    found = [0] * count if different < 2 else []
    while len(found) < count:
        times, i = divmod(record.integer(), different)
        if times > count - len(found):
            raise CorruptError("a run longer than its palette")
        found += [i] * (times or count - len(found))
    return found


def read_couplings(record: Record, *, own: bool) -> list[Coupling]:
    """Take the couplings; columns are counted in the order of the file."""
    told = record.integer()
    if own:
        return [Coupling(*one) for i, one in enumerate(OWN_COUPLINGS) if told >> i & 1]
    return [read_coupling(record) for _ in range(told)]


def read_coupling(record: Record) -> Coupling:
    """Take a coupling."""
    kind, listed = divmod(record.integer(), 2)
    joint, shape = None, SHAPES.get(kind)
    if kind == 0:
        sources, targets = record.integer(), record.integer()
        if not (0 < sources < 7 and 0 < targets < 4):
            raise CorruptError("a polynomial of more columns than there may be")
        shape = range(sources), range(sources, sources + targets)
    elif kind == 5:
        joint = Joint(record)
        shape = joint.sources, [joint.target]
    elif shape is None:
        raise CorruptError("a coupling that this version does not have")
    first = 0 if listed else record.integer()
    told = [[record.integer() if listed else first + c for c in columns] for columns in shape]
    return Coupling(kind, told[0], told[1], joint)


def read_model(payload: bytes) -> dict[int, list[float]]:
    """Model: give the list of each column; of column -1 the one by all columns."""
    record = Record(payload)
    record.integer()  # the level
    lists = {-1: record.bytes()}
    for _ in range(record.integer()):
        column = record.integer()
        lists[column] = record.bytes()
    record.end()
    return {c: list(struct.unpack(f"<{len(told) // 4}f", told)) for c, told in lists.items()}
