"""Sparse decomposition of turns: a dictionary, and a few weighted atoms for each frame.

M. Zhu, H. Sun, Z. Deng: "Quaternion Space Sparse Decomposition for Motion Compression and
Retrieval", Computer Graphics Forum 31 (2012). ``Products`` is the paper's QSSD; ``LogSums`` and
``ComponentSums`` are K-SVD on logarithms and on the quaternions' components, with the same
interface. docs/papers/qssd.md says how the paper is read where it leaves something open.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.qssd.quaternions import Array, exponential, logarithm, turned_degrees

MOST_ATOMS = 64
"""Of a frame."""


@dataclass(frozen=True, slots=True)
class Weights:
    """What frames are put together from."""

    atoms: NDArray[np.int32]
    """(F, L): indices into the dictionary, -1 behind a frame's last."""
    values: Array
    """(F, L); radians of half angles, where atoms are logarithms."""

    def of_atoms(self, count: int) -> Array:
        """Give the matrix X of the paper, (K, F), of so many atoms."""
        matrix = np.zeros((count, len(self.atoms)))
        frame, place = np.nonzero(self.atoms >= 0)
        matrix[self.atoms[frame, place], frame] = self.values[frame, place]
        return matrix


class Space(Protocol):
    """What a combination of atoms is. Dictionaries are (K, J, c), atoms of length 1."""

    def atoms_of(self, turns: Array) -> Array:
        """Give an atom for each of some frames, (F, J, 4); 0 where a frame does not turn."""
        ...

    def code(self, turns: Array, dictionary: Array, most: int, tolerance: float = 0.0) -> Weights:
        """Find at most so many atoms for each frame, (F, J, 4), and their weights."""
        ...

    def improve(self, turns: Array, dictionary: Array, weights: Weights) -> tuple[Array, Weights]:
        """Give a better dictionary for the frames' choice of atoms, and better weights."""
        ...

    def combine(self, dictionary: Array, weights: Weights) -> Array:
        """Put frames together, (F, J, 4)."""
        ...


@dataclass(frozen=True, slots=True)
class Products:
    """QSSD: products of powers, the largest weight first (Eqs. 2 and 3).

    Atoms are the logarithms of the paper's: (K, J, 3).
    """

    importance: Array | None = None
    """(J,): what the angles of each joint count; 1 by default. Above 0."""
    sort: bool = False
    """Whether a weight may become larger than one that was chosen before, and change places with
    it. In the paper the descent stops there."""

    def atoms_of(self, turns: Array) -> Array:
        """Give logarithms of length 1."""
        logs = logarithm(turns)
        length = np.sqrt(((logs * self._importance(turns)[:, None]) ** 2).sum(axis=(1, 2)))
        return _scaled(logs, length)

    def code(self, turns: Array, dictionary: Array, most: int, tolerance: float = 0.0) -> Weights:
        """Code frames by Algorithm 2."""
        return Weights(
            *_core.code_by_products(
                turns, self._importance(turns), dictionary, most, tolerance, 0.0, self.sort
            )
        )

    def improve(self, turns: Array, dictionary: Array, weights: Weights) -> tuple[Array, Weights]:
        """Improve all atoms by Algorithm 3."""
        better, values = dictionary.copy(), weights.values.copy()
        _core.learn_products(turns, self._importance(turns), better, weights.atoms, values)
        return better, Weights(weights.atoms, values)

    def combine(self, dictionary: Array, weights: Weights) -> Array:
        """Multiply (Eq. 3)."""
        return _core.combine_products(dictionary, weights.atoms, weights.values)

    def _importance(self, turns: Array) -> Array:
        return np.ones(turns.shape[1]) if self.importance is None else self.importance


@dataclass(frozen=True, slots=True)
class LogSums:
    """K-SVD on logarithms: the exponential of a sum. Atoms are (K, J, 3)."""

    importance: Array | None = None
    """As of ``Products``."""

    def atoms_of(self, turns: Array) -> Array:
        """Give logarithms of length 1."""
        return Products(self.importance).atoms_of(turns)

    def code(self, turns: Array, dictionary: Array, most: int, tolerance: float = 0.0) -> Weights:
        """Code frames by orthogonal matching pursuit."""
        by = self._by(turns.shape[1])
        atoms = _flat(dictionary * by)
        return Weights(*_core.code_by_sums(_flat(logarithm(turns) * by), atoms, most, tolerance))

    def improve(self, turns: Array, dictionary: Array, weights: Weights) -> tuple[Array, Weights]:
        """Improve all atoms by Algorithm 1."""
        by = self._by(turns.shape[1])
        better, values = _flat(dictionary * by), weights.values.copy()
        _core.learn_sums(_flat(logarithm(turns) * by), better, weights.atoms, values)
        return better.reshape(dictionary.shape) / by, Weights(weights.atoms, values)

    def combine(self, dictionary: Array, weights: Weights) -> Array:
        """Add, and take the exponential."""
        return exponential(_summed(dictionary, weights))

    def _by(self, joints: int) -> Array:
        return (np.ones(joints) if self.importance is None else self.importance)[:, None]


