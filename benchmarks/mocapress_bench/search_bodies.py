"""Parts and levels of a body, as joints of ``Take.turns``."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mocapress_bench.search_data import Take

Array = NDArray[np.float64]


def moved_by(take: Take) -> Array:
    """Give how far each joint but the root moves the body: mean distance of what hangs on it."""
    skeleton = take.clip.skeleton
    assert skeleton is not None
    places = take.places[0]
    reach = np.zeros(len(skeleton.joints))
    for i in range(len(skeleton.joints)):
        above = i
        while above >= 0:
            reach[above] += np.linalg.norm(places[i] - places[above]) / len(reach)
            above = skeleton.joints[above].parent
    moved: Array = np.maximum(reach[1:], 1e-3 * reach.max())
    return moved


def parts_of(take: Take) -> list[tuple[list[int], float]]:
    """Give limbs, halves and the whole body, and what each counts."""
    below = _below(take)
    names = _names(take)
    arms = [
        below(next(n for n in names if n.startswith(side) and "clavicle" in n)) for side in "lr"
    ]
    legs = [below(next(n for n in names if n.startswith(side) and "femur" in n)) for side in "lr"]
    limbs = {i for limb in (*arms, *legs) for i in limb}
    trunk = [i for i in range(len(names)) if i not in limbs]
    upper = sorted({*arms[0], *arms[1], *trunk})
    lower = sorted({*legs[0], *legs[1]})
    small = [(part, 1.0) for part in (*arms, *legs, trunk)]
    return [*small, (upper, 2.0), (lower, 2.0), (list(range(len(names))), 4.0)]


def levels_of(take: Take) -> list[list[int]]:
    """Give joints of ``turns`` by how many joints lie above them: near the root, middle, far."""
    skeleton = take.clip.skeleton
    assert skeleton is not None
    depth = [0] * len(skeleton.joints)
    for i, joint in enumerate(skeleton.joints[1:], 1):
        depth[i] = depth[joint.parent] + 1
    cuts = [(1, 2), (3, 4), (5, max(depth))]
    return [[i - 1 for i, d in enumerate(depth) if i and a <= d <= b] for a, b in cuts]


def _names(take: Take) -> list[str]:
    assert take.clip.skeleton is not None
    return [name.lower() for name in take.clip.skeleton.names[1:]]


def _below(take: Take) -> Callable[[str], list[int]]:
    skeleton = take.clip.skeleton
    assert skeleton is not None
    names = _names(take)

    def below(name: str) -> list[int]:
        top = names.index(name) + 1
        found = [top]
        for i in range(top + 1, len(skeleton.joints)):
            if skeleton.joints[i].parent in found:
                found.append(i)
        return [i - 1 for i in found]

    return below
