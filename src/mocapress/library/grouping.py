"""Clips of a library that move alike, in groups: clusters, and takes that are nearly the same."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.library.clips import StoredClip, by_id
from mocapress.library.searching import Searchable

if TYPE_CHECKING:
    from mocapress.library.reading import Reading

Array = NDArray[np.float64]

_MOST = 10_000
"""Clips that are grouped: their distances from each other are all in memory."""
_MOST_CLUSTERS = 40
"""That are tried where nobody says how many there are to be."""


class Group(NamedTuple):
    """Clips that move alike."""

    clips: list[StoredClip]
    """The one in the middle first, then by their distance from it."""


def clusters(library: "Reading", count: int | None = None) -> list[Group]:
    """Group all clips; see ``Library.clusters``."""
    from scipy.cluster.hierarchy import fcluster, linkage
    from scipy.spatial.distance import squareform

    if count is not None and count < 1:
        raise ParameterError("clusters", expected="at least 1", found=str(count))
    searchable = library.searchable()
    apart = _distances(searchable)
    if len(apart) < 2:
        return _groups(library, searchable, apart, np.zeros(len(apart), np.intp))
    tree = linkage(squareform(apart, checks=False), "average")
    counts = [count] if count else range(2, min(_MOST_CLUSTERS, len(apart) - 1) + 1)
    cuts = [fcluster(tree, number, "maxclust") for number in counts] or [np.ones(len(apart))]
    best = max(cuts, key=lambda cut: _silhouette(apart, cut)) if len(cuts) > 1 else cuts[0]
    return _groups(library, searchable, apart, best)


def _distances(searchable: Searchable) -> Array:
    """Give the distances of all signatures from each other."""
    if len(searchable.clips) > _MOST:
        raise UnsupportedError(
            "too many clips to be grouped",
            expected=f"at most {_MOST}",
            found=str(len(searchable.clips)),
        )
    known = np.array([np.frombuffer(one, np.int8) for one in searchable.signatures], np.float64)
    if not len(known):
        return np.zeros((0, 0))
    squares = (known**2).sum(axis=1)
    apart: Array = np.sqrt(np.maximum(squares[:, None] + squares - 2 * known @ known.T, 0))
    np.fill_diagonal(apart, 0)
    return apart


def _silhouette(apart: Array, cut: NDArray[np.intp]) -> float:
    """Say how well clips fit their clusters: Rousseeuw, Silhouettes, 1987."""
    _, of, sizes = np.unique(cut, return_inverse=True, return_counts=True)
    every = np.arange(len(of))
    sums = apart @ np.eye(len(sizes))[of]
    own = sums[every, of] / np.maximum(sizes[of] - 1, 1)
    means = sums / sizes
    means[every, of] = np.inf
    other = means.min(axis=1)
    fits = np.where(sizes[of] > 1, (other - own) / np.maximum(np.maximum(other, own), 1e-9), 0)
    return float(fits.mean())


def _groups(
    library: "Reading", searchable: Searchable, apart: Array, cut: NDArray[np.intp]
) -> list[Group]:
    """Give the clips of each cluster, the largest cluster first."""
    found = []
    with library.db.reading() as connection:
        for number in np.unique(cut):
            places = np.flatnonzero(cut == number)
            middle = places[apart[np.ix_(places, places)].sum(axis=1).argmin()]
            order = places[np.argsort(apart[middle, places], kind="stable")]
            found.append(
                Group([by_id(library, connection, searchable.clips[at]) for at in order.tolist()])
            )
    return sorted(found, key=lambda group: -len(group.clips))
