"""The codec ``near`` (docs/format/near.md)."""

import math
import struct
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import accumulate

from exact_functions import sine_cosine
from near_starts import Start, known_figure, start_of, step_of
from near_turning import take_turnings, turn_back
from records import CorruptError, Record
from streams import Bit, Coded, magnitude, symbol, tree

ENDS = (0, 1, 2, 3, 4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 181, 255)
NEXT = ((0, 2), (2, 0), (4, 6), (6, 4), (5, 7), (7, 5), (1, 3), (3, 1))
ROOTS = (45, 64, 91, 128, 181, 256, 362, 512, 724, 1024, 1448)


def make_chances() -> dict[int, int]:
    """Give the chance of each logit."""
    chances, p = dict[int, int](), 1.0
    for z in range(1024):
        chance = int(65536 * p / (1 + p))
        chances[z], chances[-z] = min(chance, 65529), max(65536 - chance, 7)
        p *= float.fromhex("0x1.0202015600446p+0")
    chances[0] = 32768
    return chances


def make_logits(chances: dict[int, int]) -> list[int]:
    """Give the logit of each sixteenth chance."""
    logits, z = [], -1023
    for i in range(4096):
        while z < 1023 and chances[z] < 16 * i + 8:
            z += 1
        logits.append(z)
    return logits


