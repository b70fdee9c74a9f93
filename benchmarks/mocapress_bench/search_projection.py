"""How the projection of search's signatures is learned, and search by one that has not seen all."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.search.features import features
from mocapress.search.index import Entry, entry_of
from mocapress.search.signatures import BYTES, Projection, description
from mocapress.search.standard import standard_motion
from mocapress_bench.search_data import Take, labels_of
from mocapress_bench.search_own import ranked_by
from mocapress_bench.search_rivals import Index

Array = NDArray[np.float64]

SHRUNK = 0.5
"""Share of the mean variance in the variances within classes."""
RANGE = 5.0
"""Deviations of a signature's elements that int8 holds."""


def learned(descriptions: Array, classes: Sequence[str | None]) -> Projection:
    """Learn from descriptions (N, R) of clips, and of what class each is, where that is known."""
    mean = descriptions.mean(axis=0)
    _, _, ways = np.linalg.svd(descriptions - mean, full_matrices=False)
    basis = ways[:BYTES].T
    coordinates = (descriptions - mean) @ basis
    names = np.array(classes, dtype=object)
    within = []
    for name in sorted({name for name in classes if name}):
        of = coordinates[names == name]
        if len(of) > 1:
            of = of - of.mean(axis=0)
            within.append(of.T @ of / len(of))
    scatter = np.mean(within, axis=0)
    usual = np.trace(scatter) / BYTES
    sizes, axes = np.linalg.eigh((1 - SHRUNK) * scatter + SHRUNK * usual * np.eye(BYTES))
    matrix = basis @ (axes / np.sqrt(sizes))
    step = RANGE * float(((descriptions - mean) @ matrix).std()) / 127
    return Projection(mean, matrix, step)


def held_out(takes: Sequence[Take], seed: int) -> Index:  # noqa: ARG001
    """Search by the projection that is learned from clips by all actors but the query's."""
    motions = [standard_motion(take.clip) for take in takes]
    records = [entry_of(motion).features for motion in motions]
    descriptions = np.array([description(features(motion)) for motion in motions])
    labels, actors = labels_of(takes)
    entries: dict[str, list[Entry]] = {}
    for actor in np.unique(actors).tolist():
        seen = actors != actor
        made = learned(descriptions[seen], labels[seen].tolist())
        signatures = np.round((descriptions - made.mean) @ made.matrix / made.step)
        kept = signatures.clip(-127, 127).astype(np.int8)
        entries[actor] = [
            Entry(own.tobytes(), data) for own, data in zip(kept, records, strict=True)
        ]
    return Index(
        lambda i: ranked_by(entries[actors[i]][i], entries[actors[i]]),
        float(BYTES + np.mean([len(data) for data in records])),
    )
