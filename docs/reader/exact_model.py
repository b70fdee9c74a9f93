"""Channels of ``exact`` at levels 6 to 10 (docs/format/exact.md)."""

import math
from itertools import islice

from exact_coding import Coding, Noise
from exact_experts import Blend, make_experts
from exact_functions import cut, exp, ln, rounded_away, total
from exact_header import Column, Coupling
from exact_last import LastStage, Network, Shared
from exact_laws import Law, make_law
from exact_skeleton import Levels, Skeleton
from streams import Bit, Coded


class Told:
    """Laws as predictions: what a law or a joint tells about one of its targets."""

    def __init__(self, coupling: Coupling, target: int, law: Law, levels: Levels) -> None:
        """Take which of the targets it is, and the law, which they share."""
        self.coupling, self.target, self.law, self.levels = coupling, target, law, levels
        self.channel = coupling.targets[target]
        self.frames, self.t, self.m = 0, 0.0, 0.0
        self.errors = [0.0] * 4

    def predict(self) -> list[float]:
        """Give three moves."""
        last = self.levels.past[self.channel][1]
        angle = self._angle(self.levels.number(self.channel, 1))
        t = cut(angle * self.levels.units[self.channel], -1e6, 1e6)
        a = t - last
        m = last - self.t if self.frames > 0 else 0.0
        b = a + m
        third = b + (m - self.m) if self.frames > 1 else b
        self.t, self.m, self.frames = t, m, self.frames + 1
        return [a, b, third]

    def _angle(self, before: float) -> float:
        """Give the angle next to the one before."""
        sources = [cut(self.levels.number(c, 0), -1e5, 1e5) for c in self.coupling.sources]
        known = [self.levels.number(c, 0) for c in self.coupling.targets[: self.target]]
        told = [without_turns(x, before) for x in self.law(self.target, sources, known)]
        return min(told, key=lambda x: abs(x - before), default=before)

    def choose(self, moves: list[float]) -> float:
        """Choice: take one of the law's moves and the blend's."""
        self.moves = moves
        return moves[self.errors.index(min(self.errors))]

    def learn(self, e: float, scale: float) -> None:
        """Choice: learn from the move that was right."""
        for i, p in enumerate(self.moves):
            self.errors[i] += 0.1 * (min(abs(e - p), 20 * scale) - self.errors[i])


def make_told(couplings: list[Coupling], levels: Levels) -> dict[int, Told]:
    """Make what laws and joints tell, by the channel."""
    told: dict[int, Told] = {}
    for one in couplings:
        if one.kind > 0:
            law = one.joint.tell if one.joint else make_law(one.kind)
            told |= {c: Told(one, i, law, levels) for i, c in enumerate(one.targets)}
    return told


def without_turns(angle: float, before: float) -> float:
    """Laws as predictions: take whole turns from an angle."""
    k = (before - angle) / 360
    return angle + 360 * rounded_away(k) if abs(k) < 1e5 else before


class Spread:
    """Spread: how far numbers of a channel are from their predictions."""

    def __init__(self) -> None:
        self.weights = [-0.1, 0.4, 0.2, 0.5, 0.15, 0.03]
        self.features = [0.0] * 6
        self.means, self.last, self.count = [0.0] * 3, 0.0, 0

    def next(self, doubt: float, floor: float, activity: float, first: float) -> float:
        """Give the spread."""
        self.value = max(exp(first), floor)
        if self.count > 0:
            fast, middle, slow = self.means
            s = m = ln(middle + floor)
            near = [cut(ln(x + floor) - m, -3.0, 3.0) for x in (fast, slow, doubt)]
            self.features = [1.0, near[0], near[1], activity, near[2], self.last]
            for weight, feature in zip(self.weights, self.features, strict=True):
                s += weight * feature
            self.value = max(exp(cut(s, -600.0, 600.0)), 0.2 * floor)
        return self.value

    def learn(self, error: float, activity: float) -> float:
        """Learn from an error; give the activity of all channels behind it."""
        rho, z = error * (1 / self.value), abs(error)
        if self.count > 0:
            g = cut(5 * (rho * rho) / (4 + rho * rho) - 1, -2.0, 2.0)
            for i, feature in enumerate(self.features):
                self.weights[i] = cut(self.weights[i] + (0.003 * g) * feature, -4.0, 4.0)
            self.last = cut(ln(abs(rho) + 0.1) + 0.5, -2.0, 3.0)
            activity += 0.15 * (self.last - activity)
            z = min(z, 20 * self.value)
        self.count += 1
        for i, rate in enumerate((0.4, 0.12, 0.03)):
            self.means[i] += max(rate, 1 / self.count) * (z - self.means[i])
        return activity


