"""Motion of sixteen standard joints: what clips of any skeleton are compared by."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from mocapress.errors import UnsupportedError
from mocapress.motion import Clip
from mocapress.motion.kinematics import positions
from mocapress.motion.standard_joints import JOINTS, REQUIRED, SIDED, by_mapping, by_names
from mocapress.search.topology import by_topology, head_between

Array = NDArray[np.float64]

RATE = 30
"""Frames a second of all that is compared."""
ASSUMED_RATE = 120.0
"""Frames a second of a clip that states none, such as an AMC."""
_LEAST_RATE = 1.0
"""Of slower ones many frames would be made of few, without bounds."""
_CHEST = 0.7
"""How far from the hips to the neck the chest is, where there is no such joint."""
_FAR = 1e9
"""Length units; what is farther away would not be compared in floating point."""
_SMOOTH = 5.0
"""Frames at 30 Hz over which the heading is smoothed (standard deviation)."""
_USUAL_Y, _KNOWN_Y = 1.2, 3.0
"""How much longer a body must be along z than along y to be taken to stand along z, and how much
where its rest pose stands along y: who lies or crawls is long along z, too."""
_JUMP = 0.15
"""Leg lengths in a frame: hips that move farther, and so only there, were put elsewhere."""
_SUDDEN = 4.0
"""How many times as far as two frames before and behind: some ten times gravity."""
_LOOKED_AT = 64
"""Frames by which joints are found where names do not tell, about so many."""
_AT = {joint: index for index, joint in enumerate(JOINTS)}
_LEGS = [[_AT[f"{side}_{joint}"] for joint in SIDED[3:]] for side in ("left", "right")]


@dataclass(frozen=True, slots=True, eq=False)
class StandardMotion:
    """Sixteen joints (``JOINTS``) at 30 Hz; x to the body's left, y up, z forward; leg lengths."""

    places: Array
    """(F, 16, 3): from the hips, in axes that turn with the body about the vertical."""
    root: Array
    """(F, 3): path of the hips, from above the origin; at the start the body faces z. The lowest
    ankle of the clip is at height 0."""
    heading: Array
    """(F,): radians about the vertical from the first frame's heading, not wrapped."""
    leg: float
    """Length of a leg, thigh and shank, in units of the file."""
    start: float = 0.0
    """Seconds from the clip's first frame to the first of these."""
    cuts: tuple[int, ...] = ()
    """Frames at which motion begins that does not go on from the frame before, as where takes were
    joined or the recording lost its figure."""

    @property
    def frames(self) -> int:
        """Number of frames, F."""
        return len(self.root)

    def __getitem__(self, key: slice) -> "StandardMotion":
        """Give some of the frames, step 1; path and heading begin anew."""
        first = range(self.frames)[key].start if self.frames else 0
        turn = self.heading[first] if self.frames else 0.0
        root = self.root[key] - (self.root[first] * (1, 0, 1) if self.frames else 0.0)
        start = self.start + first / RATE
        last = first + len(self.root[key])
        cuts = tuple(cut - first for cut in self.cuts if first < cut < last)
        return StandardMotion(
            self.places[key], _turned(root, turn), self.heading[key] - turn, self.leg, start, cuts
        )

    def mirrored(self) -> "StandardMotion":
        """Give the same motion with left and right exchanged."""
        sides = len(SIDED)
        order = [0, 1, 2, 3, *range(4 + sides, 4 + 2 * sides), *range(4, 4 + sides)]
        flip = np.array([-1.0, 1.0, 1.0])
        return StandardMotion(
            self.places[:, order] * flip,
            self.root * flip,
            -self.heading,
            self.leg,
            self.start,
            self.cuts,
        )


