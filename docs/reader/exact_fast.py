"""Levels 1 to 5 of ``exact`` (docs/format/exact_fast.md)."""

import math
from bisect import bisect_right
from functools import cache
from itertools import accumulate

from exact_coding import Noise
from exact_experts import Blend, Expert
from exact_functions import cut, rounded_away
from exact_header import Column, Coupling
from exact_last import LastStage, Shared
from exact_model import make_told
from exact_skeleton import Levels
from lines import (
    DECIMALS,
    FLOAT64,
    SHORTEST32,
    SIGNIFICANT,
    Line,
    bits32,
    bits64,
    decade_of_number,
    of_bits32,
    of_bits64,
    power_of_ten,
)
from streams import Bit, Intervals

# Own bends, first channels and channels before that predict, and the fading.
INPUTS = {1: (2, 0, 4, 0.91), 2: (2, 0, 8, 0.9), 3: (2, 0, 8, 0.9), 4: (0, 0, 8, 0.9)}
INPUTS[5] = (0, 6, 6, 0.93)
LAWS_FROM, SECOND_FROM, LAST_STAGE_FROM = 3, 4, 5
# Where each bucket but the last begins, and log2 of how wide it is.
BUCKETS = [(a, 0) for a in range(16)]
BUCKETS += [(more << k, k) for k in range(3, 10) for more in (2, 3)]


def single(x: float) -> float:
    """Round to binary32."""
    return of_bits32(bits32(x))


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
        own, roots, others, fading = INPUTS[level]
        self.line, self.unit, self.before = column.line, column.unit, before[-others:]
        far = len(before) >= roots + others
        self.roots = before[:roots] if far else []
        self.missing = [0.0] * (0 if far else roots), [0.0] * (others - len(self.before))
        self.bends, self.bend = [0.0] * own, 0.0
        self.fading, count = single(fading), own + roots + others
        self.s, self.w = [single(1e-4)] * count, [0.0] * count
        self.f = [[0.0] * (count + 1) for _ in range(count)]
        self.step = 0.0
        self.fast = self.slow = 0.25
        self.negative, self.nonzero = Bit(), Bit()

    def predict(self) -> float:
        """Prediction: the bend."""
        roots, others = self.missing
        self.inputs = [*self.bends, *roots, *(c.bend for c in self.roots), *others]
        self.inputs += [c.bend for c in self.before]
        bend = 0.0
        for w, b in zip(self.w, self.inputs, strict=True):
            bend = single(bend + single(w * b))
        return bend

    def learn(self) -> None:
        """Prediction: learn from a row."""
        v, alpha, count = [*self.inputs, self.bend], 1.0, len(self.inputs)
        for j, f in enumerate(self.f):
            d = single(single(self.fading * self.s[j]) + single(1e-13))
            g = self.s[j] = single(d + single(alpha * single(v[j] * v[j])))
            r = single(alpha / g)
            q = single(r * v[j])
            alpha = single(r * d)
            for i in range(j + 1, count + 1):
                v[i] = single(v[i] - single(v[j] * f[i]))
                f[i] = single(f[i] + single(q * v[i]))
        for j in reversed(range(count)):
            w = self.f[j][count]
            for i in range(count - 1, j, -1):
                w = single(w - single(self.w[i] * self.f[j][i]))
            self.w[j] = w
        self.bends = [*self.bends[1:], self.bend] if self.bends else []


class Payload:
    """A payload: its rows, one behind the other."""

    def __init__(
        self, payload: bytes, columns: list[Column], couplings: list[Coupling], level: int
    ) -> None:
        self.stream = Intervals(payload)
        self.channels: list[Channel] = []
        for column in columns:
            if not column.noise:
                self.channels.append(Channel(column, self.channels, level))
        self.noises = [Noise(column.line, []) for column in columns if column.noise]
        self.shared = 0
        """A of the scale."""
        count = len(self.channels)
        self.levels = Levels([channel.unit for channel in self.channels])
        self.told = make_told(couplings, self.levels) if level >= LAWS_FROM else {}
        self.own: list[Expert] = []
        if level >= SECOND_FROM:
            self.own = [own_expert(self.levels, c) for c in range(count)]
        self.blends = [Blend(2, (0.94,), 1.0) for _ in self.own]
        self.last = [LastStage() for _ in range(count if level >= LAST_STAGE_FROM else 0)]
        self.weights, self.products = Shared(), dict[int, list[float]]()

    def row(self, t: int) -> list[float]:
        """Take a row."""
        noise = [column.next(self.stream) for column in self.noises]
        count = len(self.channels)
        if t == 0:
            return [self._first(c) for c in range(count)] + noise
        for past in self.levels.past:
            past[1:] = past[:4]
        self.products.clear()
        numbers = [self._later(c, t) for c in range(count)]
        for channel in self.channels:
            channel.learn()
        for expert in self.own:
            expert.learn()
        if self.last:
            self.weights.learn(self.products, count)
        return numbers + noise

    def _first(self, c: int) -> float:
        """Take a number of row 0."""
        number, level = self._number(self.channels[c], 0.0, 1024)
        self.levels.past[c][:] = [level] * 5
        return number

    def _later(self, c: int, t: int) -> float:
        """Take a number of another row, and learn from it."""
        channel, past, told = self.channels[c], self.levels.past[c], self.told.get(c)
        before = past[1]
        move = (past[1] - past[2]) + channel.predict()
        if self.own:
            two = [move, self.own[c].predict(c) - before]
            move = self.blends[c].mix(two, (two[0] + two[1]) * 0.5)
        if told:
            move = told.choose([*told.predict(), move])
        s = self._scale(channel)
        scale, p = of_octaves(s), cut(before + move, -1e12, 1e12)
        stage = self.last[c] if self.last and not told else None
        if stage:
            stage.apart({})
            p = cut(before + (move + stage.past(scale) * scale), -1e12, 1e12)
        number, past[0] = self._number(channel, p, s)
        e, error = past[0] - before, abs(past[0] - p)
        channel.bend = single((past[0] - past[1]) - (past[1] - past[2]))
        if self.own:
            self.blends[c].learn(e, max(scale, 1e-100))
        if told:
            told.learn(e, scale)
        if stage:
            self.products[c] = stage.learn(e - move, self.weights.weights)
        far = min(error, 8 * scale)
        channel.fast += max(1 / t, 0.35) * (far - channel.fast)
        channel.slow += max(1 / t, 0.06) * (far - channel.slow)
        x = min(max(octaves(error + 0.1 * scale) - s + 185, -768), 768)
        self.shared += (256 * x - self.shared) // 8
        return number

    def _scale(self, channel: Channel) -> int:
        """Scale: give S."""
        floor = 0.1 * channel.step
        mean = 5 * octaves(channel.fast + floor) + 3 * octaves(channel.slow + floor)
        s = int(mean / 8) + self.shared // 256 - 65
        return min(max(s, -900 * 256), 900 * 256)

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


def own_expert(levels: Levels, c: int) -> Expert:
    """Second prediction: make the expert of a channel."""
    return Expert(levels, None, 1, 0.97, [c], [(c, 3), (c, 2), (c, 1)])


def decode(
    payload: bytes, frames: int, columns: list[Column], couplings: list[Coupling], level: int
) -> list[list[float]]:
    """Give the coded columns of a payload, row by row."""
    told = Payload(payload, columns, couplings, level)
    rows = [told.row(t) for t in range(frames)]
    told.stream.end()
    return rows
