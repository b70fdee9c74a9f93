"""Search by dictionaries of poses, as published.

M. Zhu, H. Sun, Z. Deng: "Quaternion Space Sparse Decomposition for Motion Compression and
Retrieval", Computer Graphics Forum 31 (2012), section 5.2: each clip has a small dictionary of its
own, and clips are alike whose dictionaries are. docs/papers/qssd.md says how Eq. 10 is read.
"""

import numpy as np
from scipy.optimize import linear_sum_assignment

from mocapress.codecs.qssd.decomposition import LogSums, Products, Space, learn
from mocapress.codecs.qssd.quaternions import Array, conjugate, exponential, logarithm, product

ATOMS = 5
"""K."""
MOST = 2
"""L, atoms of a frame."""
_ITERATIONS = 3
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
        (F, J, 4): rotations of joints relative to their parents, unit quaternions; 15 frames a
        second are enough.
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
