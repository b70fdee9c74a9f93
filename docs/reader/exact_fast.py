"""Levels 1 and 2 of ``exact``."""

import math
from typing import TYPE_CHECKING

from exact_noise import Noise
from lines import (
    DECIMALS,
    FLOAT64,
    SHORTEST32,
    bits64,
    decade_of_number,
    of_bits64,
    power_of_ten,
)
from streams import Bit, Intervals

if TYPE_CHECKING:
    from exact import Column

PLANS = {1: (1, 4, 0.95), 2: (2, 8, 0.96)}  # own inputs, channels before, fading
TINY = 1e-13
FAR = 30
FIRST_CLASS = 12


def octaves(number: float) -> int:
    """Give the logarithm to the base 2 in 1/256."""
    return (bits64(number) >> 44) - 1023 * 256


def of_octaves(value: int) -> float:
    """Give the number of a logarithm."""
    return of_bits64((value + 1023 * 256) << 44)


def bounded(level: float) -> float:
    """Keep a level within 10^12."""
    return level if -1e12 < level < 1e12 else 1e12 if level >= 1e12 else -1e12


def bucket(index: int) -> tuple[int, int]:
    """Give the first distance of a bucket, and in how many bits the rest stands."""
    if index < 16:
        return index, 0
    half = index - 16
    return (2 + half % 2) << 3 + half // 2, 3 + half // 2


def cumulative(x: float) -> float:
    """Student's t of four degrees of freedom."""
    u = 0.5 * x / math.sqrt(1 + 0.25 * x * x)
    return 0.5 + 0.75 * u * (1 - u * u / 3)


