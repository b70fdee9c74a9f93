"""Tables: sets of float32 numbers so regular or so few that their places are worth telling.

A grid is what a converter or a file of integers leaves when its whole numbers are stored as
float32: origin + step * k, up to some roundings. A list is any other set of few numbers. Columns of
such numbers are coded as places in their table. Decimals that were stored as float32 have all
float32 for their table, each at the decimals next to it, and are coded as decimals.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.exact.grids import find_grid
from mocapress.codecs.exact.rounding import Rounding, find_rounding
from mocapress.records import Writer

Values = NDArray[np.float64]
Places = NDArray[np.int64]

_GRID, _LIST, _ALL = 0, 1, 2
_TRIED = 8
_CHEAPEST = 24.0
"""Bits that a table takes, at least."""
_MOVED = 4.0
"""Bits beside those of the distance that it costs to tell that a number is off its grid."""
_BOXED = np.uint64(0x7FF80001 << 32)
"""Bits of a NaN in the place of a number that is not in the table; its float32 is below them."""
_FARTHEST = 2.0**52
_MOST = float(np.finfo(np.float32).max)


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A grid, a list or all of float32 numbers."""

    origin: float = 0.0
    step: float = 0.0
    """Of a grid; 0 for a list."""
    places: Places = field(default_factory=lambda: np.empty(0, np.int64))
    """Of a grid, in ascending order: where numbers are some floats away from its own."""
    away: Places = field(default_factory=lambda: np.empty(0, np.int64))
    """How many floats."""
    numbers: Values = field(default_factory=lambda: np.empty(0))
    """Of a list, in ascending order."""
    all: bool = False
    rounding: Rounding | None = None
    """Of all: which decimals stand for numbers; decoding does without."""

    @property
    def size(self) -> int:
        """How many numbers have to be told."""
        return len(self.places) + len(self.numbers)

    def values(self, places: Values) -> Values:
        """Give the numbers at places; what is no place of the table is NaN."""
        if self.all:
            return np.clip(places, -_MOST, _MOST).astype(np.float32).astype(np.float64)
        if not self.step:
            with np.errstate(invalid="ignore"):
                inside = (places >= 0) & (places < len(self.numbers)) & (places == np.rint(places))
            found = np.full(len(places), np.nan)
            found[inside] = self.numbers[places[inside].astype(np.int64)]
            return found
        with np.errstate(over="ignore", invalid="ignore"):
            found = (self.origin + self.step * places).astype(np.float32)
        if len(self.places):
            at = np.minimum(np.searchsorted(self.places, places), len(self.places) - 1)
            moved = np.flatnonzero(self.places[at] == places)
            found[moved] = float_at(place_of(found[moved]) + self.away[at[moved]])
        return found.astype(np.float64)

    def indices(self, values: Values) -> Values:
        """Give places of numbers; only where ``values`` gives a number back is it in the table."""
        if self.rounding is not None:
            return self.rounding.of(values)
        if not self.step:
            at = np.minimum(np.searchsorted(self.numbers, values), len(self.numbers) - 1)
            return at.astype(np.float64)
        with np.errstate(over="ignore", invalid="ignore"):
            return np.clip(np.rint((values - self.origin) / self.step), -_FARTHEST, _FARTHEST) + 0.0


def place_of(floats: NDArray[np.float32]) -> Places:
    """Give the places of floats among all: their bits, in the order of the numbers."""
    bits = floats.view(np.int32).astype(np.int64)
    return np.where(bits >= 0, bits, -1 - (bits + 2**31))


def float_at(places: Places) -> NDArray[np.float32]:
    """Give the floats at places; beyond all of them, some float."""
    inside = np.clip(places, -(2**31), 2**31 - 1)
    bits = np.where(inside >= 0, inside, -1 - inside - 2**31)
    return bits.astype(np.int32).view(np.float32)


def coded(table: Table, values: Values) -> Values:
    """Give the places of a column's numbers; boxed where they are not in the table, (F,)."""
    places = table.indices(values)
    off = np.isnan(places)
    off |= table.values(places).view(np.uint64) != values.view(np.uint64)
    with np.errstate(invalid="ignore"):
        bits = values[off].astype(np.float32).view(np.uint32).astype(np.uint64)
    places[off] = (_BOXED | bits).view(np.float64)
    return places


