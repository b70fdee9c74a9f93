"""Options of the QSSD paper's outlook, on logarithms: what weights and atoms may be."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from mocapress.codecs.qssd.decomposition import LogSums, Weights
from mocapress.codecs.qssd.quaternions import logarithm

Array = NDArray[np.float64]
Fit = Callable[[Array, Array], Array]
"""Gives weights of atoms, (L, D), for a frame, (D,)."""
_LEAST = 1e-9


@dataclass(frozen=True, slots=True)
class NonNegative(LogSums):
    """Weights are 0 or above: a frame is put together from parts, and nothing is taken away."""

    def code(self, turns: Array, dictionary: Array, most: int, tolerance: float = 0.0) -> Weights:
        """Choose atoms as ``LogSums``, and fit weights that are not below 0.

        An atom whose best weight is 0 leaves the frame.
        """
        found = LogSums.code(self, turns, dictionary, most, tolerance)
        return _refitted(turns, dictionary, found, lambda atoms, frame: nnls(atoms.T, frame)[0])

    def improve(self, turns: Array, dictionary: Array, weights: Weights) -> tuple[Array, Weights]:
        """Improve as ``LogSums``, with the sign by which an atom is used most."""
        better, found = LogSums.improve(self, turns, dictionary, weights)
        sums = found.of_atoms(len(dictionary)).sum(axis=1)
        signs = np.where(sums < 0, -1.0, 1.0)
        values = found.values * np.where(found.atoms >= 0, signs[found.atoms], 1.0)
        return better * signs[:, None, None], Weights(found.atoms, values)


@dataclass(frozen=True, slots=True)
class SumOne(LogSums):
    """Weights add up to one number, so that a frame is a mean of its atoms.

    Atoms have length 1, so the number is the mean length of frames instead of 1.
    """

    def code(self, turns: Array, dictionary: Array, most: int, tolerance: float = 0.0) -> Weights:
        """Choose atoms as ``LogSums``, and fit with the sum held."""
        found = LogSums.code(self, turns, dictionary, most, tolerance)
        logs = logarithm(turns).reshape(len(turns), -1)
        total = float(np.linalg.norm(logs, axis=1).mean())

        def fit(atoms: Array, frame: Array) -> Array:
            products = atoms @ atoms.T + _LEAST * np.eye(len(atoms))
            free, ones = np.linalg.solve(
                products, np.stack([atoms @ frame, np.ones(len(atoms))], 1)
            ).T
            held: Array = free + ones * (total - free.sum()) / ones.sum()
            return held

        return _refitted(turns, dictionary, found, fit)


@dataclass(frozen=True, slots=True)
class FewJoints(LogSums):
    """Atoms turn few joints."""

    joints: int = 6

    def atoms_of(self, turns: Array) -> Array:
        """Give logarithms of the joints that turn most."""
        return self._few(LogSums.atoms_of(self, turns))

    def improve(self, turns: Array, dictionary: Array, weights: Weights) -> tuple[Array, Weights]:
        """Improve as ``LogSums``, and leave each atom the joints that it turns most."""
        better, found = LogSums.improve(self, turns, dictionary, weights)
        return self._few(better), found

    def _few(self, atoms: Array) -> Array:
        sizes = np.linalg.norm(atoms, axis=2)
        least = np.sort(sizes, axis=1)[:, -min(self.joints, sizes.shape[1])]
        kept = np.where((sizes >= least[:, None])[..., None], atoms, 0.0)
        lengths = np.sqrt((kept**2).sum(axis=(1, 2)))
        scaled: Array = kept / np.where(lengths > 0, lengths, 1.0)[:, None, None]
        return scaled


def _refitted(turns: Array, dictionary: Array, weights: Weights, fit: Fit) -> Weights:
    """Fit the weights of each frame's atoms anew."""
    logs = logarithm(turns).reshape(len(turns), -1)
    flat = dictionary.reshape(len(dictionary), -1)
    atoms, values = weights.atoms.copy(), weights.values.copy()
    for f, frame in enumerate(logs):
        own = atoms[f][atoms[f] >= 0]
        if not len(own):
            continue
        fitted = fit(flat[own], frame)
        used = np.abs(fitted) > _LEAST
        atoms[f], values[f] = -1, 0.0
        atoms[f, : used.sum()], values[f, : used.sum()] = own[used], fitted[used]
    return Weights(atoms, values)