Fadings = tuple[tuple[float, ...], float]
"""Blend: λ of its chains, and r."""


class Channel:
    """A channel: what is kept of it from frame to frame."""

    def __init__(
        self, column: Column, told: Told | None, count: int, blend: Fadings, chances: list[int]
    ) -> None:
        """Take how many experts predict it, λ and r of its blend, and chances of its buckets."""
        self.column, self.told, self.chances = column, told, chances
        self.joint = told.coupling.joint if told else None
        self.law = None if self.joint else told
        self.blend, self.spread = Blend(count + (3 if told else 0), *blend), Spread()
        self.stage = LastStage() if not told else None
        self.low = {0: 0.0, 1: -180.0, 2: 0.0}[column.turns]
        self.edges = [Bit() for _ in range(32)]

    def begin(self, learned: list[float]) -> None:
        """Model: begin with the list of the column, if it is as long as it must be."""
        chains = self.blend.chains
        lists = [self.spread.weights]
        for chain in chains:
            lists += [*chain.triangle, chain.d]
        lists += [self.told.errors] if self.told else []
        numbers = iter(learned)
        if len(learned) == sum(map(len, lists)):
            for numbers_of in lists:
                numbers_of[:] = islice(numbers, len(numbers_of))

    def turns(self, q: float) -> float:
        """Whole turns: give those of a prediction."""
        return 360 * whole((q - self.low) / 360) if self.column.turns else 0.0

    def edge(self, coding: Coding, i: float, width: float) -> float:
        """Whole turns: give the one more, if the number lies behind an edge of the range."""
        a = (i if i < 180 else 360 - i) / width
        if self.column.turns and a < 16 and coding.stream.bit(self.edges[max(int(2 * a), 0)]):
            return -360 if i < 180 else 360
        return 0.0


def whole(x: float) -> float:
    """Whole turns: round down; 0 for large numbers."""
    return math.floor(x) if abs(x) < 1e5 else 0.0


