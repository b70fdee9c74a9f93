"""Similar posture paths, grown through the trellis (Section III-A)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.mrpa.trellis import Trellis

Segments = NDArray[np.int64]
"""(S, 2): first and last frame of each."""

VALID_PATH_THRESHOLD = 55
"""ValidPathThr: the least depth of a path, counted as the frames of its h-segment."""


@dataclass(frozen=True, slots=True, eq=False)
class Paths:
    """The path set P (Eq. 3), in the order of the first frames of the h-segments."""

    first: NDArray[np.int32]
    """(P,) first frame of each h-segment."""
    begin: NDArray[np.int64]
    """(P + 1,) where the matches of each path begin."""
    vertical: NDArray[np.int32]
    """For each frame of each h-segment, its match in the v-segment."""
    distance: NDArray[np.float64]
    """(P,) path distance: the sum over the matched pairs."""

    def __len__(self) -> int:
        return len(self.first)

    @property
    def depth(self) -> NDArray[np.int64]:
        """(P,) frames of each h-segment."""
        return np.diff(self.begin)

    @property
    def h(self) -> Segments:
        """The h-segments, (P, 2)."""
        return np.stack([self.first, self.first + self.depth - 1], axis=1).astype(np.int64)

    @property
    def v(self) -> Segments:
        """The v-segments, (P, 2)."""
        first, last = self.vertical[self.begin[:-1]], self.vertical[self.begin[1:] - 1]
        return np.stack([first, last], axis=1).astype(np.int64)

    def matches(self, path: int) -> NDArray[np.int32]:
        """Give the match of each frame of a path's h-segment."""
        return self.vertical[self.begin[path] : self.begin[path + 1]]


def grow(
    trellis: Trellis, threshold: int = VALID_PATH_THRESHOLD, *, deepest: bool = False
) -> Paths:
    """Grow paths along links from match i to a match in [i, i + 2] of the next column.

    Of the paths that share a root the one of the least average distance is kept, of two the
    deeper; with ``deepest``, the deepest, of two the nearer. The h- and the v-segment of a path
    never overlap, and neither goes beyond its clip.
    """
    return Paths(
        *_core.mrpa_grow(
            trellis.starts,
            trellis.matches,
            trellis.distances,
            trellis.clips,
            threshold,
            deepest,
        )
    )
