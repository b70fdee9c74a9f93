"""Levels 1 and 2 of ``exact`` (docs/format/exact_fast.md)."""

import math
from bisect import bisect_right
from functools import cache
from itertools import accumulate

from exact_coding import Noise
from exact_functions import cut, rounded_away, total
from exact_header import Column
from lines import (
    DECIMALS,
    FLOAT64,
    SHORTEST32,
    SIGNIFICANT,
    Line,
    bits64,
    decade_of_number,
    of_bits64,
    power_of_ten,
)
from streams import Bit, Intervals

# Own bends and channels before that predict, and the fading.
INPUTS = {1: (2, 4, 0.91), 2: (2, 8, 0.9)}
# Where each bucket but the last begins, and log2 of how wide it is.
BUCKETS = [(a, 0) for a in range(16)]
BUCKETS += [(more << k, k) for k in range(3, 10) for more in (2, 3)]


def octaves(x: float) -> int:
    """Octaves of a double."""
    return (bits64(x) >> 44) - 1023 * 256


def of_octaves(count: int) -> float:
    """Octaves: the double of so many."""
    return of_bits64((count + 1023 * 256) << 44)


def student(x: float) -> float:
    """Tables: Student's distribution."""
    u = 0.5 * x / math.sqrt(1 + (0.25 * x) * x)
    return 0.5 + (0.75 * u) * (1 - (u * u) / 3)


@cache
def table(number: int) -> list[int]:
    """Tables: give where the interval of each symbol of a class ends."""
    sigma = 0.125
    for _ in range(number):
        sigma *= math.sqrt(math.sqrt(2))
    sizes = []
    for a, k in BUCKETS:
        for h in (-0.5, 0.5):
            share = student(-(a + h) / sigma) - student(-(a + h + 2**k) / sigma)
            sizes.append(2 + int(65408 * share))
    sizes += [2] * 4
    return list(accumulate([2**16 - sum(sizes[1:]), *sizes[1:]]))


def grid(line: Line) -> tuple[int, int, int, int]:
    """Give base, digits n, and bounds of the decade ("Steps")."""
    if line.kind == DECIMALS:
        return 10, 1, -line.digits, -line.digits
    if line.kind == SIGNIFICANT:
        return 10, line.digits, line.digits - 23, line.digits + 21
    return (2, 53, -900, 900) if line.kind == FLOAT64 else (2, 24, -126, 127)


class Channel:
    """A predicted column."""

    def __init__(self, column: Column, before: list["Channel"], level: int) -> None:
        """Take the channels before it in a row."""
        own, others, self.fading = INPUTS[level]
        self.line, self.unit, self.before = column.line, column.unit, before[-others:]
        self.missing = [0.0] * (others - len(self.before))
        self.bends = [0.0] * own
        """Of this row last."""
        count = own + others
        self.s, self.w = [1e-4] * count, [0.0] * count
        self.f = [[0.0] * (count + 1) for _ in range(count)]
        self.level = self.level_before = self.step = 0.0
        self.fast = self.slow = 0.25
        self.negative, self.nonzero = Bit(), Bit()

    def predict(self) -> float:
        """Prediction."""
        own = len(self.bends)
        self.inputs = [*self.bends, *self.missing, *(c.bends[-1] for c in self.before)]
        terms = [w * b for w, b in zip(self.w, self.inputs, strict=True)]
        p = (self.level + (self.level - self.level_before)) + total(terms[:own])
        for term in terms[own:]:
            p += term
        return cut(p, -1e12, 1e12)

    def learn(self) -> None:
        """Prediction: learn from a row."""
        v, alpha, count = [*self.inputs, self.bends[-1]], 1.0, len(self.inputs)
        for j, f in enumerate(self.f):
            d = self.fading * self.s[j]
            g = self.s[j] = d + alpha * (v[j] * v[j])
            r = alpha / (g + 1e-13)
            q = r * v[j]
            alpha = r * (d + 1e-13)
            for i in range(j + 1, count + 1):
                v[i] -= v[j] * f[i]
                f[i] += q * v[i]
        for j in reversed(range(count)):
            self.w[j] = self.f[j][count]
            for i in range(count - 1, j, -1):
                self.w[j] -= self.w[i] * self.f[j][i]


