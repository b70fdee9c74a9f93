"""Search by dictionaries of poses, as published.

M. Zhu, H. Sun, Z. Deng: "Quaternion Space Sparse Decomposition for Motion Compression and
Retrieval", Computer Graphics Forum 31 (2012), section 5.2: each clip has a small dictionary of its
own, and clips are alike whose dictionaries are. docs/papers/qssd.md says how Eq. 10 is read.
"""

import numpy as np
from scipy.optimize import linear_sum_assignment

from mocapress.codecs.qssd.decomposition import LogSums, Products, Space, learn
from mocapress.codecs.qssd.quaternions import Array, conjugate, exponential, logarithm, product
from mocapress.motion.standard_joints import JOINTS

ATOMS = 5
"""K."""
MOST = 2
"""L, atoms of a frame."""
_ITERATIONS = 3
ABOVE = [
    JOINTS.index(above)
    for above in (
        *("hips", "chest", "neck"),
        *("neck", "left_shoulder", "left_elbow", "hips", "left_hip", "left_knee"),
        *("neck", "right_shoulder", "right_elbow", "hips", "right_hip", "right_knee"),
    )
]
"""What each standard joint but the first hangs on."""
_SIDES = {"left": "right", "right": "left"}
_OTHER_SIDE = [
    JOINTS.index("_".join(_SIDES.get(part, part) for part in joint.split("_"))) - 1
    for joint in JOINTS[1:]
]
"""Of each bone the one on the other side of the body."""
_STILL = 1e-9
"""Radians of half angles, all joints together, that are no motion."""


def dictionary_of(
    turns: Array,
    *,
    sums: bool = False,
    atoms: int = ATOMS,
    most: int = MOST,
    iterations: int = _ITERATIONS,
    seed: int | None = None,
    first: bool = False,
) -> Array:
    """Decompose a clip, and give its dictionary.

    Parameters
    ----------
    turns
        (F, J, 4): of bones, or rotations of joints relative to their parents; unit quaternions. 15
        frames a second are enough.
    sums
        K-SVD on logarithms instead of QSSD.
    atoms, most
        K and L.
    iterations
        Of Algorithm 4.
    seed
        Begin with frames chosen at random, as published. None: with the frame that is farthest from
        the reference, and then with those that differ most from what was chosen. So a clip has one
        dictionary, and similar clips begin alike.
    first
        Take the first frame as the reference, which is what the paper does most often, instead of
        the mean pose.

    Returns
    -------
    array
        (K, J, 3): logarithms of length 1; 0 for an atom that nothing needs, and in a still clip.

    """
    displaced = displacements(turns, first=first)
    if not (np.abs(displaced[..., 1:]) > _STILL).any():
        return np.zeros((atoms, turns.shape[1], 3))
    space: Space = LogSums() if sums else Products(sort=True)
    start = None if seed is not None else _different(displaced, atoms)
    learned = learn(
        space, displaced, atoms, most, iterations=iterations, seed=seed or 0, start=start
    )
    return learned.dictionary


def bone_turns(places: Array) -> Array:
    """Give the turns of bones from their mean directions, each the shortest.

    The paper decomposes rotations of joints relative to their parents. These depend on how a
    skeleton lays its joints' axes, so that clips of different skeletons cannot be compared by them.

    Parameters
    ----------
    places
        (F, 16, 3): the standard joints from the hips, in axes that turn with the body.

    Returns
    -------
    array
        (F, 15, 4): of the bone to each joint but the hips; no turn for a bone without length.

    """
    bones = places[:, 1:] - places[:, ABOVE]
    directions = _unit(bones)
    means = np.broadcast_to(_unit(directions.mean(axis=0)), directions.shape)
    real = 1 + (means * directions).sum(axis=-1, keepdims=True)
    turns = np.concatenate([real, np.cross(means, directions)], axis=-1)
    # To the opposite direction any axis across is right.
    turned = np.linalg.norm(turns, axis=-1, keepdims=True) > _STILL
    across = np.cross(means, np.eye(3)[np.abs(means).argmin(axis=-1)])
    return _unit(np.where(turned, turns, np.pad(across, [(0, 0), (0, 0), (1, 0)])))


def displacements(turns: Array, *, first: bool = False) -> Array:
    """Give joints' turns, (F, J, 4), from the mean pose of a clip or its first frame."""
    reference = turns[:1]
    if not first:
        near = np.where((turns * reference).sum(axis=-1, keepdims=True) < 0, -turns, turns)
        total = near.sum(axis=0, keepdims=True)
        reference = total / np.linalg.norm(total, axis=-1, keepdims=True)
    displaced: Array = product(conjugate(reference), turns)
    return displaced


def distances(dictionary: Array, others: Array, *, dots: bool = False) -> Array:
    """Give the distance of a dictionary from others: the least sum over pairs of atoms.

    Parameters
    ----------
    dictionary
        (K, J, 3).
    others
        (N, K, J, 3).
    dots
        Compare atoms by scalar products of unit quaternions, as Eq. 10 can be read: the mean over
        joints. Otherwise by scalar products of logarithms, which tell small turns apart.

    Returns
    -------
    array
        (N,): 0 for equal dictionaries, K for those that have nothing in common.

    """
    if dots:
        own, all_others = exponential(dictionary), exponential(others)
        own = own / dictionary.shape[1]
    else:
        own, all_others = dictionary, others
    flat = all_others.reshape(len(others), others.shape[1], -1)
    costs = 1 - np.abs(flat @ own.reshape(len(own), -1).T)
    return np.array([cost[linear_sum_assignment(cost)].sum() for cost in costs])


def mirrored(dictionary: Array) -> Array:
    """Give the dictionaries of bones, (..., K, 15, 3), of clips with left and right exchanged."""
    flipped: Array = dictionary[..., _OTHER_SIDE, :] * np.array([1.0, -1.0, -1.0])
    return flipped


def _different(turns: Array, count: int) -> Array:
    """Choose frames as atoms, each the farthest from what those before it span."""
    logs = logarithm(turns).reshape(len(turns), -1)
    chosen = np.zeros((count, logs.shape[1]))
    left = logs.copy()
    for atom in chosen:
        lengths = np.linalg.norm(left, axis=1)
        farthest = int(lengths.argmax())
        if not lengths[farthest] > _STILL:
            break
        atom[:] = logs[farthest] / np.linalg.norm(logs[farthest])
        along = left[farthest] / lengths[farthest]
        left -= (left @ along)[:, None] * along
    return chosen.reshape(count, *turns.shape[1:-1], 3)


def _unit(vectors: Array) -> Array:
    """Give vectors length 1; those without length stay as they are."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: Array = vectors / np.where(length > _STILL, length, 1.0)
    return unit