def standard_motion(
    clip: Clip, mapping: Mapping[str, str] | None = None, rate: float | None = None
) -> StandardMotion:
    """Take the standard joints of a clip, at 30 Hz.

    Joints are found by the mapping, else by their names, else by how the body branches. The hips
    are in the middle between the hip joints.

    Parameters
    ----------
    clip
        With a skeleton, in any units; y up or down, or z where bodies are much longer along it.
    mapping
        Names of standard joints to names in the skeleton, for joints that are not found otherwise.
    rate
        Frames a second of the clip if it states none; 120 by default.

    Raises
    ------
    ParameterError
        When the mapping names what is not there.
    UnsupportedError
        When there is no skeleton, or bones stretch; when joints are missing, which are named; when
        there are no frames, or less than one a second, or a joint's place is never a usable number.

    """
    if clip.skeleton is None:
        raise UnsupportedError("search needs a skeleton, and the clip has none", file=_name(clip))
    if not clip.frames:
        raise UnsupportedError("search needs frames, and the clip has none", file=_name(clip))
    own_rate = clip.fps or rate or ASSUMED_RATE
    if own_rate < _LEAST_RATE:
        raise UnsupportedError(
            "search needs motion",
            file=_name(clip),
            expected=f"{_LEAST_RATE:g} frame a second or more",
            found=f"{own_rate:g}",
        )
    count = int(Fraction(clip.frames - 1) * RATE / Fraction(own_rate) + Fraction(1, 1000)) + 1
    moments = np.minimum(np.arange(count) * (own_rate / RATE), clip.frames - 1)
    before = np.floor(moments + 1e-6).astype(np.intp)
    part = np.maximum(moments - before, 0.0)
    needed = np.unique(np.concatenate([before, np.minimum(before + 1, clip.frames - 1)]))
    if (part < 1e-6).all():
        needed = before
    all_places = positions(clip.with_frames(clip.values[needed], clip.frame_time))
    usable = (np.abs(all_places) < _FAR).all(axis=(1, 2))
    found = _correspondence(clip, mapping, all_places[usable])
    places = _sixteen(all_places, found)
    if not usable.all():
        places = _without_gaps(places, needed, _name(clip))
    if needed is not before:
        low = np.searchsorted(needed, before)
        high = np.searchsorted(needed, np.minimum(before + 1, clip.frames - 1))
        share = part[:, None, None]
        places = places[low] * (1 - share) + places[high] * share
    return _standing(places, _KNOWN_Y if _rests_along_y(clip, found) else _USUAL_Y, _name(clip))


