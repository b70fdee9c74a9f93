"""The codec ``patterns`` (docs/format/patterns.md)."""

import struct
from functools import cache
from math import sqrt

from exact_functions import sine_cosine
from lines import of_bits64
from records import CorruptError, Record, unzigzag
from streams import Bit, Coded, symbol, tree

PI = 3.141592653589793
Rows = list[list[float]]


class Tally:
    """A tallied bit."""

    def __init__(self) -> None:
        self.zeros, self.all = 16, 32

    def take(self, stream: Coded) -> bool:
        """Take it, and count it."""
        one = stream.chance(min(max((self.zeros << 16) // self.all, 64), 65472))
        self.zeros += 0 if one else 32
        self.all += 32
        if self.all > 8192:
            self.zeros, self.all = self.zeros // 2, self.all // 2
        return one


class Series:
    """How large counts were of late."""

    def __init__(self, at_first: int) -> None:
        self.state = 16 * at_first


class Kind:
    """Counts and numbers of a kind."""

    def __init__(self) -> None:
        self.tallies: dict[tuple[str, int, int], Tally] = {}

    def _bit(self, stream: Coded, what: str, size: int, place: int) -> bool:
        return self.tallies.setdefault((what, size, place), Tally()).take(stream)

    def count(self, stream: Coded, series: Series) -> int:
        """Take a count."""
        size, length = series.state.bit_length(), 0
        while length < 52 and self._bit(stream, "longer", size, length):
            length += 1
        found = length
        if length > 1:
            second = self._bit(stream, "second", size, length)
            found = (2 + second) << length - 2 | stream.raw(length - 2)
        series.state += (16 * min(found, 4095) - series.state) >> 2
        return found

    def number(self, stream: Coded, series: Series) -> int:
        """Take a number."""
        found = self.count(stream, series)
        return -found if found and stream.raw(1) else found


@cache
def cosines_of(n: int) -> Rows:
    """Give the rows w_i(t) of the cosines of so many frames."""
    rows = []
    for i in range(n):
        scale = sqrt((2.0 if i else 1.0) / n)
        angles = [(PI * float((2 * t + 1) * i % (4 * n))) / (2.0 * n) for t in range(n)]
        rows.append([scale * sine_cosine(angle)[1] for angle in angles])
    return rows


class Node:
    """A node, with its patterns."""

    def __init__(self, columns: list[int]) -> None:
        self.columns = columns
        self.frames = self.count = self.components = 0
        self.importance = 1.0
        self.basis: Rows = []
        self.centre: list[float] = []
        self.patterns: list[Rows] = []


class Decoder:
    """What all chunks share."""

    def __init__(self, header: bytes, model: bytes | None) -> None:
        record = Record(header)
        learned = record.integer()
        record.double()
        self.place, self.track, self.protected = (record.double() for _ in range(3))
        self.steps = [record.double() for _ in range(2)]
        self.smoothed = record.integer()
        own = record
        if learned:
            own = Record(model or b"")
            own.bytes()
        self._body(own)
        own.end()
        record.end()

    def _body(self, record: Record) -> None:
        self.count = record.integer()
        self.roles = record.list_in_runs(self.count)
        back = [unzigzag(z) for z in record.list_in_runs(self.count)]
        self.references = [c - b if b else None for c, b in enumerate(back)]
        flags = record.integer()
        self.apart, self.published = bool(flags & 1), bool(flags & 2)
        self.pattern = record.double()
        self.nodes = []
        for n in range(3, max([2, *self.roles]) + 1):
            node = Node([c for c, role in enumerate(self.roles) if role == n])
            node.frames, node.count, node.components = (record.integer() for _ in range(3))
            node.importance = record.integer() / 16
            self.nodes.append(node)
        self._database(Coded(record.bytes()))

    def _database(self, stream: Coded) -> None:
        bases, centres, counts, terms, firsts = (Kind() for _ in range(5))
        first, symbols = Series(64), tree(8)
        for node in self.nodes:
            if self.published:
                for _ in range(node.count):
                    node.patterns.append(self._published(stream, node, firsts, first, symbols))
                continue
            series, size = Series(64), len(node.columns)
            for _ in range(node.components):
                node.basis.append([bases.number(stream, series) / 512 for _ in range(size)])
            series = Series(16)
            node.centre = [centres.number(stream, series) * self.pattern for _ in range(size)]
            lengths = [Series(2) for _ in range(node.components)]
            usual = [[Series(1) for _ in range(7)] for _ in range(node.components)]
            for _ in range(node.count):
                shape = [[0.0] * node.components for _ in range(node.frames)]
                for j in range(node.components):
                    count = counts.count(stream, lengths[j])
                    own = [terms.number(stream, usual[j][i.bit_length()]) for i in range(count)]
                    self._add_cosines(shape, j, own, node)
                node.patterns.append(shape)
        stream.end()

    def _add_cosines(self, shape: Rows, j: int, terms: list[int], node: Node) -> None:
        step = (self.pattern / node.importance) * sqrt(float(node.frames))
        for i, term in enumerate(terms):
            if term:
                for row, cosine in zip(shape, cosines_of(node.frames)[i], strict=True):
                    row[j] += (term * step) * cosine

    def _published(
        self, stream: Coded, node: Node, firsts: Kind, first: Series, symbols: list[Bit]
    ) -> Rows:
        least, step = (struct.unpack("<f", struct.pack("<I", stream.raw(32)))[0] for _ in range(2))
        unit = self.pattern / node.importance
        shape = [[firsts.number(stream, first) * unit for _ in node.columns]]
        for _ in range(node.frames - 1):
            shape.append([old + (least + step * symbol(stream, symbols)) for old in shape[-1]])
        return shape

    def decode(self, payload: bytes, frames: int) -> Rows:
        """Give the rows of a chunk."""
        stream = Coded(payload)
        rows = [[0.0] * self.count for _ in range(frames)]
        counts, terms = Kind(), Kind()
        for column, role in enumerate(self.roles):
            if role < 2:
                step = self.protected if role else self.track
                self._take_track(stream, rows, column, step, counts, terms)
        kinds = [Kind() for _ in range(3)]
        for node in self.nodes:
            self._write(node, self._moved(stream, node, frames, kinds), rows)
        for column, role in enumerate(self.roles):
            if role == 2:
                for row in rows:
                    row[column] = row[self.references[column] or 0]
        self._correct(stream, rows)
        stream.end()
        return rows

    def _take_track(
        self, stream: Coded, rows: Rows, column: int, step: float, counts: Kind, terms: Kind
    ) -> None:
        length, usual, last = Series(4), [Series(1) for _ in range(7)], 0.0
        for begin in range(0, len(rows), 64):
            block = rows[begin : begin + 64]
            curve = [last] * len(block)
            for i in range(counts.count(stream, length)):
                term = terms.number(stream, usual[i.bit_length()])
                if term:
                    cosines = cosines_of(len(block))[i]
                    curve = [v + (term * step) * w for v, w in zip(curve, cosines, strict=True)]
            for row, value in zip(block, curve, strict=True):
                row[column] = value
            last = curve[-1]

    def _moved(self, stream: Coded, node: Node, frames: int, kinds: list[Kind]) -> Rows:
        """Give the components of a node in all frames."""
        length, pattern = Series(16), Series(4)
        usual = [Series(1) for _ in range(node.components)]
        moved: Rows = []
        boundaries = []
        while len(moved) < frames:
            boundaries.append(len(moved))
            size = 1 + kinds[0].count(stream, length)
            chosen = kinds[1].count(stream, pattern) if node.count > 1 else 0
            own = stretched(node.patterns[chosen], size)
            if self.apart:
                for j in range(node.components):
                    by = expected(moved, own, j)
                    steps = kinds[2].number(stream, usual[j])
                    by += steps * (self.place / node.importance)
                    for row in own:
                        row[j] += by
            moved += own
        return self._smooth(moved, boundaries[1:])

    def _smooth(self, moved: Rows, boundaries: list[int]) -> Rows:
        made, done, last = list(moved), 0, len(moved) - 1
        for boundary in boundaries:
            end = min(boundary + self.smoothed, last + 1)
            for t in range(max(done, boundary - self.smoothed), end):
                around = [moved[min(max(t + i, 0), last)] for i in (-2, 2, -1, 1, 0)]
                made[t] = [
                    (((a + b) + (c + d) * 4) + e * 6) / 16
                    for a, b, c, d, e in zip(*around, strict=True)
                ]
            done = end
        return made

    def _write(self, node: Node, moved: Rows, rows: Rows) -> None:
        for row, own in zip(rows, moved, strict=True):
            for i, column in enumerate(node.columns):
                value = own[i] if self.published else node.centre[i]
                if not self.published:
                    for part, axis in zip(own, node.basis, strict=True):
                        value += part * axis[i]
                reference = self.references[column]
                row[column] = value if reference is None else row[reference] + value

    def _correct(self, stream: Coded, rows: Rows) -> None:
        if not Tally().take(stream):
            return
        of_column, trees, numbers = Tally(), [tree(2) for _ in range(4)], Kind()
        for column, role in enumerate(self.roles):
            if not of_column.take(stream):
                continue
            series, steps, held, kind = Series(1), 0, 0, 0
            for row in rows:
                kind = symbol(stream, trees[kind])
                if kind == 1:
                    steps += numbers.number(stream, series)
                if kind == 3:
                    held = stream.raw(64)
                if kind > 1:
                    row[column] = of_bits64(held)
                elif steps:
                    row[column] += steps * self.steps[role == 1]


def stretched(pattern: Rows, size: int) -> Rows:
    """Give a pattern in so many frames."""
    found = []
    for t in range(size):
        frame, rest = divmod(t * (len(pattern) - 1), size - 1) if size > 1 else (0, 0)
        row = list(pattern[frame])
        if rest:
            part = rest / (size - 1)
            row = [a + (b - a) * part for a, b in zip(row, pattern[frame + 1], strict=True)]
        found.append(row)
    return found


def expected(moved: Rows, own: Rows, j: int) -> float:
    """Give by how much a component of a segment would go on from the one before."""
    if not moved:
        return 0.0
    speed = own[1][j] - own[0][j] if len(own) > 1 else 0.0
    if len(moved) > 1:
        speed += moved[-1][j] - moved[-2][j]
    return (moved[-1][j] - own[0][j]) + speed * 0.5


def decode(
    header: bytes,
    _: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
    model: bytes | None = None,
) -> Rows:
    """Give the rows of chunks."""
    decoder = Decoder(header, model)
    if decoder.count != len(formats):
        raise CorruptError("a header of other columns")
    return [row for frames, payload in chunks for row in decoder.decode(payload, frames)]
