"""What recurs in the clips of a library, for people to look at."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mocapress.codecs.mrpa import Patterns, Thresholds, analyse
from mocapress.codecs.mrpa.forest import Forest
from mocapress.codecs.mrpa.together import covering
from mocapress.library.clips import StoredClip
from mocapress.motion import Skeleton, Stream


@dataclass(frozen=True, slots=True)
class Place:
    """Successive frames of a clip."""

    clip: str
    first: int
    last: int

    def __str__(self) -> str:
        """Name clip and frames."""
        return f"{self.clip} {self.first}-{self.last}"


@dataclass(frozen=True, slots=True)
class Recurrence:
    """Frames that resemble earlier ones."""

    frames: Place
    earlier: Place
    distance: float
    """Average of Eq. 2 over the pairs of frames, in weighted degrees."""

    def __len__(self) -> int:
        """Give how many frames resemble others."""
        return self.frames.last + 1 - self.frames.first


@dataclass(frozen=True, slots=True, eq=False)
class Recurring:
    """What recurs in clips of the same columns."""

    names: list[str]
    found: Patterns
    forest: Forest

    def place(self, first: int, last: int) -> Place:
        """Name frames of the clips one behind the other."""
        clip = int(np.searchsorted(self.found.starts, first, "right")) - 1
        start = int(self.found.starts[clip])
        return Place(self.names[clip], first - start, last - start)

    def pairs(self) -> list[Recurrence]:
        """Give what resembles earlier frames, the longest first; no frame is in two."""
        steps = self.found.trellis
        pairs = []
        for first, at in covering(self.found):
            distances = []
            for frame, match in enumerate(at.tolist(), first):
                begin = int(steps.starts[frame])
                place = int(np.searchsorted(steps.column(frame), match))
                distances.append(float(steps.distances[begin + place]))
            frames = self.place(first, first + len(at) - 1)
            earlier = self.place(int(at[0]), int(at[-1]))
            pairs.append(Recurrence(frames, earlier, float(np.mean(distances))))
        return sorted(pairs, key=len, reverse=True)

    def trees(self) -> list[list[tuple[Place, int]]]:
        """Give the trees of more than a root: each segment and its depth, breadth first."""
        built = self.forest
        depths: dict[int, int] = {}
        trees: list[list[tuple[Place, int]]] = []
        for segment in built.breadth_first().tolist():
            parent = int(built.parents[segment])
            depths[segment] = depths[parent] + 1 if parent >= 0 else 0
            first, last = built.segments[segment].tolist()
            if parent < 0:
                trees.append([])
            trees[-1].append((self.place(first, last), depths[segment]))
        return [tree for tree in trees if len(tree) > 1]

    def as_dict(self) -> dict[str, Any]:
        """Give everything as numbers and names, for JSON."""

        def of(place: Place) -> dict[str, Any]:
            return {"clip": place.clip, "first": place.first, "last": place.last}

        return {
            "clips": self.names,
            "frames": len(self.found.clips),
            "radius": self.found.trellis.radius,
            "paths": len(self.found.paths),
            "pairs": [
                {**of(pair.frames), "like": of(pair.earlier), "distance": pair.distance}
                for pair in self.pairs()
            ],
            "trees": [
                [{**of(place), "depth": depth} for place, depth in tree] for tree in self.trees()
            ],
        }


def recurring(clips: Sequence[StoredClip], thresholds: Thresholds) -> list[Recurring]:
    """Find what recurs in clips, each group of the same columns by itself.

    Raises
    ------
    UnsupportedError
        When what finds patterns is not installed.

    """
    groups: dict[tuple[tuple[str, str], ...], list[tuple[str, Stream, Skeleton | None]]] = {}
    for clip in clips:
        if clip.frames and clip.channels:
            loaded = clip.load()
            key = tuple((column.name, column.kind) for column in loaded.columns)
            groups.setdefault(key, []).append((clip.name, loaded.main, loaded.skeleton))
    results = []
    for group in groups.values():
        streams = [stream for _, stream, _ in group]
        found = analyse(streams, group[0][2], thresholds, deepest=True)
        results.append(Recurring([name for name, _, _ in group], found, found.forest()))
    return results
