"""A reader of levels 1 and 2 of ``exact``, word by word as docs/format.md describes them.

Lines of significant digits, decimals and float64; no noise columns.
"""

import math
import struct
from dataclasses import dataclass, field
from fractions import Fraction

TAU = 1e-13
PLANS = {1: (1, 4, 0.95), 2: (2, 8, 0.96)}


def octaves(x: float) -> int:
    return int((struct.unpack("<Q", struct.pack("<d", x))[0] >> 44) - 1023 * 256)


def of_octaves(o: int) -> float:
    return float(struct.unpack("<d", struct.pack("<Q", (o + 1023 * 256) << 44))[0])


def sane(level: float) -> float:
    return min(max(level, -1e12), 1e12) if level == level else -1e12


class Stream:
    """The stream of intervals."""

    def __init__(self, payload: bytes) -> None:
        self.state = int.from_bytes(payload[:8], "little")
        self.words = [w for (w,) in struct.iter_unpack("<I", payload[8:])][::-1]

    def take(self, start: int, size: int) -> None:
        self.state = size * (self.state >> 16) + self.state % 65536 - start
        if self.state < 1 << 31:
            self.state = self.state << 32 | self.words.pop()

    def one_of(self, m: int) -> int:
        slot = self.state % 65536
        value = next(v for v in range(m) if slot < -(-(v + 1) * 65536 // m))
        start = -(-value * 65536 // m)
        self.take(start, -(-(value + 1) * 65536 // m) - start)
        return value

    def raw(self, count: int) -> int:
        value = 0
        for done in range(0, count, 16):
            bits = min(16, count - done)
            part = self.state % 65536 >> (16 - bits)
            self.take(part << (16 - bits), 1 << (16 - bits))
            value |= part << done
        return value

    def bit(self, model: list[int]) -> int:
        c = (model[0] + model[1]) >> 1
        one = int(self.state % 65536 >= c)
        self.take(c if one else 0, 65536 - c if one else c)
        for i, rate in enumerate((4, 7)):
            model[i] += ((15 if one else 65520 + (1 << rate)) - model[i]) >> rate
        return one


def bucket(index: int) -> tuple[int, int]:
    """Give the first distance and the bits of the rest."""
    if index < 16:
        return index, 0
    half = index - 16
    return (2 + half % 2) << (3 + half // 2), 3 + half // 2


def cumulative(x: float) -> float:
    u = 0.5 * x / math.sqrt(1 + 0.25 * x * x)
    return 0.5 + 0.75 * u * (1 - u * u / 3)


def table(index: int) -> list[int]:
    sigma = 1 / 8
    for _ in range(index):
        sigma *= math.sqrt(math.sqrt(2))
    sizes = [0]
    for symbol in range(1, 64):
        share = 0.0
        if symbol < 60:
            first, bits = bucket(symbol // 2)
            a = first + (-0.5 if symbol % 2 == 0 else 0.5)
            share = cumulative(-a / sigma) - cumulative(-(a + (1 << bits)) / sigma)
        sizes.append(2 + int(65408 * share))
    sizes[0] = 65536 - sum(sizes)
    return sizes


TABLES = [table(index) for index in range(24)]


@dataclass
class Channel:
    """What a column has of its own; ``kind``: significant, decimals or float64."""

    kind: str
    digits: int
    inputs: int
    levels: list[float] = field(default_factory=list)
    bends: list[float] = field(default_factory=list)
    fast: float = 0.25
    slow: float = 0.25
    step: float = 1
    decade: int = 0
    negative: list[int] = field(default_factory=lambda: [32768, 32768])
    nonzero: list[int] = field(default_factory=lambda: [32768, 32768])

    def __post_init__(self) -> None:
        self.s = [1e-4] * self.inputs
        self.f = [[0.0] * (self.inputs + 1) for _ in range(self.inputs)]
        self.w = [0.0] * self.inputs

    @property
    def base(self) -> int:
        return 2 if self.kind == "float64" else 10

    def learn(self, v: list[float], fading: float) -> None:
        alpha, last = 1.0, self.inputs
        for j in range(last):
            d = fading * self.s[j]
            g = d + alpha * (v[j] * v[j])
            r = alpha / (g + TAU)
            q = r * v[j]
            alpha = r * (d + TAU)
            self.s[j] = g
            for i in range(j + 1, last + 1):
                v[i] = v[i] - v[j] * self.f[j][i]
                self.f[j][i] = self.f[j][i] + q * v[i]
        for j in reversed(range(last)):
            self.w[j] = self.f[j][last]
            for i in reversed(range(j + 1, last)):
                self.w[j] -= self.w[i] * self.f[j][i]

    def reach(self, magnitude: float) -> None:
        """Take the step of a magnitude; the exponent of the column is 0."""
        if self.kind == "decimals":
            self.step = 1 / 10.0**self.digits
            return
        if self.base == 2:
            self.decade = min(max(math.frexp(magnitude)[1] - 1, -900), 900)
            self.step = 2.0 ** (self.decade - 52)
            return
        self.decade = math.floor(math.log10(magnitude))
        self.decade += (magnitude >= float(f"1e{self.decade + 1}")) - (
            magnitude < float(f"1e{self.decade}")
        )
        self.decade = min(max(self.decade, self.digits - 23), self.digits + 21)
        last = self.decade - self.digits + 1
        self.step = 1 / 10.0**-last if last < 0 else 10.0**last

    def number(self, stream: Stream, k: int) -> tuple[float, float]:
        """Give the number of k steps, and its level."""
        least = self.base ** (self.digits - 1) if self.kind != "decimals" else 1
        last = self.decade - self.digits + 1 if self.kind != "decimals" else -self.digits
        exact = Fraction(self.base) ** last
        if abs(k) >= least:
            return float(k * exact), k * self.step
        if k == 0:
            sign = -1.0 if stream.bit(self.negative) else 1.0
            if not stream.bit(self.nonzero):
                return sign * 0.0, sign * 0.0
            place = stream.raw(stream.one_of(64))
            found = self.at(place)
            return sign * found, sign * found
        lacking = 0
        while abs(k) * self.base**lacking < least:
            lacking += 1
        rest, part = 0, self.base**lacking
        while part > 1:
            unit = min(part, 1000 if self.base == 10 else 1024)
            part //= unit
            rest += part * stream.one_of(unit)
        found = float((abs(k) + Fraction(rest, self.base**lacking)) * exact)
        return math.copysign(found, k), math.copysign(found, k)

    def at(self, place: int) -> float:
        """Give the number at a place of the line."""
        if self.kind == "float64":
            return float(struct.unpack("<d", struct.pack("<Q", place))[0])
        least = 10 ** (self.digits - 1)
        decade, digits = divmod(place - 1, 9 * least)
        return float((digits + least) * Fraction(10) ** (decade - 307 - self.digits + 1))


def distance(stream: Stream, scale: int) -> int | None:
    quarters = min(max((scale + 32) >> 6, -12), 200)
    shift = (quarters - 12) // 4 + 1 if quarters >= 12 else 0
    sizes = TABLES[quarters - 4 * shift + 12]
    slot, symbol, start = stream.state % 65536, 0, 0
    while slot >= start + sizes[symbol]:
        start += sizes[symbol]
        symbol += 1
    stream.take(start, sizes[symbol])
    if symbol >= 62:
        return None
    if symbol >= 60:
        away = stream.raw(stream.one_of(64))
    else:
        first, bits = bucket(symbol // 2)
        away = (first << shift) + stream.raw(bits + shift)
    return -1 - away if symbol % 2 else away


def decode(payload: bytes, frames: int, lines: list[tuple[str, int]], level: int) -> list[float]:
    """Give the values of a chunk, row by row."""
    own, others, fading = PLANS[level]
    stream = Stream(payload)
    channels = [Channel(kind, digits, own + others) for kind, digits in lines]
    activity, values = 0, []
    for t in range(frames):
        for c, channel in enumerate(channels):
            before = [channels[i].bends[t] if i >= 0 else 0.0 for i in range(c - others, c)]
            past = [channel.bends[t - i] if t >= i else 0.0 for i in range(own, 0, -1)]
            expected = 0.0
            if t > 0:
                one, two = channel.levels[-1], channel.levels[-2 if t > 1 else -1]
                expected = one + (one - two)
            told = 0.0
            for weight, bend in zip(channel.w, past, strict=False):
                told = told + weight * bend
            predicted = expected + told
            for weight, bend in zip(channel.w[own:], before, strict=True):
                predicted = predicted + weight * bend
            predicted = sane(predicted)
            floor = 0.3 * channel.step
            sum_ = 5 * octaves(channel.fast + floor) + 3 * octaves(channel.slow + floor)
            log_scale = int(math.copysign(abs(sum_) // 8, sum_)) + (activity >> 9) - 70
            log_scale = min(max(log_scale, -900 * 256), 900 * 256) if t > 0 else 1024
            scale = of_octaves(log_scale)
            channel.reach(abs(predicted) + scale)
            steps = predicted * (1 / channel.step)
            near = int(steps + math.copysign(0.5, steps)) if abs(steps) < 2**60 else 0
            off = distance(stream, log_scale - octaves(channel.step))
            if off is None:
                (number,) = struct.unpack("<d", stream.raw(64).to_bytes(8, "little"))
                now = number
            else:
                number, now = channel.number(stream, near + off)
            now = sane(now) if math.isfinite(now) else predicted
            values.append(number)
            channel.levels.append(now)
            channel.bends.append(now - expected if t > 0 else 0.0)
            if t > 0:
                error = abs(now - predicted)
                size = min(error, 20 * scale)
                channel.fast += max(0.25, 1 / t) * (size - channel.fast)
                channel.slow += max(0.06, 1 / t) * (size - channel.slow)
                more = octaves(error + 0.1 * scale) - log_scale + 185
                activity += (256 * min(max(more, -768), 768) - activity) >> 3
        for c, channel in enumerate(channels if t > 0 else []):
            past = [channel.bends[t - i] if t >= i else 0.0 for i in range(own, 0, -1)]
            before = [channels[i].bends[t] if i >= 0 else 0.0 for i in range(c - others, c + 1)]
            channel.learn([*past, *before], fading)
    assert stream.state == 1 << 31
    assert not stream.words
    return values
