"""When feet stand on something, and how far they slide while they do."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_opening

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.motion.clip import Clip
from mocapress.motion.figure import size_of
from mocapress.motion.kinematics import Array, positions

Frames = NDArray[np.bool_]

_FOOT = re.compile("foot|toe|ankle|heel")
_SHORT = re.compile("^[lr](fo|to)[el]?$")  # Vicon Nexus: LFO, LTO
_SPEED = 0.15
"""Figure heights a second up to which a joint stands: some 25 cm a second."""
_HEIGHT = 0.04
"""Figure heights above its own lowest places up to which a joint is on the floor: some 7 cm."""
_LOWEST = 0.05
"""Part of the frames in which a joint is at its lowest."""
_LONGER = 1.2
"""How much longer a figure is along z than along y where z is up."""
_LEAST = 0.05
"""Seconds; shorter contacts and shorter gaps do not count."""


def contacts(
    clip: Clip,
    joints: Sequence[str] | None = None,
    *,
    speed: float | None = None,
    height: float | None = None,
    fps: float | None = None,
) -> dict[str, Frames]:
    """Find the frames in which joints stand still on the floor; see ``Clip.contacts``."""
    if clip.skeleton is None:
        raise UnsupportedError("contacts need a skeleton, and the clip has none")
    names = feet(clip) if joints is None else tuple(joints)
    for name in names:
        if name not in clip.skeleton.names:
            raise ParameterError(
                "no such joint", expected=" ".join(clip.skeleton.names), found=name
            )
    rate = clip.fps or fps
    if not rate or not rate > 0:
        raise UnsupportedError("contacts need the sampling rate; mp.retime states it")
    places = positions(clip)
    chosen = places[:, [clip.skeleton.index(name) for name in names]]
    found = _standing(places, chosen, rate, speed, height)
    return {name: found[:, i] for i, name in enumerate(names)}


def feet(clip: Clip) -> tuple[str, ...]:
    """Give the joints of the feet, by their names.

    Raises
    ------
    UnsupportedError
        When there are none.

    """
    names = clip.skeleton.names if clip.skeleton else ()
    found = tuple(name for name in names if _is_foot(name))
    if not found:
        raise UnsupportedError(
            "no joint is called foot, toe, ankle or heel; name those that stand on the floor",
            found=" ".join(names[:20]) + (" ..." if len(names) > 20 else ""),
        )
    return found


def slides(places: Array, standing: Frames, up: int) -> Array:
    """Give how far joints move along the floor from one frame of a contact to the next.

    Parameters
    ----------
    places
        (F, J, 3), of the joints in contact.
    standing
        (F, J), as ``contacts`` gives them.
    up
        The axis that is not along the floor.

    Returns
    -------
    array
        (N,) distances, of all pairs of frames that follow each other in a contact.

    """
    both = standing[1:] & standing[:-1]
    level = [axis for axis in range(3) if axis != up]
    steps: Array = np.linalg.norm(np.diff(places[..., level], axis=0), axis=-1)
    return steps[both]


def upward(places: Array) -> int:
    """Give the axis that points up, 1 or 2, by the places of a whole figure, (F, J, 3).

    It is z where figures are longer along it, and their lowest joint is steadier.
    """
    if not len(places):
        return 1
    y, z = np.median(np.ptp(places, axis=1), axis=0)[1:]
    lowest = places[..., 1:].min(axis=1).std(axis=0)
    return 2 if z > _LONGER * y and lowest[1] <= lowest[0] else 1


def _standing(
    places: Array, chosen: Array, rate: float, speed: float | None, height: float | None
) -> Frames:
    """Give (F, J): where the chosen joints stand; what is not finite stands nowhere."""
    if len(places) == 0:
        return np.zeros(chosen.shape[:2], dtype=np.bool_)
    usable = np.asarray(np.isfinite(places).all(axis=(1, 2)))
    if not usable.any():
        return np.zeros(chosen.shape[:2], dtype=np.bool_)
    size = size_of(places[usable])
    up = upward(places[usable])
    levels = chosen[..., up] - np.quantile(chosen[usable][..., up], _LOWEST, axis=0)
    rates = np.zeros(chosen.shape)
    if len(chosen) > 1:
        with np.errstate(invalid="ignore", over="ignore"):
            rates = np.gradient(chosen, axis=0) * rate
    with np.errstate(invalid="ignore", over="ignore"):
        slow = np.linalg.norm(rates, axis=-1) <= (_SPEED * size if speed is None else speed)
        low = levels <= (_HEIGHT * size if height is None else height)
    standing = slow & low & usable[:, None]
    least = max(round(_LEAST * rate), 1)
    steady = np.ones((least, 1), dtype=np.bool_)
    # Beyond the ends the first and the last frame go on.
    padded = np.pad(standing, ((least, least), (0, 0)), mode="edge")
    kept: Frames = binary_opening(binary_closing(padded, steady), steady)[least:-least]
    return kept & usable[:, None]


def _is_foot(name: str) -> bool:
    word = re.sub("[^a-z]", "", name.lower().rpartition(":")[2])
    return bool(_FOOT.search(word) or _SHORT.match(word))