CHANCES = make_chances()
LOGITS = make_logits(CHANCES)
RATES = [655360 // (10 * n + 16) for n in range(256)]

Places = tuple[int, ...]
Context = tuple[Places, tuple[int, int]]


def within(value: int, low: int, high: int) -> int:
    """Cut a number to bounds."""
    return min(max(value, low), high)


class Mixed:
    """A set of mixed models; entries that were never met are as at first."""

    def __init__(self, start: Start | None = None, name: str = "") -> None:
        self.entries: dict[tuple[int, int, int], list[int]] = {}
        self.weights: dict[tuple[int, int, int], list[int]] = {}
        if start:
            self.entries = {key: list(entry) for key, entry in start.entries[name].items()}
            self.weights = {key: list(own) for key, own in start.weights[name].items()}

    def bit(self, stream: Coded, context: Context, decision: int = 0) -> int:
        """Take a bit."""
        places, choices = context
        entries = [
            self.entries.setdefault((table, place, decision), [32768, 32768, 0])
            for table, place in enumerate(places)
        ]
        weights = [
            self.weights.setdefault((of, choice, decision), [6000] * 16 + [0])
            for of, choice in enumerate(choices)
        ]
        inputs = [LOGITS[chance >> 4] for entry in entries for chance in entry[:2]]
        sums = [sum(map(int.__mul__, own[:16], inputs)) >> 16 for own in weights]
        chance = CHANCES[within(sum(sums) >> 1, -1023, 1023)]
        bit = int(stream.chance(65536 - chance))
        error = 65536 * bit - chance
        for own in weights:
            uses = own[16]
            s = 13 if uses < 32 else 14 if uses < 128 else 15 if uses < 512 else 16
            own[16] += 1
            for i, value in enumerate(inputs):
                own[i] = within(own[i] + (value * error + (1 << s - 1) >> s), -131071, 131071)
        for entry in entries:
            slow, fast, n = entry
            target = 65535 * bit
            slow += (target - slow) * RATES[n] >> 16
            fast += (target - fast) * RATES[min(n, 18)] >> 16
            entry[:] = within(slow, 16, 65519), within(fast, 64, 65471), min(n + 1, 255)
        return bit

    def magnitude(self, stream: Coded, context: Context, state: int | None = None) -> int:
        """Take a magnitude; `state` is that of the quantisers, if there are two."""

        def decision(u: int) -> int:
            return u if state is None else u + int(u > 0 or state >= 4)

        for u in range(14):
            if not self.bit(stream, context, decision(u)):
                return u
        length = 0
        while length < 29 and self.bit(stream, context, decision(14 + min(length, 17))):
            length += 1
        return 13 + (1 << length | stream.raw(length))


@dataclass
class Block:
    """A block: where it is, and its numbers."""

    start: int
    length: int
    numbers: list[int]
    of_class: int = 0

    def m(self, k: int) -> int:
        """Give a magnitude."""
        return min(abs(self.numbers[k]), 2047) if k < self.length else 0

    def sign(self, k: int) -> int:
        """Give a sign: 0, 1, 2."""
        return 0 if self.numbers[k] == 0 else 1 if self.numbers[k] < 0 else 2


@dataclass
class Channel:
    """A channel that moves."""

    column: int
    step: float
    value: float
    values: list[float] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    before: Block | None = None
    usual: list[int] = field(default_factory=lambda: [0] * 27)


def block_at(channel: Channel | None, frame: int) -> Block | None:
    """Give the block of this span that holds a frame."""
    blocks = channel.blocks if channel else []
    return next((b for b in blocks if b.start <= frame < b.start + b.length), None)


def octave(length: int) -> int:
    """Give log2."""
    return length.bit_length() - 1


def halves(x: int) -> int:
    """Give 2 log2(1 + x / 16), rounded."""
    v: int = (16 + min(x, 32767)) ** 4
    return v.bit_length() - 16 >> 1


def thirds(x: int) -> int:
    """Give 3 log2(1 + x / 16), rounded down."""
    v: int = (16 + min(x, 32767)) ** 3
    return v.bit_length() - 13


def level(x: int, count: int) -> int:
    """Give halves, of so many."""
    return min(halves(x), count - 1)


def coarse(k: int, n: int) -> int:
    """Give the coarse band of number k."""
    return min(thirds(3840 * k // n) >> 1, 9)


def fine(k: int, n: int) -> int:
    """Give the fine band of number k."""
    return min(thirds(7680 * k // n), 26)


class Around:
    """What a part of a span is coded beside."""

    def __init__(self, channels: list[Channel], i: int, start: int, n: int) -> None:
        own = channels[i]
        self.n, self.g, self.ch, self.usual = n, octave(n), own.column % 128, own.usual
        self.before = own.blocks[-1] if own.blocks else own.before
        nearest: list[Channel | None] = [*channels[max(0, i - 3) : i][::-1], None, None, None]
        self.beside = [block_at(c, start + n // 2) for c in nearest[:3]]
        self.at_start = block_at(nearest[0], start)
        self.at_end = block_at(nearest[0], start + n - 1)

    def seen(self, block: Block | None, k: int) -> int:
        """Give 16 times the magnitude that another block has at sine k."""
        if block is None:
            return 0
        d = self.g - octave(block.length)
        k = max(k + (1 << d - 1) >> d if d > 0 else k << -d, 1)
        return 16 * block.m(k) * ROOTS[d + 5] >> 8

    def rc(self, block: Block | None) -> int:
        """Give the class of a block beside those of this length."""
        if block is None:
            return 0
        return within(1 + block.of_class + 2 * (self.g - octave(block.length)), 1, 9)

    def rl(self, block: Block | None) -> int:
        """Give the length of a block beside this one."""
        return 2 + within(self.g - octave(block.length), -1, 3) if block else 0

    def class_context(self, knot: int) -> Context:
        """Give the context of the class."""
        g, a = self.g, self.rc(self.before)
        b, d = self.rc(self.beside[0]), self.rc(self.beside[1])
        z = min(3, abs(knot))
        places = (10 * a + g, 10 * a + b, 10 * self.ch + g, min(23, a + b), 10 * g + b, 10 * d + g)
        more = (3 * (4 * a + z) + min(2, b // 2), 10 * b + d)
        return (*places, *more), (int(self.before is not None) + 2 * min(z, 2), g)

    def split_context(self) -> Context:
        """Give the context of a split."""
        g, a = self.g, self.rl(self.before)
        b, d, e = self.rl(self.beside[0]), self.rl(self.beside[1]), self.rl(self.at_start)
        s = state(self.before)
        places = (10 * a + g, 6 * a + b, 10 * self.ch + g, 4 * b + state(self.beside[0]))
        more = (10 * b + g, 4 * g + s, 4 * (6 * b + d) + s, 6 * (6 * b + e) + a)
        return (*places, *more), (a, g)

    def knot_context(self) -> Context:
        """Give the context of the knot."""
        g, before = self.g, self.before
        p = 16 * before.m(0) if before else 0
        u = 16 * self.at_end.m(0) if self.at_end else 0
        e = 16 * (before.m(1) + before.m(2) + before.m(3)) if before else 0
        places = (
            *(10 * level(p, 12) + g, 10 * level(p, 10) + level(e, 10), 10 * self.ch + g),
            *(min(23, thirds(p + e)), 10 * g + level(e, 10), 10 * level(e, 12) + level(p, 10)),
            *(12 * level(u, 12) + level(p, 12), 12 * level(u, 12) + g),
        )
        return places, (int(before is not None) + 2 * int(self.at_end is not None), g)

    def number_context(self, block: Block, k: int) -> Context:
        """Give the context of number k."""
        end, one, two, three = min(ENDS[block.of_class], self.n - 1), *self.beside
        m = [16 * block.m(k - i) if k - i >= 1 else 0 for i in range(5)]
        o = 2 * m[1] + m[2] + (m[3] + m[4]) // 2
        seen = self.seen
        p = seen(self.before, k - 1) + 2 * seen(self.before, k) + seen(self.before, k + 1)
        q = 2 * seen(one, k) + seen(one, k - 1) + seen(one, k + 1) + seen(two, k) + seen(three, k)
        r = 2 * (seen(two, k) + seen(three, k)) + seen(two, k + 1) + seen(three, k + 1)
        v, h = self.usual[fine(k, self.n)] // 4, coarse(k, self.n)
        every = 19 * o + 11 * p + 8 * q >> 4
        whole = 13 * o + 8 * p + 5 * q + 3 * r + 13 * v >> 4
        f = 0 if k == end else 1 if end - k < 3 else 2
        places = (
            *(10 * level(o, 12) + h, 10 * level(p, 10) + level(q, 10), 10 * self.ch + h),
            min(23, thirds(whole)),
            10 * (4 * min(3, m[1] // 16) + min(3, m[2] // 16)) + level(q, 10),
            *(10 * level(o, 12) + level(p, 10), 12 * level(2 * v, 12) + level(o, 12)),
            3 * (12 * level(2 * v, 12) + level(p + q, 12)) + f,
        )
        first = min(7, level(every, 16) // 2) + 8 * int(self.before is not None)
        return places, (first, 10 * min(5, level(whole, 12) // 2) + h)

    def sign_context(self, block: Block, k: int) -> Context:
        """Give the context of a sign."""
        s1 = block.sign(k - 1) if k >= 2 else 0
        s2 = block.sign(k - 2) if k >= 3 else 0
        knot = block.sign(0) if k >= 1 else 0
        x = y = 0
        other = self.beside[0]
        if other and (other.start, other.length) == (block.start, block.length):
            x, y = other.sign(k), other.sign(k - 1) if k >= 2 else 0
        w = 0 if 0 in (x, y, s1) else 1 if s1 == y else 2
        j, t, i = min(k, 9), 3 * s1 + s2, 1 + k % 2 if k else 0
        places = (
            *(10 * t + j, 10 * knot + j, 9 * self.ch + 3 * x + s1, 3 * x + w, 9 * knot + t),
            *(10 * (3 * x + s1) + j, 9 * t + 3 * x + w, 3 * (3 * self.ch + i) + knot),
        )
        return places, (int(k > 0), j)


def state(block: Block | None) -> int:
    """Give what a block has: nothing, a line, or more."""
    if block is None:
        return 0
    return 3 if block.of_class else 2 if block.numbers[0] else 1


class Header:
    """The codec header: knot, and of columns steps, joints and these joints' parents."""

    def __init__(self, header: bytes, columns: int) -> None:
        record = Record(header)
        record.numbers(2)
        flags = record.integer()
        self.short_spans, self.radians, known = flags & 2 == 0, flags & 4 != 0, flags & 8 != 0
        self.knot = (record.integer() + 1) / 8
        exponent, start = record.signed(), record.integer()
        self.start = start_of(start - 1, known, tuple(CHANCES.items())) if start else None
        self.firsts, self.order = [0.0] * columns, list(range(columns))
        if known:
            nearest = record.integer()
            finer = differences(record.bytes(), columns) if flags & 16 else [0] * columns
            record.end()
            self.take_known(exponent, nearest, finer)
            return
        if flags & 32:
            skipped = differences(record.bytes(), columns)
            self.order = [each + c for c, each in enumerate(accumulate(skipped))]
            if sorted(self.order) != list(range(columns)):
                raise CorruptError("columns in no order")
        stream, lengths = Coded(record.bytes()), tree(7)
        record.end()
        again, backs, same = [Bit(), Bit()], tree(6), False
        self.steps, self.joints, self.parents = list[float](), list[int](), list[int]()
        for column in range(columns):
            exponent += 32 * difference(stream, lengths)
            if not -4096 <= exponent <= 4096:
                raise CorruptError("a step out of bounds")
            self.steps.append(step_of(exponent))
            same = column > 0 and stream.bit(again[int(same)])
            if not same:
                back = count(stream, backs)
                self.parents.append(len(self.parents) - back if back else -1)
            self.joints.append(len(self.parents) - 1)
        self.turnings = take_turnings(stream, self.joints)
        stream.end()

    def take_known(self, exponent: int, nearest: int, finer: list[int]) -> None:
        """Take what the known figure has, but for steps that are finer."""
        figure = known_figure()
        if len(figure.exponents) != len(finer):
            raise CorruptError("the known figure has other columns")
        exponents = [
            exponent + own - 32 * each
            for own, each in zip(figure.exponents, accumulate(finer), strict=True)
        ]
        if not all(-4096 <= each <= 4096 for each in exponents):
            raise CorruptError("a step out of bounds")
        self.steps = [step_of(each) for each in exponents]
        self.joints, self.parents, self.firsts = figure.joints, figure.parents, figure.firsts
        self.turnings = [
            replace(turning, nearest_to_zero=bool(nearest >> i & 1))
            for i, turning in enumerate(figure.turnings)
        ]

    def above(self, joint: int) -> int:
        """Give the parent of a joint."""
        return self.parents[joint] if joint >= 0 else -1

    def related(self, column: int, other: int) -> bool:
        """Tell whether a column foretells another."""
        joint, source = self.joints[column], self.joints[other]
        above = self.above(joint)
        ancestors = [joint]
        while len(ancestors) < 5:
            ancestors.append(self.above(ancestors[-1]))
        beside = [parent for parent in (above, self.above(above)) if parent >= 0]
        return source == 0 or source in ancestors or self.above(source) in beside


def difference(stream: Coded, lengths: list[Bit]) -> int:
    """Take a difference."""
    length = symbol(stream, lengths)
    if length == 0:
        return 0
    negative = stream.raw(1)
    size = magnitude(stream, length)
    return -size if negative else size


class Foretelling:
    """What channels before a channel foretell of it."""

    def __init__(self, channels: list["Channel"], header: Header) -> None:
        self.channels = channels
        self.sources: list[list[int]] = []
        for i, channel in enumerate(channels):
            before = range(i - 1, -1, -1)
            found = [j for j in before if header.related(channel.column, channels[j].column)]
            self.sources.append(found[:20])
        self.past = [[channel.value] * 7 for channel in channels]
        self.products = [[[0.0] * (2 * len(s)) for _ in range(2 * len(s))] for s in self.sources]
        self.targets = [[0.0] * (2 * len(s)) for s in self.sources]
        self.seen = 0.0
        self.caution, self.fade = (0.125, 0.75) if header.short_spans else (100.0, 0.8)
        if header.start and header.start.assumed:
            self.assume(header.start)
        self.features: list[tuple[list[float], list[float]]] = []
        self.rests: list[list[float]] = []

    def assume(self, start: Start) -> None:
        """Begin as if some had been seen."""
        worth = float(start.observations[0])
        self.seen, self.caution = worth, min(self.caution, 3.0)
        for i, channel in enumerate(self.channels):
            products, targets = self.products[i], self.targets[i]
            for k, j in enumerate(self.sources[i]):
                source = self.channels[j]
                one = start.assumed.get((channel.column, source.column))
                if one is None:
                    continue
                ratio, a = source.step / channel.step, 2 * k
                square, once = worth * (ratio * ratio), worth * ratio
                products[a][a] = square * one.moved
                products[a + 1][a] = square * one.both
                products[a + 1][a + 1] = square * one.averaged
                targets[a] = once * (one.moved * one.shares[0] + one.both * one.shares[1])
                targets[a + 1] = once * (one.both * one.shares[0] + one.averaged * one.shares[1])

    def begin_span(self) -> None:
        """Begin a span."""
        self.features, self.rests = [], []

    def curve(self, i: int, n: int) -> list[float]:
        """Give what is foretold of a channel in the frames of the span."""
        curve, size = [0.0] * n, 2 * len(self.sources[i])
        if not size or not self.seen:
            return curve
        matrix = [list(row) for row in self.products[i]]
        for a in range(size):
            step, own = self.channels[self.sources[i][a // 2]].step, self.channels[i].step
            matrix[a][a] += matrix[a][a] * (self.caution / self.seen)
            matrix[a][a] += step * step / (own * own)
        shares = solved(matrix, list(self.targets[i]))
        for a, share in enumerate(shares):
            feature = self.features[self.sources[i][a // 2]][a % 2]
            curve = [value + share * far for value, far in zip(curve, feature, strict=True)]
        return curve

    def tell(self, i: int, values: list[float], rest: list[float]) -> None:
        """Take a channel's values in the span."""
        past = self.past[i]
        whole = [*past, *values, *values[-1:] * 6]

        def average(start: int) -> float:
            total = 0.0
            for k in range(13):
                total += (7 - abs(k - 6)) * whole[start + k]
            return total

        before = average(0)
        averaged = [(average(t + 1) - before) / 49 for t in range(len(values))]
        self.features.append(([value - past[-1] for value in values], averaged))
        self.rests.append(rest)
        self.past[i] = whole[len(values) : len(values) + 7]

    def end_span(self) -> None:
        """Learn from the span, which is not the last."""
        for start in range(0, len(self.rests[0]) if self.rests else 0, 64):
            waves = [
                [waves_of(numbers[start : start + 64]) for numbers in (*features, rest)]
                for features, rest in zip(self.features, self.rests, strict=True)
            ]
            for i, sources in enumerate(self.sources):
                self.learn(i, waves, [waves[s][kind] for s in sources for kind in (0, 1)])
            self.seen += 63
        self.seen *= self.fade
        for i in range(len(self.channels)):
            self.products[i] = [[self.fade * each for each in row] for row in self.products[i]]
            self.targets[i] = [self.fade * each for each in self.targets[i]]

    def learn(self, i: int, waves: list[list[list[float]]], sources: list[list[float]]) -> None:
        """Add what 64 frames show of a channel."""
        target, rest, step = waves[i][0], waves[i][2], self.channels[i].step
        first = 0
        for end in (1, 2, 3, 5, 8, 12, 20, 32, 63):
            band = range(first, end)
            first = end
            weight = 1 / (step * step + total(rest[k] * rest[k] for k in band) / len(band))
            for a, source in enumerate(sources):
                self.targets[i][a] += weight * total(target[k] * source[k] for k in band)
                for b in range(a + 1):
                    sums = total(source[k] * sources[b][k] for k in band)
                    self.products[i][a][b] += weight * sums


def total(numbers: Iterable[float]) -> float:
    """Add numbers one after the other, as `sum` does not in every version of Python."""
    added = 0.0
    for number in numbers:
        added += number
    return added


def waves_of(numbers: list[float]) -> list[float]:
    """Give the waves 1 to 63 of 64 numbers."""
    pairs = list(zip(numbers[:32], numbers[:31:-1], strict=True))
    halves = [[a + b for a, b in pairs], [a - b for a, b in pairs]]
    return [
        total(COSINES[k * (2 * t + 1) % 256] * number for t, number in enumerate(halves[k % 2]))
        for k in range(1, 64)
    ]


COSINES = [math.sqrt(2.0 / 64) * sine_cosine(3.141592653589793 * i / 128)[1] for i in range(256)]


def solved(matrix: list[list[float]], x: list[float]) -> list[float]:
    """Solve by Cholesky's decomposition; nothing where a root is not above 0."""
    for i, row in enumerate(matrix):
        for j in range(i + 1):
            total = row[j]
            for k in range(j):
                total -= row[k] * matrix[j][k]
            if j < i:
                row[j] = total / matrix[j][j]
            elif total > 0:
                row[i] = math.sqrt(total)
            else:  # pragma: no cover - needs numbers that no motion has
                return []
        for k in range(i):
            x[i] -= row[k] * x[k]
        x[i] /= row[i]
    for i in reversed(range(len(x))):
        for k in range(i + 1, len(x)):
            x[i] -= matrix[k][i] * x[k]
        x[i] /= matrix[i][i]
    return x


class Chunk:
    """A chunk of frames."""

    def __init__(self, payload: bytes, frames: int, header: Header) -> None:
        self.stream, self.header, self.frames = Coded(payload), header, frames
        names = ("knots", "classes", "numbers", "splits", "signs")
        models = [Mixed(header.start, name) for name in names]
        self.knots, self.classes, self.numbers, self.splits, self.signs = models
        self.channels: list[Channel] = []
        self.columns: list[list[float]] = []
        self.rest: list[float] = []
        self.starts: list[list[float]] = []

    def decode(self) -> list[list[float]]:
        """Give the chunk's rows."""
        self.begin()
        foretelling, first = Foretelling(self.channels, self.header), 0
        while first < self.frames:
            n = 64 if self.header.short_spans else 256
            while n > 8 and n // 2 >= self.frames - first:
                n //= 2
            foretelling.begin_span()
            for i, channel in enumerate(self.channels):
                if channel.blocks:
                    channel.before, channel.blocks = channel.blocks[-1], []
                self.rest = []
                self.part(i, 0, n)
                curve = foretelling.curve(i, n)
                values = [one + rest for one, rest in zip(curve, self.rest, strict=True)]
                foretelling.tell(i, values, self.rest)
                channel.values += values
                channel.value = values[-1]
            first += n
            if first < self.frames:
                foretelling.end_span()
        for channel in self.channels:
            self.columns[channel.column] = channel.values[: self.frames]
        self.marks()
        self.stream.end()
        return [list(row) for row in zip(*self.columns, strict=True)]

    def begin(self) -> None:
        """Take where channels begin."""
        stream, models, firsts, moves = self.stream, [Bit(), Bit()], tree(6), True
        for column, step in enumerate(self.header.steps):
            moves = stream.bit(models[int(moves)])
            number = difference(stream, firsts)
            first = self.header.firsts[column]
            self.columns.append([first + number * (step * 0.25)] * self.frames)
            if moves:
                value = first + number * (step * self.header.knot)
                self.channels.append(Channel(column, step, value))
        eighth, firsts = 0.7853981633974483 if self.header.radians else 45.0, tree(6)
        for turning in self.header.turnings:
            near = [0.0] * 3
            if not turning.nearest_to_zero:
                near = [difference(stream, firsts) * eighth for _ in range(3)]
            self.starts.append(near)

    def part(self, i: int, start: int, n: int) -> None:
        """Take a part of a channel's span."""
        channel = self.channels[i]
        around = Around(self.channels, i, start, n)
        if n > 8 and self.splits.bit(self.stream, around.split_context()):
            self.part(i, start, n // 2)
            self.part(i, start + n // 2, n // 2)
            return
        block = Block(start, n, [0] * n)
        self.number(self.knots, around.knot_context(), around, block, 0)
        context = around.class_context(block.numbers[0])
        while ENDS[block.of_class] < n - 1:
            if not self.classes.bit(self.stream, context, block.of_class):
                break
            block.of_class += 1
        state = 0
        for k in range(1, min(ENDS[block.of_class], n - 1) + 1):
            self.number(self.numbers, around.number_context(block, k), around, block, k, state)
            state = NEXT[state][block.numbers[k] % 2]
        self.remember(channel.usual, block)
        channel.blocks.append(block)
        curve = self.curve(block, channel.value, channel.step)
        self.rest += curve
        channel.value = curve[-1]

    def number(
        self,
        models: Mixed,
        context: Context,
        around: Around,
        block: Block,
        k: int,
        state: int | None = None,
    ) -> None:
        """Take a number with its sign."""
        size = models.magnitude(self.stream, context, state)
        if size:
            negative = self.signs.bit(self.stream, around.sign_context(block, k))
            block.numbers[k] = -size if negative else size

    def remember(self, usual: list[int], block: Block) -> None:
        """Move the usual magnitudes."""
        bands: dict[int, list[int]] = {}
        for k in range(1, block.length):
            bands.setdefault(fine(k, block.length), []).append(block.m(k))
        for band, sizes in bands.items():
            rate = min(128, math.isqrt(838 * len(sizes)))
            usual[band] += (256 * sum(sizes) // len(sizes) - usual[band]) * rate >> 8

    def curve(self, block: Block, left: float, step: float) -> list[float]:
        """Give the values of a block."""
        n, state = block.length, 0
        knot = block.numbers[0] * (step * self.header.knot)
        values = [left + knot * t / n for t in range(1, n + 1)]
        root = math.sqrt(2.0 / n)
        waves = [root * sine_cosine(3.141592653589793 * i / n)[0] for i in range(2 * n)]
        for k, number in enumerate(block.numbers[1:], 1):
            nearer = 0 if state < 4 or number == 0 else 1 if number > 0 else -1
            state = NEXT[state][number % 2]
            if number:
                height = ((2.0 * number - nearer) * 0.5625) * step
                for t in range(1, n):
                    values[t - 1] += waves[k * t % (2 * n)] * height
        return values

    def marks(self) -> None:
        """Take corrections and kept numbers."""
        stream = self.stream
        counts, gaps, sizes, places, times = (tree(6) for _ in range(5))
        fineness, negative, again = tree(4), Bit(), Bit()
        frame = 0
        for _ in range(count(stream, counts)):
            frame += count(stream, gaps)
            part = 2.0 ** (1 - symbol(stream, fineness))
            column = 0
            for _ in range(count(stream, sizes) + 1):
                column += count(stream, places)
                t = count(stream, times) + 1
                if stream.bit(negative):
                    t = -t
                self.columns[column][frame] += t * (self.header.steps[column] * part)
                column += 1
            frame += 1
        for turning, start in zip(self.header.turnings, self.starts, strict=True):
            own = self.columns[turning.first : turning.first + 3]
            turn_back(turning, self.header.radians, own, start)
        column = frame = bits = 0
        for _ in range(count(stream, counts)):
            further = count(stream, places)
            if further:
                column, frame = column + further, 0
            frame += count(stream, gaps)
            for _ in range(count(stream, sizes) + 1):
                if not stream.bit(again):
                    bits = stream.raw(64)
                (self.columns[column][frame],) = struct.unpack("<d", struct.pack("<Q", bits))
                frame += 1


def differences(stream: bytes, columns: int) -> list[int]:
    """Take a number for each column."""
    coded, lengths = Coded(stream), tree(6)
    found = [difference(coded, lengths) for _ in range(columns)]
    coded.end()
    return found


def count(stream: Coded, lengths: list[Bit]) -> int:
    """Take a number of 0 or more."""
    return magnitude(stream, symbol(stream, lengths)) - 1


def decode(
    header: bytes,
    _: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
) -> list[list[float]]:
    """Give the rows of chunks; of the number formats, only how many there are counts."""
    read = Header(header, len(formats))
    rows = [row for frames, payload in chunks for row in Chunk(payload, frames, read).decode()]
    back = sorted(range(len(formats)), key=read.order.__getitem__)
    return [[row[place] for place in back] for row in rows]
