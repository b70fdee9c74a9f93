"""MRPA's path growing and its self-organizing map, step by step as the paper tells them."""

from collections.abc import Sequence
from dataclasses import dataclass

Columns = Sequence[dict[int, float]]
"""For each frame of the top row its matches and their distances."""


@dataclass
class Path:
    first: int
    pairs: list[tuple[int, int]]
    distance: float

    @property
    def root(self) -> int:
        return self.pairs[0][1]


def grow(columns: Columns, clips: Sequence[int], threshold: int, *, deepest: bool) -> list[Path]:
    """Grow all paths, keep the valid ones, and of each root one."""
    done: list[Path] = []
    leaves: dict[int, Path] = {}
    for t, column in enumerate(columns):
        if t and clips[t] != clips[t - 1]:
            done += leaves.values()
            leaves = {}
        grown: dict[int, Path] = {}
        continued = set()
        for match, distance in column.items():
            best = None
            for before in (match - 2, match - 1, match):
                leaf = leaves.get(before)
                if leaf is None or clips[before] != clips[match]:
                    continue
                if not (t < leaf.root or match < leaf.first):  # h and v would overlap
                    continue
                path = Path(leaf.first, [*leaf.pairs, (t, match)], leaf.distance + distance)
                if best is None or (-len(path.pairs), path.distance) < (
                    -len(best[1].pairs),
                    best[1].distance,
                ):
                    best = before, path
            if best is None:
                grown[match] = Path(t, [(t, match)], distance)
            else:
                continued.add(best[0])
                grown[match] = best[1]
        done += [leaf for match, leaf in leaves.items() if match not in continued]
        leaves = grown
    done += leaves.values()
    kept: dict[tuple[int, int], Path] = {}
    for path in done:
        if len(path.pairs) < threshold:
            continue
        other = kept.get((path.first, path.root))
        if other is None or rank(path, deepest) < rank(other, deepest):
            kept[path.first, path.root] = path
    return [kept[key] for key in sorted(kept)]


def rank(path: Path, deepest: bool) -> tuple[float, float]:
    average, depth = path.distance / len(path.pairs), len(path.pairs)
    return (-depth, average) if deepest else (average, -depth)


def refine(
    inputs: Sequence[tuple[int, int]], frames: int, least: int, rates: Sequence[float]
) -> list[tuple[int, int]]:
    """Move the evenly cut output layer; what lies between its segments is told by their ends."""
    longest = max(last - first + 1 for first, last in inputs)
    count = -(-frames // longest)
    layer = [[j * frames // count, (j + 1) * frames // count - 1] for j in range(count)]
    for rate in rates:
        for h in inputs:
            j = max(range(len(layer)), key=lambda i: (iou(h, layer[i]), -i))
            first, last = layer[j]
            new_first = first + away(rate * (h[0] - first))
            new_last = max(new_first, last + away(rate * (h[1] - last)))
            moved_last, behind = end_moved(last, new_last, layer[j + 1 :], frames, least)
            moved_first, before = start_moved(first, new_first, layer[:j], least)
            layer = [*before, [moved_first, moved_last], *behind]
    return [(first, last) for first, last in layer]


def end_moved(
    last: int, new: int, behind: list[list[int]], frames: int, least: int
) -> tuple[int, list[list[int]]]:
    if new < last:
        if last - new >= least:
            return new, [[new + 1, last], *behind]
        if not behind:
            return last, behind
    elif new > last:
        while behind and behind[0][1] - new < least:
            behind = behind[1:]
        if not behind:
            return frames - 1, behind
    return new, [[new + 1, behind[0][1]], *behind[1:]] if behind else behind


def start_moved(
    first: int, new: int, before: list[list[int]], least: int
) -> tuple[int, list[list[int]]]:
    if new > first:
        if new - first >= least:
            return new, [*before, [first, new - 1]]
        if not before:
            return first, before
    elif new < first:
        while before and new - before[-1][0] < least:
            before = before[:-1]
        if not before:
            return 0, before
    return new, [*before[:-1], [before[-1][0], new - 1]] if before else before


def iou(one: Sequence[int], other: Sequence[int]) -> float:
    overlap = max(0, min(one[1], other[1]) - max(one[0], other[0]) + 1)
    return overlap / (one[1] - one[0] + 1 + other[1] - other[0] + 1 - overlap)


def away(number: float) -> int:
    """Round to the nearest whole number, halves away from 0."""
    return int(abs(number) + 0.5) * (1 if number > 0 else -1)
