"""How good a ranking of labelled clips is."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Names = NDArray[np.str_]

SPLIT = (("bd", "bk", "dg"), ("mm", "tr"))
"""Actors of HDM05 among whom the nearest clip is sought, and those who ask."""
MOST = 20
"""N of the true-positive ratio."""


def measures(distances: Array, labels: Names, actors: Names) -> dict[str, float | None]:
    """Measure a ranking, every clip being the query once; per cent, each class counting the same.

    Parameters
    ----------
    distances
        (Q, N): row q ranks all clips for the query q, the clip itself included, which does not
        count.
    labels, actors
        (N,).

    Returns
    -------
    dict
        ``true positives``: of the first 20, or as many as there are relevant clips. ``first``,
        ``five``: precision. ``mAP``. The same ``across`` actors, where only clips by others than
        the query's count. ``split``: nearest clips of three actors for queries of two. None where
        there is nothing to measure.

    """
    every = np.ones((len(labels), len(labels)), dtype=bool)
    np.fill_diagonal(every, val=False)
    others = actors[:, None] != actors
    found: dict[str, float | None] = {}
    for suffix, allowed in (("", every), (" across", others)):
        rows = [_ranked(distances[q], labels, labels[q], allowed[q]) for q in range(len(labels))]
        named = {
            "true positives": lambda hits: hits[: min(MOST, int(hits.sum()))].mean(),
            "first": lambda hits: hits[0],
            "five": lambda hits: hits[:5].mean(),
            "mAP": average_precision,
        }
        for name, measure in named.items():
            values = [measure(hits) if hits.any() else np.nan for hits in rows]
            found[name + suffix] = by_class(values, labels)
    found["split"] = _split(distances, labels, actors)
    nearest = np.where(every, distances, np.inf).argmin(axis=1)
    found["nearest by the same actor"] = 100 * float((actors[nearest] == actors).mean())
    return found


def by_class(values: Sequence[float], labels: Names) -> float | None:
    """Give the mean over classes of their queries' means, per cent; NaN values do not count."""
    known = np.array(values, dtype=np.float64)
    means = [
        known[own].mean()
        for label in np.unique(labels)
        if (own := (labels == label) & np.isfinite(known)).any()
    ]
    return 100 * float(np.mean(means)) if means else None


def average_precision(hits: Array) -> float:
    """Give the mean of the precision at each hit, of hits (1) and misses (0), the best first."""
    places = np.flatnonzero(hits)
    return float((np.arange(1, len(places) + 1) / (places + 1)).mean())


def confusion(distances: Array, labels: Names) -> tuple[list[str], Array]:
    """Say of which classes the first clips are (Fig. 7): names, and (C, C) per cent by row.

    As many clips count as in the true-positive ratio, so that a perfect ranking has a diagonal of
    100.
    """
    names = np.unique(labels)
    counts = np.zeros((len(names), len(names)))
    for q, label in enumerate(labels):
        ranked = distances[q].copy()
        ranked[q] = np.inf
        most = min(MOST, int((labels == label).sum()) - 1)
        for clip in np.argsort(ranked, kind="stable")[:most]:
            counts[np.searchsorted(names, label), np.searchsorted(names, labels[clip])] += 1 / most
    sizes = np.array([[max((labels == name).sum(), 1)] for name in names])
    return [str(name) for name in names], 100 * counts / sizes


def _ranked(distances: Array, labels: Names, label: str, allowed: NDArray[np.bool_]) -> Array:
    """Give 1 for clips of a label, 0 for others, the nearest first."""
    clips = np.flatnonzero(allowed)
    order = clips[np.argsort(distances[clips], kind="stable")]
    hits: Array = (labels[order] == label).astype(np.float64)
    return hits


def _split(distances: Array, labels: Names, actors: Names) -> float | None:
    known, asking = (np.flatnonzero(np.isin(actors, group)) for group in SPLIT)
    if not len(known) or not len(asking):
        return None
    nearest = known[distances[np.ix_(asking, known)].argmin(axis=1)]
    return 100 * float((labels[nearest] == labels[asking]).mean())


def summary(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Give means over seeds, and the spread of the true-positive ratio."""
    made: dict[str, Any] = {}
    for name in rows[0]:
        values = [row[name] for row in rows]
        made[name] = None if None in values else float(np.mean(values))
    made["spread"] = float(np.std([row["true positives"] for row in rows]))
    return made