class Part:
    """A part of the columns."""

    def __init__(
        self,
        stream: Coded,
        level: int,
        columns: list[Column],
        couplings: list[Coupling],
        known: bool,
        lists: dict[int, list[float]],
    ) -> None:
        """Take whether the skeleton is known, and the lists of the model."""
        self.stream = stream
        self.coding = Coding(stream, lists.get(-1, []))
        predicted = [column for column in columns if not column.noise]
        places = [column.place for column in predicted]
        self.levels, self.activity = Levels([column.unit for column in predicted]), 0.0
        self.first_error = -1.0
        self.skeleton = Skeleton(places, self.levels) if known and level > 7 else None
        told = make_told(couplings, self.levels)
        polynomials = [(one.sources, one.targets) for one in couplings if one.kind == 0]
        self.experts = make_experts(min(level, 9), self.levels, places, self.skeleton, polynomials)
        self.experts_of = [
            [one for one in self.experts if c in one.targets] for c in range(len(predicted))
        ]
        self.channels = []
        blend: Fadings = ((0.94, 0.985, 0.998), 1.0)
        if level == 10:
            blend = ((0.92, 0.985, 0.998), 10.0)
        elif level < (9 if self.skeleton else 8):
            blend = ((0.94,), 1.0)
        for c, column in enumerate(predicted):
            chances = list(self.coding.slow)
            channel = Channel(column, told.get(c), len(self.experts_of[c]), blend, chances)
            channel.begin(lists.get(column.place, []))
            self.channels.append(channel)
        self.shared, self.products = Shared(), dict[int, list[float]]()
        self.network = Network(len(predicted), tuned=level == 10) if level >= 7 else None
        noise = [column for column in columns if column.noise]
        self.noises = [Noise(column.line, lists.get(column.place, [])) for column in noise]

    def frame(self, *, first: bool) -> list[float]:
        """Payload: take a frame."""
        noise = [column.next(self.stream) for column in self.noises]
        if first or self.stream.chance(65512):
            numbers = [self.coding.first(channel.column.line) for channel in self.channels]
            for past, x, unit in zip(self.levels.past, numbers, self.levels.units, strict=True):
                past[:] = [level_of(x, unit)] * 5
            return numbers + noise
        for past in self.levels.past:
            past[1:] = past[:4]
        if self.skeleton:
            self.skeleton.next_frame()
        if self.network:
            self.network.next_frame()
        self.products.clear()
        numbers = [self._number(c) for c in range(len(self.channels))]
        self.shared.learn(self.products, len(numbers))
        for expert in self.experts:
            expert.learn()
        return numbers + noise

    def _number(self, c: int) -> float:
        """Take the number of a channel ("A channel")."""
        channel, past, unit = self.channels[c], self.levels.past[c], self.levels.units[c]
        line, last = channel.column.line, past[1]
        moves = [expert.predict(c) - last for expert in self.experts_of[c]]
        told = channel.told.predict() if channel.told else []
        share = 1 / len(moves)
        mean = told[0] if channel.joint else total(moves) * share
        p = channel.blend.mix(moves + told, mean)
        if channel.law:
            p = channel.law.choose([*told, p])
        q = cut(last + p, -1e6, 1e6) / unit
        w = channel.turns(q)
        step = line.step(q - w) * unit
        loose = channel.joint.loose if channel.joint else 1.0
        doubt = loose * step if channel.joint else total(abs(x - p) for x in moves) * share
        floor = (0.1 * step + 1e-9) / loose
        scale = loose * channel.spread.next(doubt / loose, floor, self.activity, self.first_error)
        u, m, n = scale + step, p, 0.0
        if stage := channel.stage:
            experts = zip(self.experts_of[c], moves, strict=True)
            far = {one.slot: x - p for one, x in experts if one.slot is not None}
            m = p + (stage.apart(far) + stage.past(u) * u)
            if self.network:
                told_of = self.levels.difference(1, c, 1), scale, step, channel.spread.features[1:]
                n, scale = self.network.tell(c, stage, far, *told_of)
            q = cut(last + (m + n), -1e6, 1e6) / unit
            w = channel.turns(q)
        width = (scale + 0.15 * step) / unit
        w += channel.edge(self.coding, q - w - channel.low, width)
        x = self.coding.beside(line, channel.chances, q - w, width)
        since = 360 * whole((last / unit - x) / 360 + 0.5) if channel.column.turns else 0.0
        past[0] = level_of(x + since, unit)
        e = past[0] - last
        channel.blend.learn(e, u)
        if channel.law:
            channel.law.learn(e, u)
        if stage:
            self.products[c] = stage.learn(e - p, self.shared.weights)
        if self.network:
            if stage:
                self.network.learn((e - (m + n)) / (scale + 0.15 * step))
            self.network.see(c, e - p, u)
        if channel.spread.count == 0:
            size = ln(abs((e - m) / loose) + 1e-3)
            self.first_error += 0.2 * (size - self.first_error)
        self.activity = channel.spread.learn((e - m) / loose, self.activity)
        return x


def level_of(x: float, unit: float) -> float:
    """Levels: the level of a number."""
    return 0.0 if x != x else cut(x * unit, -1e6, 1e6)
