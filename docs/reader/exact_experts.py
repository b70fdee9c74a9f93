"""Predictors of ``exact``, levels 3 to 9: chains of regressions that learn as they go."""

import math
from typing import TYPE_CHECKING

from exact_skeleton import channels as skeleton_channels

if TYPE_CHECKING:
    from exact import Column, Coupling

TINY = 1e-13
LIMB, WHOLE = 6, 72


class Frames:
    """The levels of the last six frames, of this one as far as they are known."""

    def __init__(self, count: int) -> None:
        self.rows = [[0.0] * count for _ in range(6)]
        self.guesses = [0.0] * count
        """Second differences, of the skeleton."""

    def next(self) -> None:
        """Begin a frame."""
        self.rows.insert(0, self.rows.pop())

    def level(self, channel: int, age: int) -> float:
        """Give the level of a frame that is so old."""
        return self.rows[age][channel]

    def difference(self, channel: int, order: int, age: int) -> float:
        """Give the first or second difference that ends there."""
        one, two = self.rows[age][channel], self.rows[age + 1][channel]
        return one - two if order == 1 else (one - two) - (two - self.rows[age + 2][channel])


class Chain:
    """Every variable from those before it, by least squares over a fading past."""

    def __init__(self, count: int, fading: float, ridge: float) -> None:
        self.fading = fading
        self.diagonal = [ridge] * count
        self.columns = [[0.0] * (count - j - 1) for j in range(count)]
        """L below its diagonal."""
        self.values = [0.0] * count

    def begin(self) -> None:
        """Begin a frame."""
        self.predicted = [0.0] * len(self.values)

    def see(self, variable: int, value: float) -> None:
        """Take the next variable."""
        self.values[variable] = value
        off = value - self.predicted[variable]
        if off != 0:
            later = zip(self.predicted[variable + 1 :], self.columns[variable], strict=True)
            self.predicted[variable + 1 :] = [p + off * factor for p, factor in later]

    def learn(self, weight: float) -> None:
        """Learn from the frame, which is complete."""
        rest = self.values
        for j, column in enumerate(self.columns):
            p, rest = rest[0], rest[1:]
            faded = self.fading * self.diagonal[j]
            grown = faded + weight * (p * p)
            gain = weight * p / (grown + TINY)
            weight = weight * (faded + TINY) / (grown + TINY)
            self.diagonal[j] = grown
            if p != 0:
                rest = [x - p * factor for x, factor in zip(rest, column, strict=True)]
                self.columns[j] = [f + gain * x for f, x in zip(column, rest, strict=True)]

    def numbers(self) -> list[float]:
        """Give what it has learned."""
        return [factor for column in self.columns for factor in column] + self.diagonal

    def take(self, numbers: list[float]) -> None:
        """Begin with what another has learned."""
        given = iter(numbers)
        self.columns = [[next(given) for _ in column] for column in self.columns]
        self.diagonal = list(given)


# A variable: what it is, channels, age.
Variable = tuple[str, tuple[int, ...], int]


class Expert:
    """A chain over chosen variables."""

    def __init__(self, order: int, fading: float, variables: list[Variable]) -> None:
        self.order = order
        self.variables = variables
        self.chain = Chain(len(variables), fading, 0.01)
        self.targets = {
            channels[0]: i for i, (kind, channels, _) in enumerate(variables) if kind == "target"
        }
        self.usual = [0.01] * len(variables)

    def begin(self) -> None:
        """Begin a frame."""
        self.chain.begin()
        self.seen = 0

    def _see(self, end: int, frames: Frames) -> None:
        while self.seen < end:
            self.chain.see(self.seen, self._value(self.variables[self.seen], frames))
            self.seen += 1

    def _value(self, variable: Variable, frames: Frames) -> float:
        kind, channels, age = variable
        if kind == "guess":
            return frames.guesses[channels[0]]
        if kind != "product":
            return frames.difference(channels[0], self.order, age)
        products = []
        for old in (0, 1):
            product = 1 / (1.0 / 30)
            for channel in channels:
                product *= frames.level(channel, old) * (1.0 / 30)
            products.append(product)
        return products[0] - products[1]

    def predict(self, channel: int, frames: Frames) -> float:
        """Give the level of a channel."""
        variable = self.targets[channel]
        self._see(variable, frames)
        expected = frames.level(channel, 1)
        if self.order == 2:
            expected += frames.difference(channel, 1, 1)
        return expected + self.chain.predicted[variable]

    def learn(self, frames: Frames) -> None:
        """Learn from the frame, which is complete."""
        self._see(len(self.variables), frames)
        unusual = 0.0
        for i in self.targets.values():
            off = self.chain.values[i] - self.chain.predicted[i]
            square = off * off
            unusual += min(square / (self.usual[i] + 1e-12), 100.0)
            self.usual[i] += 0.02 * (square - self.usual[i])
        self.chain.learn(1 / math.sqrt(unusual / len(self.targets) + 0.05))


def experts(columns: list["Column"], couplings: list["Coupling"], level: int) -> list[Expert]:
    """Make the experts of a level."""
    count = len(columns)
    made = []
    if level >= 8 and any(column.place is not None for column in columns):
        made += [*geometry(columns, 0, 0.9), *geometry(columns, 2, 0.98)]
    else:
        made += limbs(count, 2)
    made += [Expert(1, 0.99, past([c], 3) + variables("target", [c])) for c in range(count)]
    if level >= 7:
        made += limbs(count, 1)
    if level >= 8:
        blocks = -(-count // WHOLE)
        for block in range(blocks):
            own = range(count * block // blocks, count * (block + 1) // blocks)
            made.append(Expert(1, 0.998, past(own, 1) + variables("target", own)))
    for coupling in couplings:
        if coupling.kind == 0:
            made.append(polynomial(coupling))
    return made


def variables(kind: str, channels: list[int] | range) -> list[Variable]:
    """Give variables of this frame."""
    return [(kind, (channel,), 0) for channel in channels]


def past(channels: list[int] | range, history: int) -> list[Variable]:
    """Give variables of the frames before, oldest first."""
    return [("past", (c,), age) for age in range(history, 0, -1) for c in channels]


def limbs(count: int, order: int) -> list[Expert]:
    """Make experts of six channels each."""
    made = []
    for start in range(0, count, LIMB):
        known = [c for c in range(start) if c < LIMB or c >= start - LIMB]
        own = range(start, min(count, start + LIMB))
        made.append(Expert(order, 0.94, variables("known", known) + variables("target", own)))
    return made


def geometry(columns: list["Column"], history: int, fading: float) -> list[Expert]:
    """Make experts of the limbs of the known skeleton."""
    by_limb: list[tuple[int, list[int]]] = []
    for c, column in enumerate(columns):
        limb = skeleton_channels()[column.place or 0][1]
        if not by_limb or by_limb[-1][0] != limb:
            by_limb.append((limb, []))
        by_limb[-1][1].append(c)
    made = []
    for _, own in by_limb:
        both: list[Variable] = [(kind, (c,), 0) for c in own for kind in ("guess", "target")]
        made.append(Expert(2, fading, past(own, history) + both))
    return made


def polynomial(coupling: "Coupling") -> Expert:
    """Make the expert of a coupling of kind 0."""
    sources = coupling.sources
    told = variables("known", sources)
    for i in range(len(sources)):
        for j in range(i, len(sources)):
            told.append(("product", (sources[i], sources[j]), 0))
            told += [("product", (sources[i], sources[j], k), 0) for k in sources[j:]]
    return Expert(1, 0.9998, told + variables("target", coupling.targets))
