"""Which joints of a skeleton the standard joints are, by how the body branches.

For skeletons whose names say nothing: two equal branches at the lower end of the trunk are legs,
two at its upper end are arms, and what lies between the arms ends in the head.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mocapress.motion import Skeleton
from mocapress.motion.standard_joints import SIDED

Array = NDArray[np.float64]
_LIMB = 3
"""Joints that a limb has at least."""


def by_topology(skeleton: Skeleton, places: Array) -> dict[str, int]:
    """Give what is found, as indices into the skeleton; nothing where the body is no such one.

    Parameters
    ----------
    skeleton
        Of any names.
    places
        (J, 3): where its joints are in some frame, y or z up.

    """
    children: list[list[int]] = [[] for _ in skeleton.joints]
    for index, parent in enumerate(skeleton.parents):
        if parent >= 0:
            children[parent].append(index)
    depths = _shapes(children)[1]
    found = _limbs_below(0, children)
    if found is None:
        return {}
    hips, legs = found
    above = [c for c in children[hips] if c not in legs]
    trunk = max(above, key=lambda c: depths[c], default=None)
    reached = None if trunk is None else _limbs_below(trunk, children)
    if reached is None:
        return {}
    top, arms = reached
    heads = [c for c in children[top] if c not in arms]
    head = _end(max(heads, key=lambda c: depths[c]), children, depths) if heads else top
    feet = [_limb(leg, children, depths, places) for leg in legs]
    hands = [_limb(arm, children, depths, places) for arm in arms]
    swap = _mirrored(feet, children, places, places[head])
    # Arms go with the legs on whose side they are.
    across = places[feet[1][0]] - places[feet[0][0]]
    if float((places[hands[1][0]] - places[hands[0][0]]) @ across) < 0:
        hands.reverse()
    if swap:
        feet.reverse()
        hands.reverse()
    joints = {"chest": top, "head": head}
    for side, arm, leg in zip(("left", "right"), hands, feet, strict=True):
        named = zip(SIDED, [*arm, *leg], strict=True)
        joints |= {f"{side}_{joint}": index for joint, index in named}
    return joints


def _limbs_below(
    start: int, children: Sequence[Sequence[int]]
) -> tuple[int, tuple[int, int]] | None:
    """Go along the deepest branch until two branches are alike, and long enough for limbs."""
    shapes, depths = _shapes(children)
    at = start
    while True:
        limbs = [c for c in children[at] if depths[c] >= _LIMB]
        for one, other in combinations(limbs, 2):
            if shapes[one] == shapes[other]:
                return at, (one, other)
        if not children[at]:
            return None
        at = max(children[at], key=lambda c: depths[c])


def _shapes(children: Sequence[Sequence[int]]) -> tuple[list[int], list[int]]:
    """Give a number to each branch, equal ones the same, and its joints along the longest way."""
    numbers: dict[tuple[int, ...], int] = {}
    shapes, depths = [0] * len(children), [1] * len(children)
    for index in reversed(range(len(children))):
        below = tuple(sorted(shapes[c] for c in children[index]))
        shapes[index] = numbers.setdefault(below, len(numbers))
        depths[index] = 1 + max((depths[c] for c in children[index]), default=0)
    return shapes, depths


def _way(start: int, children: Sequence[Sequence[int]], depths: Sequence[int]) -> list[int]:
    way = [start]
    while children[way[-1]]:
        way.append(max(children[way[-1]], key=lambda c: depths[c]))
    return way


def _end(start: int, children: Sequence[Sequence[int]], depths: Sequence[int]) -> int:
    return _way(start, children, depths)[-1]


def _limb(
    start: int, children: Sequence[Sequence[int]], depths: Sequence[int], places: Array
) -> list[int]:
    """Give the three joints of a limb: those that its two longest bones in a row connect."""
    way = _way(start, children, depths)
    bones = np.linalg.norm(np.diff(places[way], axis=0), axis=1)
    first = int(np.argmax(bones[:-1] + bones[1:]))
    return way[first : first + 3]


def _mirrored(
    feet: Sequence[Sequence[int]], children: Sequence[Sequence[int]], places: Array, head: Array
) -> bool:
    """Say whether the first leg is the right one, by where the toes point."""
    toes = [children[leg[2]] for leg in feet]
    if not all(toes):
        return False
    forward = sum((places[toe[0]] - places[leg[2]]) for toe, leg in zip(toes, feet, strict=True))
    up = head - (places[feet[0][2]] + places[feet[1][2]]) / 2
    left = np.cross(up, np.asarray(forward))
    return float((places[feet[0][0]] - places[feet[1][0]]) @ left) < 0
