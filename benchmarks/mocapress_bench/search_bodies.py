"""What the methods of others see of clips: turns of joints or of bones, parts and levels."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.qssd.quaternions import logarithm
from mocapress.motion.standard_joints import JOINTS
from mocapress.search.qssd import ABOVE, displacements
from mocapress_bench.search_data import Take

Array = NDArray[np.float64]
_LEVELS = 3


@dataclass(frozen=True, slots=True)
class Bodies:
    """Clips of one body, seen by what turns: joints, or bones."""

    logs: list[Array]
    """(F, J, 3) of each clip: logarithms of turns from the clip's mean pose, 30 frames a second.
    QSSD is given turns from the mean pose, too; without that all methods here are worse."""
    weights: Array
    """(J,): how much of the body each moves."""
    parts: list[tuple[list[int], float]]
    """Limbs, trunk, halves and the whole, and what each counts."""
    levels: list[list[int]]
    """Those near the root, in the middle, and far from it."""


def of_joints(takes: Sequence[Take]) -> Bodies:
    """See turns of joints relative to their parents; the skeleton is one of CMU's."""
    skeleton = takes[0].clip.skeleton
    assert skeleton is not None
    above = list(skeleton.parents)
    names = [name.lower() for name in skeleton.names]
    arms = [_below(names.index(f"{side}clavicle"), above) for side in "lr"]
    legs = [_below(names.index(f"{side}femur"), above) for side in "lr"]
    places = takes[0].places[0]
    reach = np.zeros(len(above))
    for i in range(len(above)):
        for joint in _way_up(i, above):
            reach[joint] += np.linalg.norm(places[i] - places[joint]) / len(above)
    return Bodies(
        [logarithm(displacements(take.turns)) for take in takes],
        np.maximum(reach[1:], 1e-3 * reach.max()),
        _parts(arms, legs, len(above)),
        _levels(above),
    )


def of_bones(takes: Sequence[Take]) -> Bodies:
    """See turns of the bones between standard joints, as the product's QSSD does."""
    above = [-1, *ABOVE]
    arms = [_below(JOINTS.index(f"{side}_shoulder"), above) for side in ("left", "right")]
    legs = [_below(JOINTS.index(f"{side}_hip"), above) for side in ("left", "right")]
    return Bodies(
        [logarithm(displacements(take.bones)) for take in takes],
        np.ones(len(ABOVE)),
        _parts(arms, legs, len(above)),
        _levels(above),
    )


Seen = Callable[[Sequence[Take]], Bodies]


def _parts(
    arms: list[list[int]], legs: list[list[int]], count: int
) -> list[tuple[list[int], float]]:
    """Give parts without the root, whose turns no clip has: numbers are less by 1."""
    limbs = {joint for limb in (*arms, *legs) for joint in limb}
    trunk = [joint for joint in range(1, count) if joint not in limbs]
    small = [(part, 1.0) for part in (*arms, *legs, trunk)]
    halves = [(arms[0] + arms[1] + trunk, 2.0), (legs[0] + legs[1], 2.0)]
    whole = (list(range(1, count)), 4.0)
    return [([joint - 1 for joint in part], w) for part, w in (*small, *halves, whole)]


def _levels(above: Sequence[int]) -> list[list[int]]:
    depths = np.array([len(_way_up(i, above)) for i in range(1, len(above))])
    order = np.argsort(depths, kind="stable")
    return [sorted(level.tolist()) for level in np.array_split(order, _LEVELS)]


def _below(top: int, above: Sequence[int]) -> list[int]:
    return [i for i in range(len(above)) if top in _way_up(i, above)]


def _way_up(joint: int, above: Sequence[int]) -> list[int]:
    """Give a joint and all above it."""
    way = []
    while joint >= 0:
        way.append(joint)
        joint = above[joint]
    return way
