"""Dictionaries of poses as whole codecs: the paper's section 5.1 with any way to combine atoms.

Every eighth pose is a combination of atoms, turned from the mean pose; those between are
interpolated. So QSSD, both K-SVDs and the options of the paper's outlook stand side by side, with
nothing else that differs. The codec ``qssd`` is another one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log2
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.codecs.qssd.decomposition import Learned, Space, Weights, learn
from mocapress.codecs.qssd.quaternions import conjugate, product
from mocapress.motion.kinematics import local_rotations
from mocapress_bench.qssd import centimetres, centimetres_per_unit

Array = NDArray[np.float64]
Row = dict[str, Any]

EVERY = 8
"""Three levels of detail are left out."""
_PARTS = 128
"""Steps of an atom's parts to its length of 1."""


@dataclass(frozen=True, slots=True)
class Poses:
    """What is coded of a clip."""

    turns: Array
    """(F, J, 4) rotations relative to the parents, the root first."""
    root: Array
    """(F, 3) places of the root, cm."""
    places: Array
    """(F, P, 3) places of joints and ends, cm."""
    clip: mp.Clip
    text: int
    """Bytes of the file."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Figures, and the dictionaries that they are of."""

    rows: list[Row]
    learned: dict[str, Learned]
    middle: Array
    """(J, 4): the mean pose, without the root."""


def poses_of(clip: mp.Clip, text: int) -> Poses:
    """Take what is coded of a clip."""
    places = centimetres(clip)
    return Poses(local_rotations(clip), places[:, 0], places, clip, text)


def measure(
    clips: Sequence[Poses],
    spaces: dict[str, Space],
    *,
    atoms: int,
    most: int,
    steps: Sequence[float],
    iterations: int,
    seed: int = 0,
    progress: Callable[[str], None] = lambda _: None,
) -> Measured:
    """Learn a dictionary of all clips and code them with it, for each way to combine atoms.

    Sizes are the entropies of all numbers, each kind by itself: less than a coder takes.

    Parameters
    ----------
    clips
        Of one skeleton.
    spaces
        Ways to combine atoms, by name.
    atoms, most, iterations, seed
        As of ``learn``.
    steps
        Of weights, in units of a weight's mean magnitude.
    progress
        Is told each way.

    """
    kept = [np.unique(np.r_[0 : len(one.turns) : EVERY, len(one.turns) - 1]) for one in clips]
    coded = np.concatenate([one.turns[own, 1:] for one, own in zip(clips, kept, strict=True)])
    middle = _mean(coded)
    turns = np.ascontiguousarray(product(conjugate(middle), coded))
    rows, found = [], {}
    for name, space in spaces.items():
        progress(name)
        learned = learn(space, turns, atoms, most, iterations=iterations, seed=seed)
        found[name] = learned
        parts = np.rint(learned.dictionary * _PARTS)
        exact = space.code(turns, parts / _PARTS, most)
        usual = float(np.abs(exact.values[exact.atoms >= 0]).mean())
        for step in steps:
            whole = step * usual * np.rint(exact.values / (step * usual))
            weights = Weights(exact.atoms, np.where(exact.atoms >= 0, whole, 0.0))
            back = product(middle, space.combine(parts / _PARTS, weights))
            bits = _entropy(parts) + _bits(weights, atoms, step * usual)
            rows.append(_row(name, step, clips, kept, back, bits))
    return Measured(rows, found, middle)


def _bits(weights: Weights, atoms: int, step: float) -> float:
    """Count which atoms each frame has, as a set, and their weights."""
    used = (weights.atoms >= 0) & (weights.values != 0)
    chances = np.bincount(weights.atoms[used], minlength=atoms) / max(len(weights.atoms), 1)
    sets: float = sum(
        -p * log2(p) - (1 - p) * log2(1 - p) for p in chances.tolist() if 0 < p < 1
    ) * len(weights.atoms)
    return sets + _entropy(np.rint(weights.values[used] / step))


def _entropy(numbers: Array) -> float:
    """Give the bits of whole numbers by how often each occurs, all together."""
    _, counts = np.unique(numbers, return_counts=True)
    return float(-(counts * np.log2(counts / max(counts.sum(), 1))).sum())


