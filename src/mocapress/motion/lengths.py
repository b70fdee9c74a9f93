"""Distances between markers that a body keeps: which they are, how they drift, keeping them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import ParameterError
from mocapress.motion.clip import Clip
from mocapress.motion.markers import POINTS, markers

Array = NDArray[np.float64]
_STAYS = 0.02
"""Of a mean length: standard deviation up to which it counts as one that is kept."""
_MOST_LOOKED_AT = 500
_OFTEN = 0.1
"""Of the frames in which both must be there: a distance in a few of them says little."""
_MOST_MARKERS = 512
_SWEEPS = 8


@dataclass(frozen=True, slots=True)
class Bone:
    """Two markers, or joints, whose distance stays.

    Attributes
    ----------
    near
        Of the two the one that is nearer to the middle of the body, counted from 0.
    far
        The other one.
    length
        Mean over the frames, in the unit of the clip.
    spread
        Standard deviation over the frames.

    """

    near: int
    far: int
    length: float
    spread: float


def bones(clip: Clip) -> tuple[Bone, ...]:
    """Find the bones of markers: each marker and the one from which its distance changes least.

    They form a tree, or several, without the pairs whose distance is not kept; each bone stands
    behind the one that leads to it.

    Parameters
    ----------
    clip
        With a stream ``points``, of a C3D or TRC. Markers that are missing are left out of means;
        of more than 512 markers there are no bones.

    Raises
    ------
    UnsupportedError
        When it has no markers.

    """
    found = markers(clip)
    count = len(found.labels)
    places = np.where(found.valid[:, :, None], found.positions, np.nan)
    if not 2 <= count <= _MOST_MARKERS or not len(places):
        return ()
    means, spreads = _kept(places[:: max(1, len(places) // _MOST_LOOKED_AT)])
    waiting = [int(i) for i in np.argsort(means.sum(axis=1), kind="stable")]
    tree: list[tuple[int, int]] = []
    reached: list[int] = [waiting.pop(0)]
    while waiting:
        own = spreads[np.ix_(reached, waiting)]
        near, far = divmod(int(own.argmin()), len(waiting))
        if np.isfinite(own[near, far]):
            tree.append((reached[near], waiting[far]))
        else:
            far = 0  # nothing is tied to those before: another tree
        reached.append(waiting.pop(far))
    lengths = _lengths(places, tree)
    return tuple(
        Bone(near, far, float(np.nanmean(own)), float(np.nanstd(own)))
        for (near, far), own in zip(tree, lengths.T, strict=True)
    )


def bone_drift(original: Clip, decoded: Clip, of: Sequence[Bone] | None = None) -> Array:
    """Give how far the bones of a clip are off in another, (F, bones), in the unit of the clip.

    NaN where a marker is missing in one of the two.

    Raises
    ------
    UnsupportedError
        When a clip has no markers.

    """
    tree = [(bone.near, bone.far) for bone in (bones(original) if of is None else of)]
    lengths = []
    for clip in (decoded, original):
        found = markers(clip)
        lengths.append(_lengths(np.where(found.valid[:, :, None], found.positions, np.nan), tree))
    drift: Array = lengths[0] - lengths[1]
    return drift


def constant_lengths(clip: Clip, of: Sequence[Bone] | None = None) -> Clip:
    """Move markers as little as that takes for their bones to have the same length in all frames.

    Both ends of a bone move by half of what it is off, for all bones several times over; at last
    each far end is set, from the middle of the body outwards, so that the lengths are met exactly.
    Where one of the two is missing, nothing is moved.

    Parameters
    ----------
    clip
        With a stream ``points``.
    of
        Bones with their lengths; without it, those of the clip (``bones``).

    Raises
    ------
    ParameterError
        When a bone is of a marker that is not there.
    UnsupportedError
        When the clip has no markers.

    """
    found = markers(clip)
    of = bones(clip) if of is None else of
    if any(max(bone.near, bone.far) >= len(found.labels) for bone in of):
        raise ParameterError("bones", expected=f"of {len(found.labels)} markers", found="others")
    places = np.array(found.positions)
    for sweep in range(_SWEEPS + 1):
        share = 0.5 if sweep < _SWEEPS else 0.0
        for bone in of:
            along = places[:, bone.far] - places[:, bone.near]
            length = np.linalg.norm(along, axis=1)
            both = found.valid[:, bone.near] & found.valid[:, bone.far] & (length > 0)
            move = np.zeros_like(along)
            move[both] = along[both] * (bone.length / length[both] - 1)[:, None]
            places[:, bone.far] += (1 - share) * move
            places[:, bone.near] -= share * move
    points = clip.streams[POINTS]
    flat = places.reshape(points.frames, points.channels)
    return replace(clip, streams={**clip.streams, POINTS: replace(points, values=flat)})


def _kept(places: Array) -> tuple[Array, Array]:
    """Give means and standard deviations of distances, (P, P); infinite where they are not kept."""
    count = places.shape[1]
    means, spreads = np.full((2, count, count), np.inf)
    for i in range(count):
        away = np.linalg.norm(places - places[:, i : i + 1], axis=2)
        seen = np.isfinite(away).sum(axis=0)
        known = seen > _OFTEN * len(places)
        means[i, known] = np.nansum(away[:, known], axis=0) / seen[known]
        squares = np.nansum((away[:, known] - means[i, known]) ** 2, axis=0)
        spreads[i, known] = np.sqrt(squares / seen[known])
    stays = (means > 0) & np.isfinite(means) & (spreads <= _STAYS * means)
    return means, np.where(stays, spreads, np.inf)


def _lengths(places: Array, tree: Sequence[tuple[int, int]]) -> Array:
    ends = np.array(tree, dtype=np.intp).reshape(-1, 2)
    found: Array = np.linalg.norm(places[:, ends[:, 1]] - places[:, ends[:, 0]], axis=2)
    return found
