"""Segmentation of a database by a self-organizing map (Section III-B)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.mrpa.paths import Segments

LENGTH_THRESHOLD = 30
"""LengthThr: what is left between segments is one of its own from so many frames on."""
RATES = (0.5, 0.4, 0.3, 0.2, 0.1)
"""The learning rates k, one for each time that all inputs are gone through."""


def iou(segments: Segments, first: int, last: int) -> NDArray[np.float64]:
    """Give the intersection over union of segments with one (Eq. 6), 0 where they are disjoint."""
    overlap = np.minimum(segments[:, 1], last) - np.maximum(segments[:, 0], first) + 1
    overlap = np.maximum(overlap, 0)
    together = segments[:, 1] - segments[:, 0] + 1 + last - first + 1 - overlap
    return np.asarray(overlap / together, np.float64)


def even_segments(h: Segments, frames: int) -> Segments:
    """Cut a database evenly into segments of about the longest h-segment (Eqs. 4 and 5)."""
    return refined_segments(h, frames, rates=())


def refined_segments(
    h: Segments,
    frames: int,
    length_threshold: int = LENGTH_THRESHOLD,
    rates: Sequence[float] = RATES,
) -> Segments:
    """Move the even segments towards the h-segments that they resemble most (Eq. 7).

    They cover all frames and do not overlap. Without h-segments there is one segment.
    """
    found: Segments = _core.mrpa_refined(
        np.ascontiguousarray(h), frames, length_threshold, list(rates)
    )
    return found


def cut_at_clips(segments: Segments, clips: NDArray[np.int32]) -> Segments:
    """Cut segments where one clip ends and the next begins."""
    borders = np.flatnonzero(np.diff(clips)) + 1
    firsts = np.union1d(segments[:, 0], borders)
    lasts = np.append(firsts[1:] - 1, len(clips) - 1)
    return np.stack([firsts, lasts], axis=1) if len(clips) else segments