@dataclass(frozen=True, slots=True)
class ComponentSums:
    """K-SVD on the four components, as the paper compares: sums are made unit quaternions again.

    Atoms are (K, J, 4).
    """

    def atoms_of(self, turns: Array) -> Array:
        """Give components of length 1."""
        return _scaled(turns, np.sqrt((turns**2).sum(axis=(1, 2))))

    def code(self, turns: Array, dictionary: Array, most: int, tolerance: float = 0.0) -> Weights:
        """Code frames by orthogonal matching pursuit."""
        return Weights(*_core.code_by_sums(_flat(turns), _flat(dictionary), most, tolerance))

    def improve(self, turns: Array, dictionary: Array, weights: Weights) -> tuple[Array, Weights]:
        """Improve all atoms by Algorithm 1."""
        better, values = _flat(dictionary).copy(), weights.values.copy()
        _core.learn_sums(_flat(turns), better, weights.atoms, values)
        return better.reshape(dictionary.shape), Weights(weights.atoms, values)

    def combine(self, dictionary: Array, weights: Weights) -> Array:
        """Add, and make unit quaternions; 0 becomes no turn."""
        sums = _summed(dictionary, weights)
        length = np.linalg.norm(sums, axis=-1, keepdims=True)
        return np.where(length > 0, sums / np.where(length > 0, length, 1), [1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, slots=True)
class Learned:
    """A dictionary, what it was learned from, and how."""

    dictionary: Array
    """(K, J, 3), or (K, J, 4) of components; atoms of length 1."""
    weights: Weights
    """Of the frames that it was learned from. Both are of the iteration with the least error."""
    errors: tuple[float, ...]
    """After each iteration the mean angle between the frames and their combinations, degrees."""
    replaced: int
    """How many atoms were replaced because no frame used them."""


def learn(
    space: Space,
    turns: Array,
    atoms: int,
    most: int,
    *,
    iterations: int = 50,
    seed: int = 0,
    settled: float = 0.0,
    start: Array | None = None,
    watch: Callable[[Array], None] = lambda _: None,
) -> Learned:
    """Learn a dictionary from frames (Algorithm 4).

    Parameters
    ----------
    space
        How atoms are combined.
    turns
        (F, J, 4) unit quaternions: for motion, displacements from a reference pose.
    atoms
        K. Where there are fewer frames that turn, some atoms stay 0.
    most
        L, at most 64.
    iterations
        How often Algorithms 2 and 3 are run.
    seed
        Of the choice of frames that the dictionary begins with. The same seed gives the same
        dictionary.
    settled
        Stop when an iteration improves the error by less than this part of it; 0: never.
    start
        (K, J, c) to begin with, instead of chosen frames.
    watch
        Is told the dictionary after each iteration.

    """
    if start is None:
        chosen = np.random.default_rng(seed).permutation(len(turns))
        candidates = space.atoms_of(turns[chosen])
        moving = candidates[(candidates != 0).any(axis=(1, 2))][:atoms]
        dictionary = np.zeros((atoms, *candidates.shape[1:]))
        dictionary[: len(moving)] = moving
    else:
        dictionary = start
    errors: list[float] = []
    replaced = 0
    weights = space.code(turns, dictionary, most)
    best = dictionary, weights
    for _ in range(iterations):
        dictionary, weights = space.improve(turns, dictionary, weights)
        dictionary, more = _with_used(space, turns, dictionary, weights)
        replaced += more
        weights = space.code(turns, dictionary, most)
        watch(dictionary)
        errors.append(mean_degrees(turns, space.combine(dictionary, weights)))
        if errors[-1] == min(errors):
            best = dictionary, weights
        if settled and len(errors) > 1 and errors[-2] - errors[-1] < settled * errors[-2]:
            break
    return Learned(*best, tuple(errors), replaced)


def mean_degrees(turns: Array, others: Array) -> float:
    """Give the mean angle between two arrays of turns, (F, J, 4), degrees per joint and frame.

    Twice what Eq. 11 gives, whose arc cosine is of half angles, and with the same for q and -q.
    """
    return float(turned_degrees(turns, others).mean()) if turns.size else 0.0


def _with_used(
    space: Space, turns: Array, dictionary: Array, weights: Weights
) -> tuple[Array, int]:
    """Replace atoms that no frame uses by the frames that are worst coded."""
    used = np.bincount(weights.atoms[weights.atoms >= 0], minlength=len(dictionary))
    (unused,) = np.nonzero(used == 0)
    if not len(unused):
        return dictionary, 0
    far = turned_degrees(turns, space.combine(dictionary, weights)).sum(axis=1)
    candidates = space.atoms_of(turns[np.argsort(-far, kind="stable")[: len(unused)]])
    replaced = dictionary.copy()
    replaced[unused[: len(candidates)]] = candidates
    return replaced, len(candidates)


def _summed(dictionary: Array, weights: Weights) -> Array:
    padded = np.concatenate([dictionary, np.zeros((1, *dictionary.shape[1:]))])
    sums = np.zeros((len(weights.atoms), *dictionary.shape[1:]))
    for atoms, values in zip(weights.atoms.T, weights.values.T, strict=True):
        sums += padded[atoms] * values[:, None, None]
    return sums


def _flat(rows: Array) -> Array:
    return np.ascontiguousarray(rows.reshape(len(rows), rows.shape[1] * rows.shape[2]))


def _scaled(rows: Array, lengths: Array) -> Array:
    by = np.where(lengths > 0, lengths, 1.0)[:, None, None]
    scaled: Array = rows / by
    return scaled
