"""Search by example: methods beside each other on labelled clips."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.qssd.decomposition import ComponentSums, learn
from mocapress.search.qssd import ATOMS, MOST, dictionary_of, displacements, distances, mirrored
from mocapress_bench import search_rivals as rivals
from mocapress_bench.search_bodies import Bodies, Seen, of_bones, of_joints
from mocapress_bench.search_data import Take, labels_of
from mocapress_bench.search_measures import confusion, measures, summary
from mocapress_bench.search_own import own_search, own_signatures
from mocapress_bench.search_projection import held_out
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
    bones: bool = False
    """Of bones' turns, as the product's; otherwise of joints' rotations."""
    published: bool = False
    """Begin with frames drawn at random, and take the first frame as the reference."""
    components: bool = False
    """K-SVD on the quaternions' four components."""

    def __call__(self, takes: Sequence[Take], seed: int) -> Index:
        """Decompose all clips."""
        own = np.array([self._dictionary(take, seed) for take in takes])
        return Index(
            lambda i: distances(own[i], own, dots=self.dots),
            _FLOAT * own[0].size,
            (lambda i: distances(mirrored(own[i]), own, dots=self.dots)) if self.bones else None,
        )

    def _dictionary(self, take: Take, seed: int) -> Array:
        turns = (take.bones if self.bones else take.turns)[::_EVERY]
        if self.components:
            own = displacements(turns, first=True)
            learned = learn(ComponentSums(), own, ATOMS, MOST, iterations=_ITERATIONS, seed=seed)
            return learned.dictionary
        if self.published:
            return dictionary_of(
                turns, sums=self.sums, iterations=_ITERATIONS, seed=seed, first=True
            )
        return dictionary_of(turns, sums=self.sums)


RIVALS = {
    "weighted PCA (Forbes 2005)": rivals.weighted_pca,
    "motion patterns (Deng 2009)": rivals.motion_patterns,
    "motion index tree (Liu 2003)": rivals.motion_index_tree,
    "motion words (Aristidou 2018)": rivals.motion_words,
}
_DRAWN_RIVALS = ("motion patterns (Deng 2009)", "motion words (Aristidou 2018)")


def _seen(
    rival: Callable[[Bodies, int], Index], seen: Seen, takes: Sequence[Take], seed: int
) -> Index:
    return rival(seen(takes), seed)


HELD_OUT = "mocapress, by projections that have not seen the query's subject"
"""Only of the clips that the projection which is shipped has learned from."""
METHODS: dict[str, Method] = {
    "mocapress": own_search,
    "mocapress, signatures alone": own_signatures,
    HELD_OUT: held_out,
    "QSSD as published": Dictionaries(published=True),
    "QSSD as published, scalar products of quaternions": Dictionaries(published=True, dots=True),
    "K-SVD as published, components": Dictionaries(components=True),
    "K-SVD as published, logarithms": Dictionaries(sums=True, published=True),
    "QSSD": Dictionaries(),
    "K-SVD": Dictionaries(sums=True),
    "QSSD of bones": Dictionaries(bones=True),
    "QSSD of bones, scalar products of quaternions": Dictionaries(bones=True, dots=True),
    "K-SVD of bones": Dictionaries(bones=True, sums=True),
    "match webs (Kovar 2004)": rivals.match_webs,
    **{
        name + told: partial(_seen, rival, seen)
        for told, seen in (("", of_joints), (", bones", of_bones))
        for name, rival in RIVALS.items()
    },
}
CONFUSED = ("K-SVD as published, components", "QSSD as published", "QSSD of bones")
DRAWN = {
    "QSSD as published",
    "QSSD as published, scalar products of quaternions",
    "K-SVD as published, components",
    "K-SVD as published, logarithms",
    *(f"{name}{told}" for name in _DRAWN_RIVALS for told in ("", ", bones")),
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
        row["mirrored"] = row["mirrored, option"] = None
        if index.mirrored is not None:
            other = np.array([index.mirrored(i) for i in range(len(takes))])
            both = np.minimum(ranked, other)
            if index.either is not None:
                both = np.array([index.either(i) for i in range(len(takes))])
            for told, ranks in (("", other), (", option", both)):
                row["mirrored" + told] = measures(ranks, labels, actors)["true positives"]
        row["ms a clip"] = 1000 * (made - start) / len(takes)
        row["ms a query"] = 1000 * (asked - made) / len(takes)
        row["bytes"] = index.bytes
        rows.append(row)
    confused = confusion(ranked, labels) if name in CONFUSED else None
    return Measured({"method": name, "seeds": len(rows), **summary(rows)}, confused, ranked)
