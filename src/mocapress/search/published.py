"""Search by published signatures, by name: what ``--by`` chooses instead of our own."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import NamedTuple

import numpy as np

from mocapress.codecs.qssd.quaternions import Array
from mocapress.errors import ParameterError
from mocapress.search.patterns import pattern_distances
from mocapress.search.qssd import bone_turns, dictionary_of, distances, mirrored
from mocapress.search.standard import StandardMotion

_EVERY = 2
"""Decomposed are 15 of the 30 frames a second."""


class Published(NamedTuple):
    """A signature of whole clips, and how two are compared."""

    signature: Callable[[StandardMotion], Array]
    distances: Callable[[Array, Array], Array]
    """Of a signature from others, (N, ...) to (N,)."""


def _dictionary(motion: StandardMotion, *, sums: bool) -> Array:
    return dictionary_of(bone_turns(motion.places[::_EVERY]), sums=sums)


PUBLISHED = {
    "qssd": Published(partial(_dictionary, sums=False), distances),
    "qssd-dots": Published(partial(_dictionary, sums=False), partial(distances, dots=True)),
    "ksvd": Published(partial(_dictionary, sums=True), distances),
}
"""QSSD with atoms compared as logarithms or as unit quaternions, and K-SVD on logarithms."""
PATTERNS = "patterns"
"""Strings of patterns, which are found anew among the clips that are compared."""


def distances_by(
    name: str, query: StandardMotion, clips: Iterable[StandardMotion], *, mirror: bool = False
) -> Array:
    """Compare a clip with others by a published signature.

    Parameters
    ----------
    name
        Of ``PUBLISHED``, or ``PATTERNS``.
    query
        The clip that is sought.
    clips
        Others; they are read one after the other.
    mirror
        Also with left and right exchanged; the smaller distance counts.

    Returns
    -------
    array
        (N,): the smaller, the more alike.

    Raises
    ------
    ParameterError
        When there is no signature of this name.

    """
    if name == PATTERNS:
        return pattern_distances(query, clips, mirror=mirror)
    if name not in PUBLISHED:
        raise ParameterError("by", expected=", ".join((*PUBLISHED, PATTERNS)), found=repr(name))
    by = PUBLISHED[name]
    own = by.signature(query)
    others = np.array([by.signature(clip) for clip in clips])
    if not len(others):
        return np.empty(0)
    found = by.distances(own, others)
    return np.minimum(found, by.distances(mirrored(own), others)) if mirror else found