def _row(
    name: str,
    step: float,
    clips: Sequence[Poses],
    kept: Sequence[NDArray[np.intp]],
    back: Array,
    bits: float,
) -> Row:
    """Put clips together and measure them.

    The root is kept in steps of 0.5 cm, and of 0.01 of a quaternion's parts; counted is the entropy
    of second differences, the same in all rows.
    """
    errors, at = [], 0
    steps_of_roots: list[Array] = []
    for one, own in zip(clips, kept, strict=True):
        places = np.rint(one.root[own] / 0.5)
        turns = np.rint(_continued(one.turns[own, 0]) / 0.01)
        steps_of_roots += [np.diff(places, 2, axis=0).ravel(), np.diff(turns, 2, axis=0).ravel()]
        poses = np.concatenate([(0.01 * turns)[:, None], back[at : at + len(own)]], axis=1)
        at += len(own)
        frames = np.arange(len(one.turns))
        between = _interpolated(_continued(poses), own, frames)
        between /= np.linalg.norm(between, axis=-1, keepdims=True)
        found = placed(one.clip, between, _interpolated(0.5 * places, own, frames))
        errors.append(np.sqrt(((found - one.places) ** 2).sum(axis=-1).mean(axis=-1)))
    size = (bits + _entropy(np.concatenate(steps_of_roots))) / 8
    arms = np.concatenate(errors)
    return {
        "codec": name,
        "step": step,
        "ratio": sum(one.text for one in clips) / size,
        "bytes": round(size),
        "ARMS, cm": float(arms.mean()),
        "largest": float(arms.max()),
    }


def placed(clip: mp.Clip, turns: Array, root: Array) -> Array:
    """Give places of joints and ends, (F, P, 3), cm, of rotations and the root's path."""
    assert clip.skeleton is not None
    by = centimetres_per_unit(clip)
    places = np.empty((*turns.shape[:2], 3))
    world = np.empty_like(turns)
    ends = []
    for j, joint in enumerate(clip.skeleton.joints):
        if joint.parent < 0:
            places[:, j], world[:, j] = root, turns[:, j]
        else:
            above = joint.parent
            places[:, j] = places[:, above] + _moved(world[:, above], by * np.array(joint.offset))
            world[:, j] = product(world[:, above], turns[:, j])
        ends += [places[:, j] + _moved(world[:, j], by * np.array(end)) for end in joint.ends]
    return np.concatenate([places, np.stack(ends, axis=1)], axis=1) if ends else places


def _moved(turns: Array, offset: Array) -> Array:
    """Turn a vector, (3,), by turns, (F, 4)."""
    vector = np.broadcast_to(np.r_[0.0, offset], turns.shape)
    return product(product(turns, vector), conjugate(turns))[:, 1:]


def _interpolated(values: Array, at: NDArray[np.intp], frames: NDArray[np.intp]) -> Array:
    """Interpolate by cubics through values, (N, ...), at some frames, (N,)."""
    from scipy.interpolate import CubicSpline

    if len(at) < 3:
        weight = (frames / max(int(at[-1]), 1)).reshape(-1, *[1] * (values.ndim - 1))
        line: Array = values[0] + weight * (values[-1] - values[0])
        return line
    curve: Array = CubicSpline(at, values)(frames)
    return curve


def _continued(turns: Array) -> Array:
    """Choose of q and -q what is nearer to the frame before."""
    far = (turns[1:] * turns[:-1]).sum(axis=-1) < 0
    signs = np.concatenate([np.ones((1, *far.shape[1:])), np.where(far, -1.0, 1.0)]).cumprod(axis=0)
    continued: Array = turns * signs[..., None]
    return continued


def _mean(turns: Array) -> Array:
    aligned = np.where((turns * turns[:1]).sum(axis=-1, keepdims=True) < 0, -turns, turns)
    mean = aligned.mean(axis=0)
    middle: Array = mean / np.linalg.norm(mean, axis=-1, keepdims=True)
    return middle
