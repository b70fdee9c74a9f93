"""Clips of a library that move alike, in groups: clusters, and takes that are nearly the same."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.library.clips import StoredClip, by_id
from mocapress.library.searching import Searchable, entry_of_place
from mocapress.search.ranking import likeness
from mocapress.search.standard import ASSUMED_RATE

if TYPE_CHECKING:
    from mocapress.library.finding import Finding

Array = NDArray[np.float64]

_MOST = 10_000
"""Clips that are grouped: their distances from each other are all in memory."""
_MOST_CLUSTERS = 40
"""That are tried where nobody says how many there are to be."""


_NEAREST = 10
"""Clips of the nearest signatures, which are compared in time to see whether they are the same."""
_COVERED = 0.8
"""Part of the longer of two takes that the shorter has to be like."""
ALIKE = 0.1
"""Mean distance of frames up to which two takes are nearly the same, unless another is given."""


class Group(NamedTuple):
    """Clips that move alike."""

    clips: list[StoredClip]
    """The one in the middle first, then by their distance from it."""


def clusters(library: "Finding", count: int | None = None) -> list[Group]:
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
    library: "Finding", searchable: Searchable, apart: Array, cut: NDArray[np.intp]
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


def duplicates(library: "Finding", alike: float = ALIKE) -> list[Group]:
    """Group takes that are nearly the same; see ``Library.duplicates``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    searchable = library.searchable()
    apart = _distances(searchable)
    count = len(apart)
    if not count:
        return []
    order = np.argsort(apart, axis=1, kind="stable")[:, : _NEAREST + 1]
    pairs = {(min(i, j), max(i, j)) for i in range(count) for j in order[i].tolist() if i != j}
    with library.db.reading() as connection:
        clips = [by_id(library, connection, clip) for clip in searchable.clips]
    seconds = [clip.frames * (clip.frame_time or 1 / ASSUMED_RATE) for clip in clips]
    same = [pair for pair in sorted(pairs) if _same(library, searchable, pair, seconds, alike)]
    rows, columns = (np.array([pair[end] for pair in same], np.intp) for end in (0, 1))
    links = coo_array((np.ones(len(same)), (rows, columns)), (count, count))
    _, of = connected_components(links, directed=False)
    groups = _groups(library, searchable, apart, of)
    return [group for group in groups if len(group.clips) > 1]


def _same(
    library: "Finding",
    searchable: Searchable,
    pair: tuple[int, int],
    seconds: list[float],
    alike: float,
) -> bool:
    """Say whether the shorter of two clips is nearly all of the longer one."""
    short, long = sorted(pair, key=lambda place: seconds[place])
    if seconds[short] < _COVERED * seconds[long]:
        return False
    wanted, other = (entry_of_place(library, searchable, place) for place in (short, long))
    return likeness(wanted, other) <= alike
