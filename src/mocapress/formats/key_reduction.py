"""Fewer keys for joints' motion, with the largest error in space guaranteed.

Keys lie at frames and keep their values; between them rotations turn at constant speed about one
axis and translations are lines, as glTF's ``LINEAR`` has it. Beginning with the first frame and the
last, keys are added where the error is largest, to the joint up the chain that causes most of it,
until no frame exceeds the bound (top-down splitting as Ramer, 1972, and Douglas and Peucker, 1973,
do for one curve).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

RADIUS = 0.03
"""Metres along a joint's axes at which its error is measured."""
_MANY = 0.8
"""Of all keys. Where few can be left out, all cost less, as joints with all share their times."""


class Motion(NamedTuple):
    """Joints relative to their parents; of each the parent comes first."""

    parents: tuple[int, ...]
    turns: Array
    """(F, J, 4) unit quaternions, scalar last."""
    places: Array
    """(F, J, 3), in metres."""


class Keys(NamedTuple):
    """Frames that are kept, of turns and of places."""

    turns: Mask
    """(F, J)."""
    places: Mask


def reduced(exact: Motion, stored: Motion, most: float) -> Keys | None:
    """Choose the keys that keep all joints within an error.

    Parameters
    ----------
    exact
        The motion.
    stored
        The same as its keys would be stored.
    most
        Largest error in metres: of joints, and points ``RADIUS`` along their axes, in space, at all
        frames.

    Returns
    -------
    Keys
        None where not even all keys keep it.

    """
    frames, joints = exact.turns.shape[:2]
    goal = _in_space(exact)
    if _errors(goal, stored).max(initial=0.0) > most:
        return None
    keys = Keys(np.zeros((frames, joints), bool), np.zeros((frames, joints), bool))
    for mask in keys:
        mask[[0, -1]] = True
    depths, chains = _chains(exact.parents)
    above = np.array(exact.parents)
    places = goal[1]
    while True:
        for mask in keys:
            mask[:, mask.mean(axis=0) > _MANY] = True
        spans = [_spans(mask) for mask in keys]
        found = Motion(
            exact.parents, _slerp(stored.turns, *spans[0]), _lines(stored.places, *spans[1])
        )
        errors = _errors(goal, found)
        wrong = errors > most
        if not wrong.any():
            return keys
        # An error further up shows in all joints below it.
        wrong &= ~np.where(above >= 0, wrong[:, above], False)
        frame, joint = np.nonzero(wrong)
        told = errors[frame, joint]
        turned = _angles(exact.turns, found.turns)
        moved = np.linalg.norm(exact.places - found.places, axis=2)
        blamed, share = np.full(len(frame), -1), np.full(len(frame), -1.0)
        for step in range(int(depths.max()) + 1):
            chain = chains[joint, step]
            lever = np.linalg.norm(places[frame, joint] - places[frame, chain], axis=1) + RADIUS
            for kind, part in enumerate((turned[frame, chain] * lever, moved[frame, chain])):
                free = (chain >= 0) & ~keys[kind][frame, chain]
                better = free & (part > share)
                blamed[better] = 2 * chain[better] + kind
                share[better] = part[better]
        for kind in range(2):
            own = (blamed >= 0) & (blamed % 2 == kind)
            _add_worst(keys[kind], spans[kind][0], frame[own], blamed[own] // 2, told[own])


def _chains(parents: tuple[int, ...]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Give depths of joints, and of each the joints from itself up to the root, then -1."""
    depths = np.zeros(len(parents), np.intp)
    for j, parent in enumerate(parents):
        depths[j] = depths[parent] + 1 if parent >= 0 else 0
    chains = np.full((len(parents), int(depths.max()) + 1), -1, np.intp)
    for j, parent in enumerate(parents):
        chains[j, 0] = j
        if parent >= 0:
            chains[j, 1:] = chains[parent, :-1]
    return depths, chains


def _add_worst(
    mask: Mask, before: NDArray[np.intp], frame: Array, joint: Array, error: Array
) -> None:
    """Add a key in each stretch between keys where the error is largest."""
    order = np.argsort(-error, kind="stable")
    stretch = joint[order] * len(mask) + before[frame[order], joint[order]]
    first = np.unique(stretch, return_index=True)[1]
    mask[frame[order][first], joint[order][first]] = True


def _spans(mask: Mask) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """Give the keys before and behind each frame, and how far between them it lies, (F, J)."""
    count = len(mask)
    rows = np.arange(count)[:, None]
    before = np.maximum.accumulate(np.where(mask, rows, 0), axis=0)
    behind = np.minimum.accumulate(np.where(mask, rows, count - 1)[::-1], axis=0)[::-1]
    part = (rows - before) / np.maximum(behind - before, 1)
    return before, behind, part


def _lines(values: Array, before: NDArray[np.intp], behind: NDArray[np.intp], part: Array) -> Array:
    a = np.take_along_axis(values, before[..., None], axis=0)
    b = np.take_along_axis(values, behind[..., None], axis=0)
    mixed: Array = a + (b - a) * part[..., None]
    return mixed


def _slerp(turns: Array, before: NDArray[np.intp], behind: NDArray[np.intp], part: Array) -> Array:
    a = np.take_along_axis(turns, before[..., None], axis=0)
    b = np.take_along_axis(turns, behind[..., None], axis=0)
    return slerp(a, b, part[..., None])


def slerp(a: Array, b: Array, part: Array) -> Array:
    """Give turns between others, the shorter way round: (..., 4), and (..., 1) from 0 to 1."""
    cosine = (a * b).sum(axis=-1, keepdims=True)
    b = np.where(cosine < 0, -b, b)
    cosine = np.minimum(np.abs(cosine), 1.0)
    angle = np.arccos(cosine)
    sine = np.sin(angle)
    near = sine < 1e-9
    safe = np.where(near, 1.0, sine)
    weight_a = np.where(near, 1 - part, np.sin((1 - part) * angle) / safe)
    weight_b = np.where(near, part, np.sin(part * angle) / safe)
    mixed = weight_a * a + weight_b * b
    unit: Array = mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)
    return unit


def _angles(a: Array, b: Array) -> Array:
    """Give the angles between turns, in radians."""
    apart = np.minimum(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))
    angles: Array = 4 * np.arcsin(np.minimum(apart / 2, 1.0))
    return angles


def _errors(goal: tuple[Array, Array], motion: Motion) -> Array:
    """Give the largest errors of joints and of the points around them, (F, J)."""
    turns, places = _in_space(motion)
    moved = (places - goal[1])[..., None]
    points = np.concatenate([moved, (turns - goal[0]) * RADIUS + moved], axis=3)
    errors: Array = np.sqrt(np.einsum("fjax,fjax->fjx", points, points).max(axis=2))
    return errors


def _in_space(motion: Motion) -> tuple[Array, Array]:
    """Give rotations in space as matrices, (F, J, 3, 3), and positions, (F, J, 3)."""
    turns, places = matrices(motion.turns), motion.places.copy()
    for j, parent in enumerate(motion.parents):
        if parent >= 0:
            places[:, j] = places[:, parent] + np.einsum(
                "fab,fb->fa", turns[:, parent], places[:, j]
            )
            turns[:, j] = turns[:, parent] @ turns[:, j]
    return turns, places


def matrices(turns: Array) -> Array:
    """Give the matrices of unit quaternions, scalar last."""
    x, y, z, w = np.moveaxis(turns, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