class Tables:
    """Tables that are worth it, found column by column."""

    def __init__(self) -> None:
        self.made: list[Table] = []

    def find(self, column: Values) -> int:
        """Give the number of the table of a column of floats, from 1 on, maybe a new one; or 0."""
        if len(column) < 2:
            return 0
        distinct = np.unique(column[np.isfinite(column)]) + 0.0
        if len(distinct) < 2 or (distinct[0] % 1 == 0 and (np.diff(distinct) == 1).all()):
            return 0
        moved = np.flatnonzero(np.diff(column, prepend=np.inf))
        saved = _Saving(column[moved])
        best, number = 0.0, 0
        # The columns of a file mostly have few tables between them; the last are tried again.
        for place in range(len(self.made) - 1, max(len(self.made) - _TRIED - 1, -1), -1):
            gain = saved.by(self.made[place], new=False)
            if gain > best:
                best, number = gain, place + 1
        # Steps of a table are at most as wide as its numbers lie apart, which bounds what it saves.
        most = len(moved) * (np.log2(np.ptp(distinct)) - saved.fineness.min())
        if most <= max(best + 1, _CHEAPEST):
            return number
        made = find_grid(distinct)
        grid = None if made is None else Table(*made)
        listed = Table(numbers=distinct) if 2 * len(distinct) < len(moved) else None
        rounding = find_rounding(distinct)
        decimals = None if rounding is None else Table(all=True, rounding=rounding)
        chosen = None
        for table in (grid, listed, decimals):
            gain = saved.by(table) if table is not None else 0.0
            if gain > best + 1:
                best, chosen = gain, table
        if chosen is not None:
            self.made.append(chosen)
            number = len(self.made)
        return number


def has_floats(columns: Values) -> NDArray[np.bool_]:
    """Tell of columns, (..., F), whether their numbers are float32, (...)."""
    with np.errstate(over="ignore", invalid="ignore"):
        again = columns.astype(np.float32).astype(np.float64)
    return np.asarray((again.view(np.uint64) == columns.view(np.uint64)).all(axis=-1))


class _Saving:
    """About how many bits a table saves of a column, of which these numbers count, (N,)."""

    def __init__(self, numbers: Values) -> None:
        self.numbers = numbers[np.isfinite(numbers)]
        ulp = np.maximum(np.abs(self.numbers), 2.0**-126) * 2.0**-24
        # Whole numbers are coded as such without a table.
        whole = (np.rint(self.numbers) == self.numbers).all()
        self.fineness = np.log2(np.full(len(ulp), 1.0) if whole else ulp)

    def by(self, table: Table, *, new: bool = True) -> float:
        """Give the bits that are saved, less those that the table takes."""
        places = table.indices(self.numbers)
        off = table.values(places).view(np.uint64) != self.numbers.view(np.uint64)
        if off.sum() * 16 > len(off):
            return 0.0
        if table.rounding is not None:
            density, cost = np.log2(table.rounding.steps(self.numbers)), 24.0
        elif table.step:
            density = np.full(len(places), np.log2(table.step))
            cost = 120.0 + float((np.log2(np.abs(table.away) + 1) + _MOVED).sum())
        else:
            gaps = np.diff(table.numbers)
            wide = np.minimum(places.astype(np.int64), len(gaps) - 1)
            density = np.log2(np.maximum(gaps[wide], gaps[np.maximum(wide - 1, 0)]))
            steps = np.diff(place_of(table.numbers.astype(np.float32)))
            cost = 40 + float((np.log2(steps) + 3).sum())
        saved = float((density - self.fineness)[~off].sum())
        return saved - 70 * float(off.sum()) - (cost if new else 8)


def write_tables(writer: Writer, tables: Iterable[Table]) -> None:
    """Append tables."""
    for table in tables:
        writer.integer(_ALL if table.all else _GRID if table.step else _LIST)
        if table.all:
            continue
        if table.step:
            writer.double(table.origin)
            writer.double(table.step)
            _write_steps(writer, table.places, writer.signed)
            for away in table.away.tolist():
                writer.signed(away)
        else:
            _write_steps(writer, place_of(table.numbers.astype(np.float32)), writer.signed)


def _write_steps(writer: Writer, numbers: Places, first: Callable[[int], None]) -> None:
    """Append whole numbers in ascending order."""
    writer.integer(len(numbers))
    if len(numbers):
        first(int(numbers[0]))
    for step in np.diff(numbers).tolist():
        writer.integer(step - 1)
