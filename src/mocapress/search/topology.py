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
_NEARLY = 0.85
"""Part of the length of the two longest bones in a row that those of a limb have at least."""


def by_topology(skeleton: Skeleton, places: Array) -> dict[str, int]:
    """Give what is found, as indices into the skeleton; nothing where the body is no such one.

    Parameters
    ----------
    skeleton
        Of any names.
    places
        (F, J, 3): where its joints are in some frames.

    """
    children = _children(skeleton)
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
    head = _end(max(heads, key=lambda c: depths[c]), children) if heads else top
    feet = [_limb(leg, children, depths, places) for leg in legs]
    hands = [_limb(arm, children, depths, places) for arm in arms]
    swap = _mirrored(feet, children, places, head)
    # Arms go with the legs on whose side they are.
    across = places[:, feet[1][0]] - places[:, feet[0][0]]
    if float(((places[:, hands[1][0]] - places[:, hands[0][0]]) * across).sum()) < 0:
        hands.reverse()
    if swap:
        feet.reverse()
        hands.reverse()
    joints = {"chest": top, "head": head}
    for side, arm, leg in zip(("left", "right"), hands, feet, strict=True):
        named = zip(SIDED, [*arm, *leg], strict=True)
        joints |= {f"{side}_{joint}": index for joint, index in named}
    return joints


def head_between(skeleton: Skeleton, shoulders: Sequence[int]) -> int | None:
    """Give the joint that ends what goes up between the shoulders, if there is any such branch."""
    children = _children(skeleton)
    ways = []
    for joint in shoulders:
        way = [joint]
        while (above := skeleton.parents[way[-1]]) >= 0:
            way.append(above)
        ways.append(way)
    top = next((joint for joint in ways[0] if joint in ways[1]), None)
    if top is None:
        return None
    depths = _shapes(children)[1]
    arms = {joint for way in ways for joint in way}
    between = [c for c in children[top] if c not in arms]
    return _end(max(between, key=lambda c: depths[c]), children) if between else None


def _children(skeleton: Skeleton) -> list[list[int]]:
    children: list[list[int]] = [[] for _ in skeleton.joints]
    for index, parent in enumerate(skeleton.parents):
        if parent >= 0:
            children[parent].append(index)
    return children


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


def _end(start: int, children: Sequence[Sequence[int]]) -> int:
    """Give the joint where a branch ends, or has several others, as a face has."""
    at = start
    while len(children[at]) == 1:
        at = children[at][0]
    return at


def _limb(
    start: int, children: Sequence[Sequence[int]], depths: Sequence[int], places: Array
) -> list[int]:
    """Give the three joints of a limb, which long bones connect.

    The two longest in a row; or those farthest out that are nearly as long, as a collar bone and an
    upper arm may be longer than the two bones of the arm.
    """
    way = _way(start, children, depths)
    bones = np.linalg.norm(np.diff(places[:, way], axis=1), axis=-1).mean(axis=0)
    pairs = bones[:-1] + bones[1:]
    first = int(np.flatnonzero(pairs >= _NEARLY * pairs.max())[-1])
    return way[first : first + 3]


def _mirrored(
    feet: Sequence[Sequence[int]], children: Sequence[Sequence[int]], places: Array, head: int
) -> bool:
    """Say whether the first leg is the right one, by where toes point, else by how knees bend."""
    hips, knees, ankles = (places[:, [leg[joint] for leg in feet]] for joint in range(3))
    toes = [children[leg[2]][:1] for leg in feet]
    if all(toes):
        forward = places[:, [toe[0] for toe in toes]] - ankles
    else:
        leg = ankles - hips
        thigh = knees - hips
        along = (thigh * leg).sum(axis=-1) / np.maximum((leg * leg).sum(axis=-1), 1e-12)
        forward = thigh - along[..., None] * leg
    up = places[:, head] - ankles.mean(axis=1)
    left = np.cross(up, forward.sum(axis=1))
    return float(((hips[:, 0] - hips[:, 1]) * left).sum()) < 0
