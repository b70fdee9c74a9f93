"""Masks and tables of ``exact`` (docs/format/exact.md, "Masks and tables")."""

import math
import struct

from exact_header import palette
from lines import FLOAT32, Line, bits64, of_bits32
from records import CorruptError, Record, unzigzag

FLOATS = Line(FLOAT32, 0)


class Grid:
    """Numbers at whole steps from an origin, some of them a few floats away."""

    def __init__(self, record: Record) -> None:
        self.origin, self.step = record.double(), record.double()
        places = ascending(record)
        self.away = {place: unzigzag(record.integer()) for place in places}

    def number(self, place: float) -> float:
        """Give the number at a place."""
        number = FLOATS.number(FLOATS.near(self.origin + self.step * place))
        away = self.away.get(int(place)) if place.is_integer() else None
        return FLOATS.number(FLOATS.near(number) + away) if away else number


class List:
    """Any numbers."""

    def __init__(self, record: Record) -> None:
        self.numbers = [FLOATS.number(place) for place in ascending(record)]

    def number(self, place: float) -> float:
        """Give the number at a place."""
        if not (place.is_integer() and 0 <= place < len(self.numbers)):
            raise CorruptError("a place outside its list")
        return self.numbers[int(place)]


class AllFloats:
    """Any number is the place of the float nearest to it."""

    def __init__(self, record: Record) -> None:
        pass

    def number(self, place: float) -> float:
        """Give the number at a place."""
        most = 2.0**128 - 2.0**104
        (number,) = struct.unpack("<f", struct.pack("<f", max(-most, min(place, most))))
        return float(number)


class Told:
    """What stands behind the couplings of a codec header."""

    def __init__(self, record: Record, count: int) -> None:
        self.values: list[float] = []
        self.masks: list[tuple[int, int]] = [(0, 0)] * count
        self.tables: list[Grid | List | AllFloats] = []
        self.table = [0] * count
        if record.at == len(record.data):
            return
        self.values = [record.double() for _ in range(record.integer())]
        if self.values:
            first, second = palette(record, count), palette(record, count)
            self.masks = list(zip(first, second, strict=True))
        for _ in range(record.integer()):
            self.tables.append((Grid, List, AllFloats)[record.integer()](record))
        if self.tables:
            self.table = palette(record, count)

    def unpack(self, payload: bytes, frames: int) -> tuple[bytes, list[list[bool]]]:
        """Take the masks off a payload: for each whether it names a row."""
        record = Record(payload)
        masks = []
        for _ in self.values:
            named, inside = list[bool](), False
            for _ in range(record.integer()):
                length = record.integer()
                if length > frames - len(named):
                    raise CorruptError("a run longer than its chunk")
                named += [inside] * length
                inside = not inside
            masks.append(named + [inside] * (frames - len(named)))
        return payload[record.at :], masks

    def restored(self, row: list[float], named: list[bool]) -> list[float]:
        """Give the numbers of a row, ``named`` being the masks that name it."""
        numbers = []
        for number, table, (first, second) in zip(row, self.table, self.masks, strict=True):
            if table and math.isnan(number):
                number = of_bits32(bits64(number) & 0xFFFFFFFF)
            elif table:
                number = self.tables[table - 1].number(number)
            for mask in (second, first):
                if mask and named[mask - 1]:
                    number = self.values[mask - 1]
            numbers.append(number)
        return numbers


def ascending(record: Record) -> list[int]:
    """Take whole numbers in ascending order."""
    numbers = list[int]()
    for i in range(record.integer()):
        numbers.append(numbers[-1] + 1 + record.integer() if i else record.signed())
    return numbers
