"""Chains, experts and the blend of ``exact`` (docs/format/exact.md, "Experts" and "Blend")."""

import math
from collections.abc import Callable, Iterable
from functools import partial
from itertools import groupby

from exact_functions import cut, total
from exact_skeleton import LIMBS, Levels, Skeleton

Variable = Callable[[], float]


class Chain:
    """Experts: variables that are predicted from those before them."""

    def __init__(self, count: int, fading: float, start: float) -> None:
        self.fading, self.d = fading, [start] * count
        self.triangle = [[0.0] * (count - 1 - j) for j in range(count)]
        """Of each column what is below the diagonal."""
        self.begin()

    def begin(self) -> None:
        """Begin a frame."""
        self.seen, self.errors = list[float](), list[float]()
        self.ahead = [0.0] * len(self.d)

    def prediction(self) -> float:
        """Predict the next variable."""
        return self.ahead[len(self.seen)]

    def see(self, value: float) -> None:
        """See the next variable."""
        error = value - self.prediction()
        for i, factor in enumerate(self.triangle[len(self.seen)], len(self.seen) + 1):
            self.ahead[i] += error * factor
        self.seen.append(value)
        self.errors.append(error)

    def learn(self, alpha: float) -> None:
        """Learn from a frame with a weight."""
        x = self.seen
        for j, column in enumerate(self.triangle):
            p = x[j]
            d = self.fading * self.d[j]
            g = self.d[j] = d + alpha * (p * p)
            b = alpha * p / (g + 1e-13)
            alpha = alpha * (d + 1e-13) / (g + 1e-13)
            if p:
                for i, factor in enumerate(column, j + 1):
                    x[i] -= p * factor
                    column[i - j - 1] = factor + b * x[i]
        self.begin()


class Expert:
    """Experts: a chain of differences of levels, some of which it predicts."""

    def __init__(
        self,
        levels: Levels,
        slot: int | None,
        order: int,
        fading: float,
        targets: Iterable[int],
        before: Iterable[tuple[int, int]] = (),
        products: Iterable[Variable] = (),
        guess: Callable[[int], float] | None = None,
    ) -> None:
        """Take channels and ages of the variables before the targets, and what stands behind."""
        self.levels, self.slot, self.order = levels, slot, order
        difference = partial(levels.difference, order)
        self.variables: list[Variable] = [partial(difference, c, age) for c, age in before]
        self.variables += products
        self.targets = dict[int, int]()
        """Channel, and which variable it is."""
        for c in targets:
            if guess:
                self.variables.append(partial(guess, c))
            self.targets[c] = len(self.variables)
            self.variables.append(partial(difference, c, 0))
        self.chain = Chain(len(self.variables), fading, 0.01)
        self.squares = dict.fromkeys(self.targets, 0.01)

    def _see(self, count: int) -> None:
        for variable in self.variables[len(self.chain.seen) : count]:
            self.chain.see(variable())

    def predict(self, c: int) -> float:
        """Predict the level of a target."""
        self._see(self.targets[c])
        known = self.levels.past[c][1]
        if self.order == 2:
            known += self.levels.difference(1, c, 1)
        return known + self.chain.prediction()

    def learn(self) -> None:
        """Learn from a frame."""
        self._see(len(self.variables))
        u = 0.0
        for c, place in self.targets.items():
            square, m = self.chain.errors[place] * self.chain.errors[place], self.squares[c]
            u += min(square / (m + 1e-12), 100.0)
            self.squares[c] = m + 0.02 * (square - m)
        self.chain.learn(1 / math.sqrt(u / len(self.targets) + 0.05))


def make_experts(
    level: int,
    levels: Levels,
    columns: list[int],
    skeleton: Skeleton | None,
    polynomials: list[tuple[list[int], list[int]]],
) -> list[Expert]:
    """Make the experts of channels, of which ``columns`` are the columns of the clip."""
    n, make = len(columns), partial(Expert, levels)

    def limbs(slot: int, order: int, fading: float) -> list[Expert]:
        """Make those of blocks, with the first channels."""
        blocks = [range(at, min(at + 6, n)) for at in range(0, n, 6)]
        known = [[c for c in range(b[0]) if c < 6 or c >= b[0] - 6] for b in blocks]
        return [
            make(slot, order, fading, block, [(c, 0) for c in before])
            for block, before in zip(blocks, known, strict=True)
        ]

    if skeleton:
        runs = [list(run) for _, run in groupby(range(n), lambda c: LIMBS[columns[c]])]
        experts = [make(0, 2, 0.9, run, guess=skeleton.guess) for run in runs]
        for run in runs if level == 9 else []:
            older = [(c, age) for age in (2, 1) for c in run]
            experts.append(make(1, 2, 0.98, run, older, guess=skeleton.guess))
    else:
        experts = limbs(0, 2, 0.92 if level == 6 else 0.9)
        experts += limbs(1, 2, 0.75) if level >= 8 else []
    experts += [make(2, 1, 0.97, [c], [(c, 3), (c, 2), (c, 1)]) for c in range(n)]
    count = -(-n // 160)
    wide = [range(n * b // count, n * (b + 1) // count) for b in range(count)]
    if skeleton and level == 9:
        experts += limbs(3, 1, 0.94)
        experts += [make(4, 1, 0.998, block, [(c, 1) for c in block]) for block in wide]
    elif not skeleton and level >= 7:
        experts += limbs(3, 1, 0.97)
        experts += [make(4, 2, 0.95, block) for block in wide] if level >= 8 else []
    for sources, targets in polynomials:
        known = [(c, 0) for c in sources]
        experts.append(make(None, 1, 0.9998, targets, known, products(levels, sources)))
    return experts


def products(levels: Levels, sources: list[int]) -> list[Variable]:
    """Give the products of two and of three sources."""

    def value(factors: tuple[int, ...], age: int) -> float:
        told = 1 / (1 / 30)
        for c in factors:
            told *= levels.past[c][age] * (1 / 30)
        return told

    found: list[tuple[int, ...]] = []
    for i, one in enumerate(sources):
        for j, two in enumerate(sources[i:], i):
            found += [(one, two), *((one, two, three) for three in sources[j:])]
    return [partial(lambda factors: value(factors, 0) - value(factors, 1), own) for own in found]


class Blend:
    """Blend: one move out of the predictions."""

    def __init__(self, count: int, fadings: tuple[float, ...], ridge: float) -> None:
        self.chains = [Chain(count, fading, ridge) for fading in fadings if count > 1]
        self.v = [1.0 for _ in fadings]

    def mix(self, moves: list[float], mean: float) -> float:
        """Give the move."""
        for chain in self.chains:
            for p in moves[1:]:
                chain.see(p - mean)
        self.mean, self.h = mean, [chain.prediction() for chain in self.chains]
        if len(self.h) < 2:
            return mean + total(self.h)
        squares = [v * v + 1e-12 for v in self.v]
        w = [1 / (s * s) for s in squares]
        return mean + total(a * b for a, b in zip(w, self.h, strict=True)) / total(w)

    def learn(self, e: float, scale: float) -> None:
        """Learn from the move that was right."""
        for k, (chain, h) in enumerate(zip(self.chains, self.h, strict=True)):
            error = (e - self.mean - h) / scale
            self.v[k] += 0.05 * (min(error * error, 25.0) - self.v[k])
            chain.see(cut(error, -6.0, 6.0) * scale + h)
            chain.learn(1 / (scale * scale))
