"""How far two clips of the same motion are from each other."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import tau

import numpy as np

from mocapress.errors import ParameterError
from mocapress.motion.clip import Clip
from mocapress.motion.kinematics import Array, positions
from mocapress.motion.lengths import bone_drift, bones
from mocapress.motion.markers import POINTS, markers
from mocapress.motion.stream import Column

_TURN = {"deg": 360.0, "rad": tau}
"""A whole turn by unit."""


@dataclass(frozen=True, slots=True, eq=False)
class Difference:
    """Errors by channel, with skeletons by joint, of markers by the lengths between them.

    Attributes
    ----------
    channels
        Names of the channels.
    largest
        (C,) largest error of each channel, in its unit; infinite where one of two is not finite.
    mean
        (C,) mean error of each channel.
    psnr
        -10 log10 of the mean squared error of all values, dB; infinite without error.
    errors
        (F, C) error of each channel in each frame.
    joints
        Names of the joints; empty without skeletons.
    largest_distance
        (J,) largest distance of each joint, length units of the file; None without skeletons.
    mean_distance
        (J,) mean distance of each joint.
    distances
        (F, J) distance of each joint in each frame.
    bones
        Of markers: pairs whose distance stays in the first clip (``mp.bones``).
    largest_drift
        (B,) how far the length of each bone is off, at most.
    mean_drift
        (B,) and on average.

    """

    channels: tuple[str, ...]
    largest: Array
    mean: Array
    psnr: float
    errors: Array
    joints: tuple[str, ...] = ()
    largest_distance: Array | None = None
    mean_distance: Array | None = None
    distances: Array | None = None
    bones: tuple[str, ...] = ()
    largest_drift: Array | None = None
    mean_drift: Array | None = None

    @property
    def most(self) -> float:
        """The largest error of any channel."""
        return float(self.largest.max(initial=0))


def compare(first: Clip, second: Clip) -> Difference:
    """Measure how far a clip is from another of the same frames and channels.

    Parameters
    ----------
    first, second
        Of the same columns, by name. Angles count modulo a whole turn, so that 359 and -1 degrees
        are the same. Where both have a skeleton, positions of joints are compared, too, each clip's
        by its own.

    Raises
    ------
    ParameterError
        When frames or columns differ.

    """
    names = tuple(column.name for column in first.columns)
    if names != tuple(column.name for column in second.columns):
        raise ParameterError("the clips have different channels")
    if first.frames != second.frames:
        raise ParameterError("frames", expected=str(first.frames), found=str(second.frames))
    a, b = first.values, second.values
    errors = errors_of(a, b, first.columns)
    with np.errstate(over="ignore"):
        square = float(np.square(errors).mean()) if errors.size else 0.0
        psnr = float(-10 * np.log10(square)) if square else float("inf")
    joints: tuple[str, ...] = ()
    distances = None
    if first.skeleton and second.skeleton and first.skeleton.names == second.skeleton.names:
        joints = first.skeleton.names
        distances = distances_of(first, second)
    tied: tuple[str, ...] = ()
    drift = None
    if POINTS in first.streams and POINTS in second.streams:
        labels = markers(first).labels
        own = bones(first)
        tied = tuple(f"{labels[bone.near]} - {labels[bone.far]}" for bone in own)
        # A marker that is missing has no length.
        drift = np.nan_to_num(np.abs(bone_drift(first, second, own)))
    return Difference(
        names,
        errors.max(axis=0, initial=0),
        _mean(errors),
        psnr,
        errors,
        joints,
        None if distances is None else distances.max(axis=0, initial=0),
        None if distances is None else _mean(distances),
        distances,
        tied,
        None if drift is None else drift.max(axis=0, initial=0),
        None if drift is None else _mean(drift),
    )


def distances_of(first: Clip, second: Clip) -> Array:
    """Give how far the joints of two clips of one tree of joints are from each other, (F, J).

    Raises
    ------
    UnsupportedError
        When joints cannot be placed.

    """
    distances: Array = np.linalg.norm(positions(first) - positions(second), axis=2)
    return distances


def errors_of(original: Array, decoded: Array, columns: Sequence[Column] = ()) -> Array:
    """Give the errors of values, 0 or above: infinite where one of two is not finite.

    Of columns that are angles, by what remains of the error beside whole turns.
    """
    same = (original == decoded) | (np.isnan(original) & np.isnan(decoded))
    with np.errstate(invalid="ignore", over="ignore"):
        errors: Array = np.abs(original - decoded)
    for c, column in enumerate(columns):
        if turn := _TURN.get(column.unit):
            own = errors[:, c]
            with np.errstate(invalid="ignore"):
                errors[:, c] = np.where(
                    own > turn / 2, np.abs(own - turn * np.rint(own / turn)), own
                )
    errors[same] = 0
    errors[~same & ~(np.isfinite(original) & np.isfinite(decoded))] = np.inf
    return errors


def _mean(errors: Array) -> Array:
    mean: Array = errors.sum(axis=0) / max(len(errors), 1)
    return mean