class Payload:
    """A payload: its rows, one behind the other."""

    def __init__(self, payload: bytes, columns: list[Column], level: int) -> None:
        self.stream = Intervals(payload)
        self.channels: list[Channel] = []
        for column in columns:
            if not column.noise:
                self.channels.append(Channel(column, self.channels, level))
        self.noises = [Noise(column.line, []) for column in columns if column.noise]
        self.shared = 0
        """A of the scale."""

    def row(self, t: int) -> list[float]:
        """Take a row."""
        noise = [column.next(self.stream) for column in self.noises]
        numbers = [self._later(c, t) if t > 0 else self._first(c) for c in self.channels]
        for channel in self.channels if t > 0 else []:
            channel.learn()
        return numbers + noise

    def _first(self, channel: Channel) -> float:
        """Take a number of row 0."""
        number, level = self._number(channel, 0.0, 1024)
        channel.level = channel.level_before = level
        return number

    def _later(self, channel: Channel, t: int) -> float:
        """Scale: take a number of another row, and learn its scale."""
        p, floor = channel.predict(), 0.3 * channel.step
        mean = 5 * octaves(channel.fast + floor) + 3 * octaves(channel.slow + floor)
        s = int(mean / 8) + self.shared // 512 - 70
        s = min(max(s, -900 * 256), 900 * 256)
        number, level = self._number(channel, p, s)
        error, scale = abs(level - p), of_octaves(s)
        far = min(error, 20 * scale)
        channel.fast += max(1 / t, 0.25) * (far - channel.fast)
        channel.slow += max(1 / t, 0.06) * (far - channel.slow)
        x = min(max(octaves(error + 0.1 * scale) - s + 185, -768), 768)
        self.shared += (256 * x - self.shared) // 8
        bend = level - (channel.level + (channel.level - channel.level_before))
        channel.bends = [*channel.bends[1:], bend]
        channel.level, channel.level_before = level, channel.level
        return number

    def _number(self, channel: Channel, p: float, s: int) -> tuple[float, float]:
        """Take a number; give it and its level ("Steps")."""
        line, unit = channel.line, channel.unit
        size, exponent = min((abs(p) + of_octaves(s)) / unit, 1e300), 0
        if line.printed:
            channel.step = max(line.step(size) * unit, 1e-300)
            n = line.near(p / unit)
            n += n < 0
        else:
            base, digits, least, greatest = grid(line)
            decade = decade_of_number(size) if base == 10 else (bits64(size) >> 52) - 1023
            exponent = min(max(decade, least), greatest) - digits + 1
            power = power_of_ten(abs(exponent)) if base == 10 else 2.0 ** abs(exponent)
            channel.step = max(unit / power if exponent < 0 else unit * power, 1e-300)
            near = p * (1 / channel.step)
            n = rounded_away(near) if abs(near) < 2.0**60 else 0
        d = self._difference(s - octaves(channel.step))
        if d is None:
            number = of_bits64(self.stream.raw(64))
            level = number * unit
        else:
            number, level = self._of_steps(channel, n + d, exponent)
        return number, cut(level if math.isfinite(level) else p, -1e12, 1e12)

    def _difference(self, above: int) -> int | None:
        """Tables: take D; None where the double follows."""
        q = min(max((above + 32) // 64, -12), 200)
        shift = (q - 12) // 4 + 1 if q >= 12 else 0
        ends = table(q - 4 * shift + 12)
        symbol = bisect_right(ends, self.stream.slot())
        start = ends[symbol - 1] if symbol else 0
        self.stream.take(start, ends[symbol] - start)
        bucket, negative = divmod(symbol, 2)
        if symbol == 63:
            return None
        if bucket < len(BUCKETS):
            a, k = BUCKETS[bucket]
            size = (a << shift) + self.stream.raw(shift + k)
        else:
            size = self.stream.raw(self.stream.uniform(64))
        return -1 - size if negative else size

    def _of_steps(self, channel: Channel, k: int, exponent: int) -> tuple[float, float]:
        """From k to the number: give it and its level."""
        line, unit, size, sign = channel.line, channel.unit, abs(k), -1.0 if k < 0 else 1.0
        if k == 0:
            sign = -1.0 if self.stream.bit(channel.negative) else 1.0
            if self.stream.bit(channel.nonzero):
                size = self.stream.raw(self.stream.uniform(64))
        if k == 0 or line.printed:
            number = sign * line.number(size)
            return number, number * unit
        base, digits, _, _ = grid(line)
        lacking = 0
        while size * base**lacking < base ** (digits - 1):
            lacking += 1
        for at in range(0, lacking, 10 if base == 2 else 3):
            share = base ** min(lacking - at, 10 if base == 2 else 3)
            size = size * share + self.stream.uniform(share)
        exponent -= lacking
        if lacking == 0 and line.kind != SHORTEST32:
            power = float(base) ** abs(exponent)
            return sign * (size / power if exponent < 0 else size * power), k * channel.step
        if base == 10:
            number = float(f"{size}e{exponent}")
        else:
            more = size.bit_length() - digits
            exponent_bits = exponent + more + (1075 if digits == 53 else 150)
            number = line.number((exponent_bits - 1 << digits - 1) + (size >> more))
        return sign * number, sign * number * unit


def decode(payload: bytes, frames: int, columns: list[Column], level: int) -> list[list[float]]:
    """Give the coded columns of a payload, row by row."""
    told = Payload(payload, columns, level)
    rows = [told.row(t) for t in range(frames)]
    told.stream.end()
    return rows
