"""The whole analysis of a database: trellis, paths, segments and forest, each to be looked at."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.mrpa import forest, paths, som, trellis
from mocapress.motion import Skeleton, Stream


@dataclass(frozen=True, slots=True)
class Thresholds:
    """The parameters of the paper, and the radius, on which it is silent."""

    valid_path: int = paths.VALID_PATH_THRESHOLD
    length: int = som.LENGTH_THRESHOLD
    iou: float = forest.IOU_THRESHOLD
    radius: float | None = None
    """R of Eq. 1; None where it is derived."""


@dataclass(frozen=True, slots=True, eq=False)
class Patterns:
    """What recurs in clips, one behind the other."""

    clips: NDArray[np.int32]
    """(F,) the clip of each frame."""
    starts: NDArray[np.int64]
    """(clips + 1,) first frame of each clip."""
    trellis: trellis.Trellis
    paths: paths.Paths
    thresholds: Thresholds

    def forest(self) -> forest.Forest:
        """Build the forest of segments, none of which goes beyond its clip."""
        found = som.refined_segments(self.paths.h, len(self.clips), self.thresholds.length)
        segments = som.cut_at_clips(found, self.clips)
        return forest.build(segments, self.paths, self.thresholds.iou)


def analyse(
    streams: Sequence[Stream],
    skeleton: Skeleton | None,
    thresholds: Thresholds,
    *,
    deepest: bool = False,
) -> Patterns:
    """Find what recurs in streams of the same columns.

    Raises
    ------
    UnsupportedError
        When OpenCV is not there.

    """
    counts = [stream.frames for stream in streams]
    clips = np.repeat(np.arange(len(streams)), counts).astype(np.int32)
    weight = trellis.weights(streams[0].columns, skeleton)
    postures = np.concatenate([trellis.features(stream.values, weight) for stream in streams])
    built = trellis.build(postures, clips, radius=thresholds.radius)
    grown = paths.grow(built, thresholds.valid_path, deepest=deepest)
    return Patterns(clips, np.cumsum([0, *counts]).astype(np.int64), built, grown, thresholds)
