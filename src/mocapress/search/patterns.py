"""Search by patterns of motion: how often clips have each, and in which order.

Q. Gu, J. Peng, Z. Deng (2009) name retrieval as a use of their database of patterns, without saying
how. Here segments of each body part are cut and clustered as by the codec ``patterns``, over the
query and all clips that are compared; a clip is a string of patterns for each part.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.patterns.clustering import nearest, patterns_of
from mocapress.codecs.patterns.segmentation import lengths_of, normalised
from mocapress.motion.standard_joints import JOINTS
from mocapress.search.standard import StandardMotion

Array = NDArray[np.float64]
Words = NDArray[np.int64]

_PARTS = (
    ("hips", ("chest", "neck", "head")),
    *(
        (f"{side}_{first}", tuple(f"{side}_{joint}" for joint in others))
        for side in ("left", "right")
        for first, others in (("shoulder", ("elbow", "wrist")), ("hip", ("knee", "ankle")))
    ),
)
"""What each body part is relative to, and its joints."""
_THETA, _CLUSTER = 0.08, 0.06
"""Thresholds of segments and clusters, in leg lengths."""
_FRAMES = 8
_MOST_PATTERNS = 64


def pattern_distances(
    query: StandardMotion, clips: Iterable[StandardMotion], *, mirror: bool = False
) -> Array:
    """Give how far clips are from a query, (N,): 0 to 1, the smaller, the more alike.

    For each body part half of it is one less the cosine of the histograms of patterns, rare ones
    counting more, and half the edit distance of the strings, divided by the longer one's length.

    Parameters
    ----------
    query, clips
        The clip that is sought, and others.
    mirror
        Also with left and right exchanged; the smaller distance counts.

    """
    queries = [query, query.mirrored()] if mirror else [query]
    by_use, by_edits = distances_of(queries, list(clips))
    found: Array = (by_use + by_edits).min(axis=0) / 2
    return found


def distances_of(
    queries: Sequence[StandardMotion], clips: Sequence[StandardMotion]
) -> tuple[Array, Array]:
    """Give distances by histograms and by edits, (Q, N) each: means over body parts, 0 to 1."""
    motions = [*queries, *clips]
    by_use, by_edits = np.zeros((2, len(queries), len(clips)))
    for reference, joints in _PARTS if clips else ():
        words = _words([_part(motion, reference, joints) for motion in motions])
        own, others = words[: len(queries)], words[len(queries) :]
        histograms = _histograms(words)
        by_use += 1 - histograms[: len(queries)] @ histograms[len(queries) :].T
        by_edits += [
            [_edits(word, other) / max(len(word), len(other)) for other in others] for word in own
        ]
    return by_use / len(_PARTS), by_edits / len(_PARTS)


def _part(motion: StandardMotion, reference: str, joints: tuple[str, ...]) -> Array:
    """Give where a part's joints are from its reference, (F, 3 joints)."""
    places = motion.places
    own = places[:, [JOINTS.index(joint) for joint in joints]]
    away = (own - places[:, [JOINTS.index(reference)]]).reshape(len(places), -1)
    scaled: Array = away / np.sqrt(len(joints))
    return scaled


def _words(motions: list[Array]) -> list[Words]:
    """Cut motions of a part into segments, and give the number of each one's pattern."""
    lengths = [lengths_of(motion, _THETA) for motion in motions]
    shapes = [
        normalised(motion, length, _FRAMES).reshape(len(length), -1) / np.sqrt(_FRAMES)
        for motion, length in zip(motions, lengths, strict=True)
    ]
    every = np.concatenate(shapes)
    words, _ = nearest(every, patterns_of(every, _CLUSTER, most=_MOST_PATTERNS))
    return np.split(words, np.cumsum([len(own) for own in shapes])[:-1])


def _histograms(words: list[Words]) -> Array:
    """Give how often each clip has each pattern, as vectors of length 1."""
    count = 1 + max(int(own.max(initial=0)) for own in words)
    used = np.array([np.bincount(own, minlength=count) for own in words], dtype=np.float64)
    rare = np.log(len(words) / np.maximum((used > 0).sum(axis=0), 1)) + 1
    weighted = used * rare
    found: Array = weighted / np.maximum(np.linalg.norm(weighted, axis=1, keepdims=True), 1e-12)
    return found


def _edits(a: Words, b: Words) -> int:
    """Give the edit distance of two strings: the least that is inserted, left out or replaced."""
    row = np.arange(len(b) + 1)
    steps = np.arange(len(b) + 1)
    for i, word in enumerate(a.tolist(), 1):
        # Without insertions first; then these, which go along the row.
        changed = np.minimum(row[1:] + 1, row[:-1] + (b != word))
        row = np.minimum.accumulate(np.concatenate([[i], changed]) - steps) + steps
    return int(row[-1])
