"""How ``exact`` takes numbers from a coded stream (docs/format/exact.md, "Coding")."""

from collections import defaultdict

from exact_functions import cut
from lines import DEGREES, SIGNIFICANT, Line, bits64, of_bits64
from streams import Bit, Coded, Intervals, magnitude, symbol, tree
from tables import whole_numbers

OFF_LINE = 63
START = whole_numbers("start_1")


class Octave:
    """Steps: models of an octave."""

    def __init__(self) -> None:
        self.none, self.negative = ([Bit() for _ in range(4)] for _ in range(2))
        self.more = [Bit() for _ in range(24)]


class Coding:
    """The numbers of a part, and what is learned about those of all channels."""

    def __init__(self, stream: Coded, learned: list[float]) -> None:
        """Take the list that a model has by all columns."""
        self.stream = stream
        told = [int(cut(chance, 1.0, 16777215.0)) << 8 for chance in learned]
        usual = [chance << 16 for chance in START[:64]]
        self.fast, self.slow = (told[:64], told[64:]) if len(told) == 128 else (usual, usual[:])
        self.under, self.over, self.far, self.lengths = (tree(6) for _ in range(4))
        self.sign, self.negative, self.below = Bit(), Bit(), Bit()
        self.decades = defaultdict[int, Bit](Bit)
        self.octaves = [Octave() for _ in range(8)]

    def beside(self, line: Line, own: list[int], q: float, b: float) -> float:
        """Take a number beside its prediction; ``own`` are the chances of the channel."""
        step = line.step(q)
        if step == 0 or b / step >= 3:
            return self._by_buckets(line, own, q, b)
        return self._by_steps(line, q, b, step)

    def _number(self, line: Line, lengths: list[Bit], start: int, sign: int) -> float:
        """Take a magnitude: how far the place is from another one."""
        length = symbol(self.stream, lengths)
        if length == OFF_LINE:
            return of_bits64(self.stream.raw(64))
        return line.number(start + sign * magnitude(self.stream, length))

    def _by_buckets(self, line: Line, own: list[int], q: float, b: float) -> float:
        """Take a number by buckets ("Buckets")."""
        node = 1
        while node < 64:
            mean = (self.fast[node] + self.slow[node] + own[node]) // 3
            one = self.stream.chance(65536 - min(max(mean >> 16, 24), 65512))
            for chances, rate in ((self.fast, 7), (self.slow, 10), (own, 6)):
                h = chances[node]
                chances[node] += (2**32 - 1 - h) >> rate if one else -(h >> rate)
            node = 2 * node + one
        bounds = []
        for i in (node - 65, node - 64):
            r = (i + 1 - 32) / 32
            s = r * r
            bounds.append(line.near(q + b * (r * (4.65 + s * (5.25 + s * (1.77 + 0.33 * s))))))
        if node == 64:
            return self._number(line, self.under, bounds[1] - 1, -1)
        if node == 127:
            return self._number(line, self.over, bounds[0], 1)
        return line.number(self._place(line, *bounds))

    def _place(self, line: Line, a: int, e: int) -> int:
        """Take a place from A to E, not included ("Buckets")."""
        if line.kind != SIGNIFICANT:
            return a + self.stream.one_of(e - a)
        if a < 0 < e:
            a, e = (a, 0) if self.stream.bit(self.sign) else (0, e)
        if a < 0:
            return -1 - self._of_decades(line, -e, -a)
        return self._of_decades(line, a, e)

    def _of_decades(self, line: Line, a: int, e: int) -> int:
        """Take a place >= 0 of a line of significant digits ("Buckets")."""
        given = 5
        while e - a > 1:
            decade = line.decade_of(e - 1)
            begin = line.decade(decade)
            if a >= begin:
                break
            if given > 0:
                y = e - begin
                one = self.stream.chance(64 + int(y / (y + line.per_decade // 9) * 65408))
            else:
                one = self.stream.bit(self.decades[decade])
            given -= 1
            a, e = (a, begin) if one else (begin, e)
        return a + self.stream.one_of(e - a)

    def _by_steps(self, line: Line, q: float, b: float, step: float) -> float:
        """Take a number by steps ("Steps")."""
        n = line.near(q)
        z = (line.number(n) - q) / step + 0.5
        quarter = int(min(4 * z, 3)) if z > 0 else 0
        octave = self.octaves[min(max((bits64(b / step) >> 52) - 1023 + 6, 0), 7)]
        if not self.stream.bit(octave.none[quarter]):
            return line.number(n)
        sign = -1 if self.stream.bit(octave.negative[quarter]) else 1
        j = 0
        while j < 24 and self.stream.bit(octave.more[j]):
            j += 1
        start = n + sign * (j + 1)
        return line.number(start) if j < 24 else self._number(line, self.far, start, sign)

    def first(self, line: Line) -> float:
        """First numbers."""
        negative, below = self.stream.bit(self.negative), self.stream.bit(self.below)
        z = line.decade(0) if line.kind == SIGNIFICANT else 0
        if negative:
            return self._number(line, self.lengths, -1 - z, 1 if below else -1)
        return self._number(line, self.lengths, z, -1 if below else 1)


class Noise:
    """Noise: a column of it."""

    def __init__(self, line: Line, learned: list[float]) -> None:
        """Take the list that a model has of the column."""
        self.line = line
        self.kinds, self.lengths = tree(6, START[64:128]), tree(6, START[128:])
        if len(learned) == 256:
            told = iter([int(cut(chance, 15.0, 65520.0)) for chance in learned])
            for model in (*self.kinds, *self.lengths):
                model.fast, model.slow = next(told), next(told)

    def next(self, stream: Coded | Intervals) -> float:
        """Take a number."""
        kind = symbol(stream, self.kinds)
        if kind == OFF_LINE:
            return of_bits64(stream.raw(64))
        negative, number = stream.raw(1), 0.0
        if kind < 62:
            h = magnitude(stream, symbol(stream, self.lengths) + kind - 40)
            size = ((2 * h + 1) * 2.0 ** (-46 - kind)) * DEGREES
            number = self.line.number(self.line.near(size))
        return -number if negative else number
