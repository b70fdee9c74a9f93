"""What coders of ``near`` begin with (docs/format/near.md): data files of the format."""

import math
from functools import cache
from pathlib import Path
from typing import NamedTuple

from near_turning import ORDERS, Turning
from streams import Bit, Coded, magnitude, symbol, tree
from tables import numbers

FOLDER = Path(__file__).resolve().parents[2] / "core" / "near" / "data"
NAMES = ("fine", "middling", "coarse")

# Of each set of mixed models: decisions, places of its tables, choices of weights; the tables that
# go by column.
SETS = {
    "knots": (32, (120, 100, 1280, 24, 100, 120, 144, 144), (4, 10), (2,)),
    "classes": (16, (100, 100, 1280, 24, 100, 100, 120, 100), (6, 10), (2,)),
    "numbers": (33, (120, 100, 1280, 24, 160, 120, 144, 432), (16, 60), (2,)),
    "splits": (1, (60, 36, 1280, 24, 60, 40, 144, 216), (6, 10), (2,)),
    "signs": (1, (90, 30, 1152, 9, 27, 90, 81, 1152), (2, 10), (2, 7)),
}

Key = tuple[int, int, int]


def step_of(exponent: int) -> float:
    """Give 2^(exponent / 64)."""
    step, root = 1.0, 2.0
    for bit in (32, 16, 8, 4, 2, 1):
        root = math.sqrt(root)
        if exponent & bit:
            step *= root
    return math.ldexp(step, exponent >> 6)


class Assumed(NamedTuple):
    """What is assumed of a source."""

    shares: tuple[float, float]
    moved: float
    both: float
    averaged: float


class Start(NamedTuple):
    """Entries and weights of each set, and of columns and sources what is assumed."""

    entries: dict[str, dict[Key, list[int]]]
    weights: dict[str, dict[Key, list[int]]]
    assumed: dict[tuple[int, int], Assumed]
    observations: list[int]
    """One: how many what is assumed is worth."""


class Figure(NamedTuple):
    """The known figure."""

    exponents: list[int]
    joints: list[int]
    parents: list[int]
    firsts: list[float]
    turnings: list[Turning]


@cache
def known_figure() -> Figure:
    """Read the figure whose columns are known."""
    values = iter(numbers("figure_1", FOLDER))
    figure = Figure([], [], [], [], [])
    for _ in range(int(next(values))):
        figure.exponents.append(int(next(values)))
        joint, parent = int(next(values)), int(next(values))
        figure.joints.append(joint)
        if joint == len(figure.parents):
            figure.parents.append(parent)
        figure.firsts.append(next(values))
    for _ in range(int(next(values))):
        first, columns, axes, curves = (int(next(values)) for _ in range(4))
        orders = (ORDERS[columns], ORDERS[axes], ORDERS[curves])
        figure.turnings.append(Turning(first, *orders, False))
    return figure


class Taking:
    """A start while it is read."""

    def __init__(self, packed: bytes, chances: dict[int, int]) -> None:
        self.stream, self.chances = Coded(packed), chances
        self.known, self.logits, self.counts = [Bit(), Bit()], tree(6), tree(3)
        self.uses, self.weights = tree(4), tree(8)
        self.start = Start({}, {}, {}, [])

    def models(self, *, by_column: bool) -> None:
        """Take what was learned in the tables that go by column, or in all else."""
        for name, (decisions, sizes, choices, own) in SETS.items():
            entries = self.start.entries.setdefault(name, {})
            for table, size in enumerate(sizes):
                if (table in own) != by_column:
                    continue
                for place in range(size):
                    met = True
                    for decision in range(decisions):
                        met = self.stream.bit(self.known[int(met)])
                        if met:
                            entries[table, place, decision] = self.entry()
            if by_column:
                continue
            weights = self.start.weights.setdefault(name, {})
            for of, count_of in enumerate(choices):
                for choice in range(count_of):
                    for decision in range(decisions):
                        uses = symbol(self.stream, self.uses)
                        if uses:
                            parts = [symbol(self.stream, self.weights) for _ in range(16)]
                            each = [(part - 128) * 1024 for part in parts]
                            weights[of, choice, decision] = [*each, 1 << uses - 1]

    def entry(self) -> list[int]:
        """Take a chance, and how often it was met."""
        logit = (symbol(self.stream, self.logits) << 5) - 1008
        chance = min(max(self.chances[logit], 64), 65471)
        return [chance, chance, 1 << symbol(self.stream, self.counts)]

    def sources(self) -> None:
        """Take what is assumed of sources."""
        trees = [tree(6) for _ in range(3)]
        shares, products, both = [tree(8), tree(8)], [tree(8), tree(8)], tree(8)

        def count(models: list[Bit]) -> int:
            return magnitude(self.stream, symbol(self.stream, models)) - 1

        def number(models: list[Bit]) -> int:
            return symbol(self.stream, models) - 128

        column = source = 0
        self.start.observations.append(count(trees[0]))
        for _ in range(count(trees[0])):
            further = count(trees[1])
            if further:
                column, source = column + further, 0
            source += count(trees[2])
            one, other = (number(models) / 64 for models in shares)
            moved, averaged = (step_of(16 * number(models)) for models in products)
            like = number(both) / 64 * math.sqrt(moved * averaged)
            self.start.assumed[column, source] = Assumed((one, other), moved, like, averaged)


@cache
def start_of(index: int, known: bool, chances: tuple[tuple[int, int], ...]) -> Start:
    """Read one of the shipped starts; by columns only for the known figure."""
    packed = bytes(int(number) for number in numbers(f"start_{NAMES[index]}_1", FOLDER))
    taking = Taking(packed, dict(chances))
    taking.models(by_column=False)
    if known:
        taking.models(by_column=True)
        taking.sources()
    return taking.start
