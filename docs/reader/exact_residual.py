"""How ``exact`` codes a number beside its prediction, levels 3 to 9."""

from lines import SIGNIFICANT, Line, bits64, of_bits64
from streams import Bit, Coded, magnitude, symbol, tree
from tables import whole_numbers

RATES = (7, 10, 6)  # for all channels, fast and slow; the channel's own
OFF_LINE = 63


def bound(i: int) -> float:
    """Give the upper bound of a bucket, in scales."""
    q = (i + 1 - 32) / 32.0
    square = q * q
    return q * (4.65 + square * (5.25 + square * (1.77 + 0.33 * square)))


BOUNDS = [bound(i) for i in range(63)]


class OffLineError(Exception):
    """The number is not on its line."""


class Steps:
    """Models of how many steps off a number is, for an octave of scales."""

    def __init__(self) -> None:
        self.none, self.negative = tree(2), tree(2)
        self.more = [Bit() for _ in range(24)]


class Residual:
    """The models of all channels."""

    def __init__(self, stream: Coded, channels: int, start: list[float]) -> None:
        self.stream = stream
        shape = [chance << 16 for chance in whole_numbers("start_1")[:64]]
        self.fast, self.slow = list(shape), list(shape)
        if len(start) == 128:
            chances = [int(min(max(chance, 1.0), 16777215.0)) << 8 for chance in start]
            self.fast, self.slow, shape = chances[:64], chances[64:], chances[64:]
        self.own = [list(shape) for _ in range(channels)]
        self.beyond = tree(6), tree(6)
        self.steps = [Steps() for _ in range(8)]
        self.far, self.first = tree(6), tree(6)
        self.negative, self.first_negative, self.first_below = Bit(), Bit(), Bit()
        self.smaller: dict[int, Bit] = {}

    def next(self, channel: int, line: Line, predicted: float, scale: float) -> float:
        """Take a number beside its prediction."""
        try:
            step = line.step(predicted)  # 0 where a float's place is next to 0
            if step == 0 or scale / step >= 3:
                return line.number(self._by_bucket(channel, line, predicted, scale))
            return line.number(self._by_steps(line, predicted, scale / step))
        except OffLineError:
            return of_bits64(self.stream.raw(64))

    def next_first(self, line: Line) -> float:
        """Take a number of which nothing is known."""
        middle = line.decade(0) if line.kind == SIGNIFICANT else 0
        negative = self.stream.bit(self.first_negative)
        below = self.stream.bit(self.first_below)
        try:
            away = self._magnitude(self.first)
        except OffLineError:
            return of_bits64(self.stream.raw(64))
        place = middle - away if below else middle + away
        return line.number(-1 - place if negative else place)

    def _magnitude(self, lengths: list[Bit]) -> int:
        length = symbol(self.stream, lengths)
        if length == OFF_LINE:
            raise OffLineError
        return magnitude(self.stream, length)

    def _by_steps(self, line: Line, predicted: float, scale: float) -> int:
        near = line.near(predicted)
        fraction = (line.number(near) - predicted) / line.step(predicted) + 0.5
        quarter = int(min(fraction * 4, 3.0)) if fraction > 0 else 0
        models = self.steps[min(max((bits64(scale) >> 52) - 1023 + 6, 0), 7)]
        if not self.stream.bit(models.none[quarter]):
            return near
        negative = self.stream.bit(models.negative[quarter])
        more = 0
        while more < len(models.more) and self.stream.bit(models.more[more]):
            more += 1
        if more == len(models.more):
            more += self._magnitude(self.far)
        return near - more - 1 if negative else near + more + 1

    def _by_bucket(self, channel: int, line: Line, predicted: float, scale: float) -> int:
        node = 1
        shapes = self.fast, self.slow, self.own[channel]
        while node < 64:
            chance = sum(shape[node] for shape in shapes) // 3 >> 16
            one = self.stream.chance(65536 - min(max(chance, 24), 65512))
            for shape, rate in zip(shapes, RATES, strict=True):
                shape[node] += (2**32 - 1 - shape[node]) >> rate if one else -(shape[node] >> rate)
            node = 2 * node + one
        bucket = node - 64
        if bucket == 0:
            return line.near(predicted + scale * BOUNDS[0]) - 1 - self._magnitude(self.beyond[0])
        lowest = line.near(predicted + scale * BOUNDS[bucket - 1])
        if bucket == 63:
            return lowest + self._magnitude(self.beyond[1])
        end = line.near(predicted + scale * BOUNDS[bucket])
        if line.kind != SIGNIFICANT:
            return lowest + self.stream.one_of(end - lowest)
        if lowest < 0 < end:
            if self.stream.bit(self.negative):
                end = 0
            else:
                lowest = 0
        if lowest >= 0:
            return self._by_decade(line, lowest, end)
        return -1 - self._by_decade(line, -end, -lowest)

    def _by_decade(self, line: Line, start: int, end: int) -> int:
        depth = 0
        while end - start > 1:
            decade = line.decade_of(end - 1)
            first = line.decade(decade)
            if start >= first:
                break
            if depth < 5:
                here, smaller = float(end - first), float(line.per_decade) / 9
                one = self.stream.chance(int(64 + here / (here + smaller) * 65408))
            else:
                one = self.stream.bit(self.smaller.setdefault(decade, Bit()))
            start, end = (start, first) if one else (first, end)
            depth += 1
        return start + self.stream.one_of(end - start)