def _correspondence(clip: Clip, mapping: Mapping[str, str] | None, places: Array) -> dict[str, int]:
    assert clip.skeleton is not None
    own = by_mapping(clip.skeleton, mapping or {})
    named = by_names(clip.skeleton) | own
    arms = [named[joint] for joint in ("left_shoulder", "right_shoulder") if joint in named]
    if "head" not in named and len(arms) == 2:
        head = head_between(clip.skeleton, arms)
        named |= {} if head is None else {"head": head}
    missing = [joint for joint in REQUIRED if joint not in named]
    if not missing:
        return named
    if not len(places):
        what = "search needs frames in which all places are numbers, none of them huge"
        raise UnsupportedError(what, file=_name(clip))
    found = by_topology(clip.skeleton, places[:: 1 + len(places) // _LOOKED_AT]) | own
    if all(joint in found for joint in REQUIRED):
        return found
    raise UnsupportedError(
        "the skeleton has no joints that correspond to " + ", ".join(missing),
        file=_name(clip),
        expected="a body with arms, legs and a head, or a mapping of names (joints=...)",
        found=" ".join(clip.skeleton.names[:20])
        + (" ..." if len(clip.skeleton.names) > 20 else ""),
    )


def _without_gaps(places: Array, frames: NDArray[np.intp], name: str | None) -> Array:
    """Give (F, 16, 3) with places that are no usable numbers on the way between those around."""
    usable: NDArray[np.bool_] = np.all(np.abs(places) < _FAR, axis=2)
    if not usable.any(axis=0).all():
        what = "search needs places that are numbers, none of them huge"
        raise UnsupportedError(what, file=name)
    for joint in np.flatnonzero(~usable.all(axis=0)):
        good = usable[:, joint]
        for axis in range(3):
            known = places[good, joint, axis]
            places[:, joint, axis] = np.interp(frames, frames[good], known)
    return places


def _sixteen(places: Array, found: Mapping[str, int]) -> Array:
    """Give (F, 16, 3) of (F, J, 3)."""
    made = np.empty((len(places), len(JOINTS), 3))
    for joint, index in found.items():
        made[:, _AT[joint]] = places[:, index]
    middle = (made[:, _AT["left_shoulder"]] + made[:, _AT["right_shoulder"]]) / 2
    made[:, 0] = (made[:, _AT["left_hip"]] + made[:, _AT["right_hip"]]) / 2
    if "neck" not in found:
        made[:, _AT["neck"]] = middle
    if "chest" not in found:
        made[:, _AT["chest"]] = (1 - _CHEST) * made[:, 0] + _CHEST * made[:, _AT["neck"]]
    return made


def _rests_along_y(clip: Clip, found: Mapping[str, int]) -> bool:
    """Say whether the body stands along y where all channels are left out."""
    resting = positions(Clip.of(np.zeros((1, 0)), (), None, clip.skeleton))
    _, y, z = np.abs(_height(_sixteen(resting, found)))
    return bool(y > _USUAL_Y * z)


def _height(places: Array) -> Array:
    """Give the mean way from the ankles to the head: (3,)."""
    ankles = places[:, [leg[2] for leg in _LEGS]].mean(axis=1)
    height: Array = (places[:, _AT["head"]] - ankles).mean(axis=0)
    return height


def _upright(places: Array, least_z: float) -> Array:
    """Turn a body so that y is up."""
    _, y, z = _height(places)
    if abs(z) > least_z * abs(y):
        places = places[..., [0, 2, 1]] * ((1, 1, -1) if z > 0 else (1, -1, 1))
    elif y < 0:
        # Heads are down in handstands as well, but there the hands are lower still.
        wrists = places[:, [_AT["left_wrist"], _AT["right_wrist"]], 1].mean()
        if wrists > places[:, _AT["head"], 1].mean():
            places = places * (1, -1, -1)
    return places


def _standing(places: Array, least_z: float, name: str | None) -> StandardMotion:
    places = _upright(places, least_z)
    ankles = places[:, [leg[2] for leg in _LEGS]]
    bones = np.linalg.norm(np.diff(places[:, _LEGS], axis=2), axis=-1).sum(axis=2)
    leg = float(np.median(bones))
    if not leg > float(np.abs(places).max()) / _FAR:
        raise UnsupportedError("search needs legs that are longer than 0", file=name)
    places = places / leg
    cuts = _cuts(places[:, 0])
    heading = _headings(places, cuts)
    root = places[:, 0] - (places[0, 0, 0], float(ankles[..., 1].min()) / leg, places[0, 0, 2])
    return StandardMotion(
        _turned(places - places[:, :1], heading[:, None]),
        _turned(root, heading[0]),
        heading - heading[0],
        leg,
        cuts=cuts,
    )


def _cuts(hips: Array) -> tuple[int, ...]:
    """Give the frames before which hips, (F, 3), are suddenly elsewhere."""
    moved = np.linalg.norm(np.diff(hips, axis=0), axis=1)
    usual = np.pad(moved, 2, mode="edge") if len(moved) else moved
    sudden = moved > np.maximum(_JUMP, _SUDDEN * np.maximum(usual[:-4], usual[4:]))
    return tuple((np.flatnonzero(sudden) + 1).tolist())


def _headings(places: Array, cuts: tuple[int, ...]) -> Array:
    """Give where the body faces, radians about the vertical, by hips and shoulders, smoothed."""
    left = sum(
        places[:, _AT[f"left_{joint}"]] - places[:, _AT[f"right_{joint}"]]
        for joint in ("hip", "shoulder")
    )
    # A body that bends sideways has little that is level, so it counts little in the mean.
    pieces = np.split(np.asarray(left)[:, [0, 2]], cuts)
    smooth = np.concatenate(
        [gaussian_filter1d(piece, _SMOOTH, axis=0, mode="nearest") for piece in pieces]
    )
    headings: Array = np.unwrap(np.arctan2(-smooth[:, 1], smooth[:, 0]))
    return headings


def _turned(places: Array, heading: Array | np.float64 | float) -> Array:
    """Turn back by a heading about the vertical."""
    cos, sin = np.cos(heading), np.sin(heading)
    x, y, z = places[..., 0], places[..., 1], places[..., 2]
    return np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=-1)


def _name(clip: Clip) -> str | None:
    return clip.name or None
