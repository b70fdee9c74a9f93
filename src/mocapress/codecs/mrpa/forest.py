"""The forest of segments (Section III-C): paths connect segments that resemble each other."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.mrpa.paths import Paths, Segments
from mocapress.codecs.mrpa.som import iou

IOU_THRESHOLD = 0.6
"""IoUThr: from which similarity on a segment belongs to a tree."""
NONE = -1


@dataclass(frozen=True, slots=True, eq=False)
class Forest:
    """Segments, each the root of a tree or the child of another."""

    segments: Segments
    parents: NDArray[np.int64]
    """(S,) index of the parent, or -1 for a root."""
    agents: NDArray[np.int64]
    """(S,) the path whose h-segment each segment resembles most, or -1: its connection agent."""

    @property
    def predicted_frames(self) -> int:
        """Frames of all children: the paper's predicted frame number."""
        children = self.segments[self.parents >= 0]
        return int((children[:, 1] - children[:, 0] + 1).sum())

    @property
    def index_entries(self) -> int:
        """Pairs of parent and child that have to be kept."""
        return int((self.parents >= 0).sum())

    def breadth_first(self) -> NDArray[np.int64]:
        """Give the segments tree by tree, parents before their children, breadth first."""
        children: list[list[int]] = [[] for _ in self.parents]
        for child, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                children[parent].append(child)
        order: list[int] = []
        for root in np.flatnonzero(self.parents < 0).tolist():
            tree = [root]
            for segment in tree:
                tree += children[segment]
            order += tree
        return np.array(order, np.int64)


def agents_of(segments: Segments, paths: Paths) -> NDArray[np.int64]:
    """Give the path whose h-segment has the largest IoU with each segment, -1 where none does."""
    h = paths.h
    longest = int(paths.depth.max(initial=0))
    agents = np.full(len(segments), NONE, np.int64)
    for s, (first, last) in enumerate(segments.tolist()):
        low = int(np.searchsorted(h[:, 0], first - longest))
        high = int(np.searchsorted(h[:, 0], last, "right"))
        if low < high:
            alike = iou(h[low:high], first, last)
            best = int(alike.argmax())
            if alike[best] > 0:
                agents[s] = low + best
    return agents


def build(segments: Segments, paths: Paths, threshold: float = IOU_THRESHOLD) -> Forest:
    """Hang each segment below the one that it resembles most, where that is enough.

    Two segments are as similar as the v-segments of their agents (Eq. 6). The longest segment goes
    first, the others in their order; at last trees are merged of which a pair of segments is
    similar enough.
    """
    agents = agents_of(segments, paths)
    parents = np.full(len(segments), NONE, np.int64)
    reached = np.zeros((len(segments), 2), np.int64)
    reached[:, 1] = -1
    reached[agents >= 0] = paths.v[agents[agents >= 0]]
    longest = int(np.argmax(segments[:, 1] - segments[:, 0])) if len(segments) else 0
    order = [longest, *(s for s in range(len(segments)) if s != longest)]
    inside = np.zeros(len(segments), np.bool_)
    trees = np.arange(len(segments))
    for s in order[: len(segments)]:
        if agents[s] >= 0:
            alike = _similarities(reached, agents, s)
            alike[~inside] = 0
            best = int(alike.argmax())
            if alike[best] >= threshold:
                parents[s] = best
                trees[s] = trees[best]
        inside[s] = True
    forest = Forest(segments, parents, agents)
    _merge(forest, reached, trees, threshold)
    return forest


def _similarities(
    reached: Segments, agents: NDArray[np.int64], segment: int
) -> NDArray[np.float64]:
    alike = np.where(agents >= 0, iou(reached, *reached[segment].tolist()), 0)
    alike[segment] = 0
    return alike


def _merge(forest: Forest, reached: Segments, trees: NDArray[np.int64], threshold: float) -> None:
    """Hang a tree below another where two of their segments are similar enough."""
    for s in np.flatnonzero(forest.agents >= 0).tolist():
        alike = _similarities(reached, forest.agents, s)
        alike[trees == trees[s]] = 0
        best = int(alike.argmax())
        if alike[best] > threshold:
            _hang(forest.parents, s, best)
            trees[trees == trees[s]] = trees[best]


def _hang(parents: NDArray[np.int64], segment: int, parent: int) -> None:
    """Make a segment the root of its tree, and the child of one in another tree."""
    while segment >= 0:
        above = int(parents[segment])
        parents[segment] = parent
        segment, parent = above, segment


def alignment(forest: Forest, paths: Paths, child: int) -> NDArray[np.int64]:
    """Give for each frame of a child the frame of its parent that predicts it.

    The child's agent leads to a match, from which the parent's agent leads back; before and behind
    a path, frames go one by one. No frame is outside of the parent.
    """
    parent = int(forest.parents[child])
    down, up = int(forest.agents[child]), int(forest.agents[parent])
    own = np.arange(forest.segments[child, 0], forest.segments[child, 1] + 1)
    matches = _along(
        paths.first[down] + np.arange(paths.depth[down]), paths.matches(down).astype(np.int64), own
    )
    # Several frames may have one match: the first of them counts.
    met, at = np.unique(paths.matches(up).astype(np.int64), return_index=True)
    back = _along(met, paths.first[up] + at, matches)
    first, last = forest.segments[parent].tolist()
    return np.asarray(np.clip(back, first, last), np.int64)


def _along(
    known: NDArray[np.int64], images: NDArray[np.int64], frames: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Map frames by known pairs: the last known one before, and from there one by one."""
    at = np.clip(np.searchsorted(known, frames, "right") - 1, 0, len(known) - 1)
    mapped: NDArray[np.int64] = images[at] + (frames - known[at])
    return mapped
