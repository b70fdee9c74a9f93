"""The matching trellis: below each frame of a database, those that resemble it (Section III-A).

The search is FLANN's, by randomized k-d trees (the paper's reference [47]), which OpenCV has.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import UnsupportedError
from mocapress.motion import Column, Skeleton

Features = NDArray[np.float32]
Frames = NDArray[np.int32]

APART = 60
"""Frames on either side of a frame that are no matches of it: its own neighbourhood."""
LAG = 12
"""Frames after which it is measured how far postures move, for the radius: 0.1 s at 120 Hz."""
CHECKS = 1024
"""Leaves of the trees that a search looks at."""
MOST_MATCHES = 256
"""Of a frame, the nearest, before its neighbourhood is left out."""
_TREES = 4
_SEED = 1

_IMPORTANT = re.compile(
    r"root|pelvis|hip|back|spine|chest|thorax|torso|clavicle|collar|shoulder|humerus|arm|radius"
    r"|femur|thigh|up(per)?_?leg"
)
"""Joints from thigh and arm inward; the paper names hip, back, humerus, radius and femur."""
_MANHATTAN = 2  # of FLANN's distances
_TREES_INDEX = 1  # randomized k-d trees, of its indices


@dataclass(frozen=True, slots=True, eq=False)
class Trellis:
    """Frame t has the matches ``matches[starts[t]:starts[t + 1]]``, in ascending order."""

    starts: NDArray[np.int64]
    """(F + 1,)."""
    matches: Frames
    distances: NDArray[np.float32]
    """Of Eq. 2, less than the radius."""
    clips: Frames
    """(F,) the clip of each frame."""
    radius: float

    def column(self, frame: int) -> Frames:
        """Give the matches of a frame."""
        return self.matches[self.starts[frame] : self.starts[frame + 1]]


def weights(columns: Sequence[Column], skeleton: Skeleton | None) -> NDArray[np.float32]:
    """Give the weight of each column in Eq. 2, (C,): 0.7, 0.3, or 0 where it is left out.

    Translations and the heading, which is the root's rotation about the vertical axis y, say where
    somebody is and not how: they are left out.
    """
    joints = skeleton.joints if skeleton else ()
    found = np.empty(len(columns), np.float32)
    for c, column in enumerate(columns):
        known = 0 <= column.joint < len(joints)
        name = joints[column.joint].name if known else column.name.rpartition(".")[0]
        root = joints[column.joint].parent < 0 if known else column.joint == 0
        if column.kind.startswith("t") or (root and column.kind == "ry"):
            found[c] = 0
        else:
            found[c] = 0.7 if root or _IMPORTANT.search(name.lower()) else 0.3
    return found


def features(values: NDArray[np.float64], weight: NDArray[np.float32]) -> Features:
    """Give postures whose Manhattan distance is that of Eq. 2: (F, columns that count)."""
    kept = weight > 0
    scaled = np.where(np.isfinite(values[:, kept]), values[:, kept], 0) * weight[kept]
    return np.ascontiguousarray(np.clip(scaled, -1e9, 1e9), np.float32)


def exact_matches(postures: Features, frame: int, clips: Frames, radius: float) -> Frames:
    """Give all matches of a frame: what the randomized search should find."""
    distances = np.abs(postures - postures[frame]).sum(axis=1)
    around = slice(max(frame - APART, 0), frame + APART + 1)
    distances[around][clips[around] == clips[frame]] = np.inf
    return np.flatnonzero(distances < radius).astype(np.int32)


def data_radius(postures: Features, clips: Frames) -> float:
    """Derive the radius, on which the paper is silent: how far one moves in a tenth of a second.

    It is the median distance of frames that are ``LAG`` apart in a clip and differ; 0 where there
    are none.
    """
    distances = np.abs(postures[LAG:] - postures[:-LAG]).sum(axis=1)
    moved = distances[(clips[LAG:] == clips[:-LAG]) & (distances > 0)]
    return float(np.median(moved)) if len(moved) else 0.0


def build(
    postures: Features, clips: Frames, *, radius: float | None = None, checks: int = CHECKS
) -> Trellis:
    """Find the matches of all frames (Eq. 1).

    Parameters
    ----------
    postures
        Of ``features``, (F, D).
    clips
        (F,) the clip of each frame.
    radius
        R of Eq. 1; without it, ``data_radius``.
    checks
        How many leaves a search looks at: more find more, and take longer.

    Raises
    ------
    UnsupportedError
        When OpenCV is not there.

    """
    if radius is None:
        radius = data_radius(postures, clips)
    found = [np.empty(0, np.int32)] * len(postures)
    near = [np.empty(0, np.float32)] * len(postures)
    if radius > 0 and postures.shape[1]:
        index = _index(postures)
        for t in range(len(postures)):
            found[t], near[t] = _search(index, postures, t, clips, radius, checks)
    sizes = [len(matches) for matches in found]
    return Trellis(
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        np.concatenate([np.empty(0, np.int32), *found]),
        np.concatenate([np.empty(0, np.float32), *near]),
        clips,
        radius,
    )


def _index(postures: Features) -> Any:
    try:
        import cv2
    except ImportError:
        raise UnsupportedError(
            "finding recurring patterns needs OpenCV", expected="pip install 'mocapress[mrpa]'"
        ) from None
    found: Any = cv2
    found.setRNGSeed(_SEED)  # the trees are random, and the same on every run
    return found.flann_Index(postures, {"algorithm": _TREES_INDEX, "trees": _TREES}, _MANHATTAN)


def _search(
    index: Any, postures: Features, frame: int, clips: Frames, radius: float, checks: int
) -> tuple[Frames, NDArray[np.float32]]:
    count, indices, distances = index.radiusSearch(
        postures[frame : frame + 1], radius, MOST_MATCHES, params={"checks": checks}
    )
    matches, near = indices[0, :count], distances[0, :count]
    own = (np.abs(matches - frame) <= APART) & (clips[matches] == clips[frame])
    kept = ~own & (near < radius)
    order = np.argsort(matches[kept], kind="stable")
    return matches[kept][order].astype(np.int32), near[kept][order]
