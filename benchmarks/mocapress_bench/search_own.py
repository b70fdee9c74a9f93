"""The product's own search, as a method of the benchmark."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.search.index import Entry, entry_of
from mocapress.search.ranking import CLOSELY, find, rank
from mocapress.search.standard import standard_motion
from mocapress_bench.search_data import RATE, Take
from mocapress_bench.search_rivals import Index
from mocapress_bench.search_stretches import Finder, Hit, Long

Array = NDArray[np.float64]

_BEHIND = 1e6
"""Above all scores."""


def own_search(takes: Sequence[Take], seed: int) -> Index:  # noqa: ARG001
    """Index by signatures, of which the nearest are compared again, as in a search for twenty."""
    motions = [standard_motion(take.clip) for take in takes]
    entries = [entry_of(motion) for motion in motions]
    return Index(
        lambda i: ranked_by(entries[i], entries),
        float(np.mean([len(entry.signature) + len(entry.features) for entry in entries])),
        lambda i: ranked_by(entry_of(motions[i].mirrored()), entries),
        lambda i: ranked_by(entry_of(motions[i].mirrored()), entries, entries[i]),
    )


def ranked_by(query: Entry, entries: Sequence[Entry], mirrored: Entry | None = None) -> Array:
    """Give scores of all clips: behind those that are compared again come others by signatures."""
    asked = [_numbers(one) for one in (query, mirrored) if one is not None]
    kept = np.array([_numbers(entry) for entry in entries])
    found: Array = _BEHIND + np.min([np.linalg.norm(kept - own, axis=1) for own in asked], axis=0)
    for hit in rank(
        query,
        [entry.signature for entry in entries],
        lambda i: entries[i].features,
        len(entries),
        mirrored=mirrored,
        closely=CLOSELY,
    ):
        found[hit.place] = hit.score
    return found


def own_signatures(takes: Sequence[Take], seed: int) -> Index:  # noqa: ARG001
    """Index by signatures alone."""
    motions = [standard_motion(take.clip) for take in takes]
    made = np.array([_numbers(entry_of(motion)) for motion in motions])
    return Index(
        lambda i: np.linalg.norm(made - made[i], axis=1),
        float(made.shape[1]),
        lambda i: np.linalg.norm(made - _numbers(entry_of(motions[i].mirrored())), axis=1),
    )


def own_stretches(longs: Sequence[Long]) -> Finder:
    """Find stretches by the features that are kept for that."""
    kept = [entry_of(standard_motion(long.take.clip)).features for long in longs]

    def search(query: Take, most: int) -> list[Hit]:
        hits = find(entry_of(standard_motion(query.clip)), enumerate(kept), most)
        return [
            Hit(hit.score, hit.place, round(RATE * hit.start), round(RATE * hit.end))
            for hit in hits
        ]

    return search


def _numbers(entry: Entry) -> Array:
    return np.frombuffer(entry.signature, np.int8).astype(np.float64)