def table(index: int) -> list[int]:
    """Give where the symbols of a class begin, and 2^16."""
    sigma = 1 / 8
    for _ in range(index):
        sigma *= math.sqrt(math.sqrt(2))
    sizes = [0]
    for symbol in range(1, 64):
        first, bits = bucket(symbol // 2)
        start = first + (0.5 if symbol % 2 else -0.5)
        share = cumulative(-start / sigma) - cumulative(-(start + 2**bits) / sigma)
        sizes.append(2 + int(65408 * share) if symbol < 2 * FAR else 2)
    sizes[0] = 2**16 - sum(sizes)
    return [sum(sizes[:symbol]) for symbol in range(65)]


TABLES = [table(index) for index in range(24)]


def distance(stream: Intervals, scale: int) -> int | None:
    """Take how many steps a number is from its prediction; none where it follows by itself."""
    quarters = min(max(scale + 32 >> 6, -FIRST_CLASS), 200)
    shift = (quarters - 12) // 4 + 1 if quarters >= 12 else 0
    starts = TABLES[quarters - 4 * shift + FIRST_CLASS]
    symbol = next(s for s in range(64) if stream.slot() < starts[s + 1])
    stream.take(starts[symbol], starts[symbol + 1] - starts[symbol])
    if symbol >= 2 * FAR + 2:
        return None
    if symbol >= 2 * FAR:
        away = stream.raw(stream.uniform(64))
    else:
        first, bits = bucket(symbol // 2)
        away = (first << shift) + stream.raw(bits + shift)
    return -1 - away if symbol % 2 else away


class Fit:
    """What a channel's bend is expected to be from other bends."""

    def __init__(self, inputs: int, fading: float) -> None:
        self.fading = fading
        self.scales = [1e-4] * inputs
        self.factors = [[0.0] * (inputs + 1) for _ in range(inputs)]
        self.weights = [0.0] * inputs

    def learn(self, values: list[float]) -> None:
        """Learn from the inputs and, last, what they explain."""
        alpha, last = 1.0, len(self.weights)
        for j, factors in enumerate(self.factors):
            faded = self.fading * self.scales[j]
            grown = faded + alpha * (values[j] * values[j])
            ratio = alpha / (grown + TINY)
            gain = ratio * values[j]
            alpha = ratio * (faded + TINY)
            self.scales[j] = grown
            for i in range(j + 1, last + 1):
                values[i] -= values[j] * factors[i]
                factors[i] += gain * values[i]
        for j in reversed(range(last)):
            weight = self.factors[j][last]
            for i in reversed(range(j + 1, last)):
                weight -= self.factors[j][i] * self.weights[i]
            self.weights[j] = weight


class Ruler:
    """A line as whole steps, those of the decade of the last number."""

    def __init__(self, column: "Column") -> None:
        self.line, self.kind, self.unit = column.line, column.line.kind, column.unit
        self.negative, self.nonzero = Bit(), Bit()
        self.base, self.digits, self.lowest, self.origin = 10, self.line.digits, -307, 1
        self.least, self.most = self.digits - 23, self.digits + 21
        if self.line.bits:
            self.base, self.origin = 2, 0
            self.digits, self.lowest = (53, -1023) if self.kind == FLOAT64 else (24, -127)
            self.least, self.most = (-900, 900) if self.kind == FLOAT64 else (-126, 127)
        self.first = 1 if self.kind == DECIMALS else self.base ** (self.digits - 1)
        self.reach(0.0)

    def reach(self, magnitude: float) -> None:
        """Take the step near a level."""
        number = min(magnitude / self.unit, 1e300)
        if self.line.printed:
            self.step = self.line.step(number) * self.unit
        elif self.kind == DECIMALS:
            self.last = -self.digits
        else:
            decade = self.least
            if number >= 1e-300:
                binary = (bits64(number) >> 52) - 1023
                decade = decade_of_number(number) if self.base == 10 else binary
            self.decade = min(max(decade, self.least), self.most)
            self.last = self.decade - self.digits + 1
        if not self.line.printed:
            if self.base == 2:
                self.step = self.unit * 2.0**self.last
            elif self.last < 0 or self.kind == DECIMALS:
                self.step = self.unit / power_of_ten(-self.last)
            else:
                self.step = self.unit * power_of_ten(self.last)
        self.step = max(self.step, 1e-300)

    def near(self, predicted: float) -> int:
        """Give the steps nearest to a prediction."""
        if self.line.printed:
            place = max(self.line.near(abs(predicted) / self.unit), 0)
            return -place if predicted < 0 else place
        steps = predicted * (1 / self.step)
        return int(steps + math.copysign(0.5, steps)) if abs(steps) < 2**60 else 0

    def finish(self, stream: Intervals, steps: int) -> tuple[float, float]:
        """Give the number so many steps from 0, and its level."""
        marks, negative = abs(steps), steps < 0
        whole = not self.line.printed and self.kind != SHORTEST32
        if marks >= self.first and whole:
            return self._number(steps), steps * self.step
        at = marks
        if marks == 0:
            negative = stream.bit(self.negative)
            if stream.bit(self.nonzero):
                at = stream.raw(stream.uniform(64))
        elif not self.line.printed:
            decade, part = self.decade, 1
            while marks < self.first:
                marks, decade, part = marks * self.base, decade - 1, part * self.base
            while part > 1:
                unit = min(part, 1000 if self.base == 10 else 1024)
                part //= unit
                marks += stream.uniform(unit) * part
            while marks >= self.first * self.base:
                marks, decade = marks // self.base, decade + 1
            per_decade = self.first * (self.base - 1)
            at = self.origin + (decade - self.lowest) * per_decade + marks - self.first
        number = self.line.number(-1 - at if negative else at)
        return number, number * self.unit

    def _number(self, steps: int) -> float:
        if self.base == 2:
            return steps * 2.0**self.last
        if self.last < 0 or self.kind == DECIMALS:
            return steps / power_of_ten(-self.last)
        return steps * power_of_ten(self.last)


class Channel:
    """A column, and how far off its predictions were."""

    def __init__(self, column: "Column", own: int, others: int, fading: float) -> None:
        self.ruler, self.fit = Ruler(column), Fit(own + others, fading)
        self.bends = [0.0] * own
        """Of the frames before, oldest first."""
        self.bend = self.level = self.expected = 0.0
        self.fast = self.slow = 0.25


def decode(payload: bytes, frames: int, columns: list["Column"], level: int) -> list[list[float]]:
    """Give the rows of a chunk."""
    own, others, fading = PLANS[level]
    stream = Intervals(payload)
    channels = [Channel(column, own, others, fading) for column in columns if not column.noise]
    noise = [Noise(column.line, []) for column in columns if column.noise]
    activity, rows = 0, []
    for t in range(frames):
        behind = [column.next(stream) for column in noise]
        row = []
        before = [0.0] * others
        for channel in channels:
            number, activity = next_number(stream, channel, before, activity, t)
            row.append(number)
            before = [*before[1:], channel.bend]
        before = [0.0] * others
        for channel in channels if t > 0 else []:
            channel.fit.learn([*channel.bends, *before, channel.bend])
            channel.bends = [*channel.bends[1:], channel.bend]
            before = [*before[1:], channel.bend]
        rows.append(row + behind)
    stream.end()
    return rows


def next_number(
    stream: Intervals, channel: Channel, before: list[float], activity: int, t: int
) -> tuple[float, int]:
    """Take the number of a channel in row t; give it and the activity behind it."""
    ruler, own = channel.ruler, len(channel.bends)
    told = 0.0
    for weight, bend in zip(channel.fit.weights, channel.bends, strict=False):
        told += weight * bend
    predicted = channel.expected + told
    for weight, bend in zip(channel.fit.weights[own:], before, strict=True):
        predicted += weight * bend
    predicted = bounded(predicted)
    log_scale = 4 * 256
    if t > 0:
        floor = 0.3 * ruler.step
        errors = 5 * octaves(channel.fast + floor) + 3 * octaves(channel.slow + floor)
        usual = errors // 8 if errors >= 0 else -(-errors // 8)
        log_scale = min(max(usual + (activity >> 9) - 70, -900 * 256), 900 * 256)
    scale = of_octaves(log_scale)
    ruler.reach(abs(predicted) + scale)
    near = ruler.near(predicted)
    off = distance(stream, log_scale - octaves(ruler.step))
    if off is None:
        number = of_bits64(stream.raw(64))
        level = number * ruler.unit
    else:
        number, level = ruler.finish(stream, near + off)
    level = bounded(level) if math.isfinite(level) else predicted
    if t > 0:
        error = abs(level - predicted)
        size = min(error, 20 * scale)
        channel.fast += max(0.25, 1 / t) * (size - channel.fast)
        channel.slow += max(0.06, 1 / t) * (size - channel.slow)
        more = octaves(error + 0.1 * scale) - log_scale + 185
        activity += 256 * min(max(more, -768), 768) - activity >> 3
    channel.bend = level - channel.expected if t > 0 else 0.0
    channel.expected = level + (level - channel.level) if t > 0 else level
    channel.level = level
    return number, activity
