"""Search by example: methods beside each other on labelled clips."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.search.qssd import dictionary_of, distances
from mocapress_bench import search_rivals as rivals
from mocapress_bench.search_data import Take, labels_of
from mocapress_bench.search_measures import confusion, measures, summary
from mocapress_bench.search_rivals import Index

Array = NDArray[np.float64]
Method = Callable[[Sequence[Take], int], Index]
Progress = Callable[[str], None]

_EVERY = 2
"""Decomposed are 15 frames a second."""
_FLOAT = 4
_ITERATIONS = 10
"""Of what is begun at random; more bring nothing."""


@dataclass(frozen=True, slots=True)
class Dictionaries:
    """Dictionaries of poses: QSSD's, or K-SVD's on logarithms."""

    sums: bool = False
    dots: bool = False
    published: bool = False
    """Begin with frames drawn at random, and take the first frame as the reference."""

    def __call__(self, takes: Sequence[Take], seed: int) -> Index:
        """Decompose all clips."""
        made = []
        for take in takes:
            turns = take.turns[::_EVERY]
            if self.published:
                made.append(
                    dictionary_of(
                        turns, sums=self.sums, iterations=_ITERATIONS, seed=seed, first=True
                    )
                )
            else:
                made.append(dictionary_of(turns, sums=self.sums))
        own = np.array(made)
        return Index(lambda i: distances(own[i], own, dots=self.dots), _FLOAT * own[0].size)


METHODS: dict[str, Method] = {
    "QSSD": Dictionaries(),
    "QSSD, scalar products of quaternions": Dictionaries(dots=True),
    "QSSD, from random frames": Dictionaries(published=True),
    "K-SVD, logarithms": Dictionaries(sums=True),
    "K-SVD, logarithms, from random frames": Dictionaries(sums=True, published=True),
    "weighted PCA (Forbes 2005)": rivals.weighted_pca,
    "match webs (Kovar 2004)": rivals.match_webs,
    "motion patterns (Deng 2009)": rivals.motion_patterns,
    "motion index tree (Liu 2003)": rivals.motion_index_tree,
    "motion words (Aristidou 2018)": rivals.motion_words,
}
CONFUSED = ("QSSD", "K-SVD, logarithms")
DRAWN = {
    "QSSD, from random frames",
    "K-SVD, logarithms, from random frames",
    "motion patterns (Deng 2009)",
    "motion words (Aristidou 2018)",
}
"""Methods whose result depends on the seed."""


@dataclass(slots=True)
class Measured:
    """A method on a set of clips."""

    row: dict[str, Any]
    confused: tuple[list[str], Array] | None = None
    """Classes and the confusion matrix, per cent."""
    distances: Array = field(default_factory=lambda: np.empty(0))


def measure(name: str, method: Method, takes: Sequence[Take], seeds: int) -> Measured:
    """Rank all clips for each clip as the query.

    Parameters
    ----------
    name
        Of the method.
    method
        Makes an index of clips.
    takes
        Labelled clips.
    seeds
        How often a method that draws is run.

    """
    labels, actors = labels_of(takes)
    rows = []
    for seed in range(seeds if name in DRAWN else 1):
        start = time.process_time()
        index = method(takes, seed)
        made = time.process_time()
        ranked = np.array([index.distances(i) for i in range(len(takes))])
        asked = time.process_time()
        row: dict[str, Any] = measures(ranked, labels, actors)
        row["ms a clip"] = 1000 * (made - start) / len(takes)
        row["ms a query"] = 1000 * (asked - made) / len(takes)
        row["bytes"] = index.bytes
        rows.append(row)
    confused = confusion(ranked, labels) if name in CONFUSED else None
    return Measured({"method": name, "seeds": len(rows), **summary(rows)}, confused, ranked)
