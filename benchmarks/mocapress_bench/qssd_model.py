"""Section 4 of the QSSD paper: made-up data, errors on motion, and time an iteration."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.codecs.qssd.decomposition import (
    ComponentSums,
    LogSums,
    Products,
    Space,
    Weights,
    learn,
    mean_degrees,
)
from mocapress.codecs.qssd.quaternions import conjugate, logarithm
from mocapress.codecs.qssd.quaternions import product as turned
from mocapress.motion.kinematics import local_rotations

Array = NDArray[np.float64]
Row = dict[str, Any]
Progress = Callable[[str], None]

SPACES: dict[str, Space] = {
    "QSSD": Products(),
    "QSSD, weights change places": Products(sort=True),
    "K-SVD, components": ComponentSums(),
    "K-SVD, logarithms": LogSums(),
}
_RESTORED = 0.01
"""Largest distance of an atom that counts as recovered."""


@dataclass(frozen=True, slots=True)
class MadeUp:
    """Sizes of made-up data: the paper's by default."""

    joints: int = 20
    atoms: int = 20
    most: int = 5
    frames: int = 500


def made_up(sizes: MadeUp, reach: float, noise: float, seed: int) -> tuple[Array, Array]:
    """Make a dictionary and frames that it combines.

    Parameters
    ----------
    sizes
        How many joints, atoms, atoms of a frame, and frames.
    reach
        Standard deviation of the coefficients, which are normal: radians of half an angle, on atoms
        of length 1. 0: atoms are random unit quaternions as they are, about 5 radians long, and
        coefficients uniform from -1 to 1.
    noise
        Signal over noise, dB; infinite: none. Normal noise is added to all four components, whose
        squares add up to 1, and the quaternions are made unit length again.
    seed
        Of all choices.

    Returns
    -------
    tuple
        Logarithms of the atoms, (K, J, 3), at length 1, and the frames, (F, J, 4).

    """
    random = np.random.default_rng(seed)
    quaternions = random.normal(size=(sizes.atoms, sizes.joints, 4))
    atoms = logarithm(quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True))
    lengths = np.sqrt((atoms**2).sum(axis=(1, 2)))
    atoms /= lengths[:, None, None]
    chosen = random.permuted(np.tile(np.arange(sizes.atoms), (sizes.frames, 1)), axis=1)
    chosen = chosen[:, : sizes.most].astype(np.int32)
    if reach:
        values = reach * random.normal(size=chosen.shape)
    else:
        values = random.uniform(-1, 1, chosen.shape) * lengths[chosen]
    order = np.argsort(-np.abs(values), axis=1, kind="stable")
    weights = Weights(
        np.take_along_axis(chosen, order, axis=1), np.take_along_axis(values, order, axis=1)
    )
    frames = Products().combine(atoms, weights)
    if np.isfinite(noise):
        frames = frames + 10 ** (-noise / 20) / 2 * random.normal(size=frames.shape)
        frames /= np.linalg.norm(frames, axis=-1, keepdims=True)
    return atoms, frames


def restored(found: Array, original: Array) -> float:
    """Give the part of found atoms that are near an original one (Eq. 10, on logarithms)."""
    likeness = np.abs(found.reshape(len(found), -1) @ original.reshape(len(original), -1).T)
    return float((1 - likeness.max(axis=1) < _RESTORED).mean())


def simulate(
    sizes: MadeUp,
    reaches: Sequence[float],
    noises: Sequence[float],
    *,
    iterations: int,
    seed: int,
    progress: Progress,
) -> list[Row]:
    """Learn from made-up data: errors and parts restored after each iteration (Fig. 1)."""
    rows = []
    names = [name for name in SPACES if name != "K-SVD, components"]
    for reach, noise, name in product(reaches, noises, names):
        progress(f"simulation: coefficients {reach:g}, noise {noise:g} dB, {name}")
        original, frames = made_up(sizes, reach, noise, seed)
        curve: list[float] = []

        def watch(found: Array, curve: list[float] = curve, original: Array = original) -> None:
            curve.append(restored(found, original))

        learned = learn(
            SPACES[name],
            frames,
            sizes.atoms,
            sizes.most,
            iterations=iterations,
            seed=seed,
            watch=watch,
        )
        rows.append(
            {
                "model": name,
                "coefficients": reach,
                "noise": noise if np.isfinite(noise) else None,
                "errors": list(learned.errors),
                "restored": curve,
            }
        )
    return rows


def turns_of(clips: Sequence[mp.Clip], most: int) -> Array:
    """Give joints' turns from the first frame of their clip (section 4.2), (F, J, 4).

    Frames are evenly spread over all clips, at most so many. Clips with other joints than the
    first are left out, and so is the root, which the paper codes apart.
    """
    first = clips[0].skeleton
    alike = [clip for clip in clips if first and clip.skeleton and len(clip.skeleton.joints) > 1]
    alike = [c for c in alike if c.skeleton and first and c.skeleton.names == first.names]
    total = sum(clip.frames for clip in alike)
    every = max(1, -(-total // most))
    parts, passed = [], 0
    for clip in alike:
        rotations = local_rotations(clip)
        taken = rotations[(-passed) % every :: every, 1:]
        parts.append(turned(conjugate(rotations[:1, 1:]), taken))
        passed += clip.frames
    return np.concatenate(parts)


def errors_on_motion(
    turns: Array, atoms: int, most: int, iterations: int, splits: int, progress: Progress
) -> list[Row]:
    """Learn from four fifths of the frames, and code the others, too (Table 1)."""
    rows = []
    for name, space in SPACES.items():
        trained, tested = [], []
        for seed in range(splits):
            progress(f"errors on motion: {name}, split {seed + 1} of {splits}")
            order = np.random.default_rng(seed).permutation(len(turns))
            cut = 4 * len(turns) // 5
            own, others = (np.ascontiguousarray(turns[part]) for part in (order[:cut], order[cut:]))
            learned = learn(space, own, atoms, most, iterations=iterations, seed=seed)
            trained.append(min(learned.errors))
            coded = space.code(others, learned.dictionary, most)
            tested.append(mean_degrees(others, space.combine(learned.dictionary, coded)))
        rows.append(
            {
                "model": name,
                "training": float(np.mean(trained)),
                "test": float(np.mean(tested)),
                "spread of test": float(np.std(tested)),
            }
        )
    return rows


def times(turns: Array, frames: Sequence[int], progress: Progress) -> list[Row]:
    """Measure seconds an iteration, N x K x L as in Table 2: elapsed, and of all processors."""
    rows = []
    for count, atoms, most in product(frames, (50, 100), (5, 10)):
        some = np.ascontiguousarray(turns[np.linspace(0, len(turns) - 1, count).astype(int)])
        for name, space in SPACES.items():
            progress(f"time an iteration: {count} frames, {atoms} atoms, {most} a frame, {name}")
            dictionary = learn(space, some, atoms, most, iterations=1).dictionary
            weights = space.code(some, dictionary, most)
            elapsed, spent = time.perf_counter(), time.process_time()
            better, _ = space.improve(some, dictionary, weights)
            space.code(some, better, most)
            rows.append(
                {
                    "model": name,
                    "frames": count,
                    "atoms": atoms,
                    "most": most,
                    "seconds": time.perf_counter() - elapsed,
                    "of all processors": time.process_time() - spent,
                }
            )
    return rows
