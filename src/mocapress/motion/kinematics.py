"""Forward kinematics: from channels to positions and rotations in space.

Conventions, with their evidence in docs/decisions/002-kinematics.md:

- A joint's rotation L is the product of its channels' rotations. BVH: in the order of the channels,
  each about the axes already turned. ASF: L = C M C⁻¹, with M the turns about fixed axes in the
  order of the bone's ``axis`` and C the rotation of the bone's ``axis`` angles.
- In a BVH, a joint's translation channels replace its OFFSET, axis by axis; in an ASF they add.
- A channel that the clip lacks is 0 (a BVH translation: the OFFSET). Channels that scale move
  nothing.

The core does the work (``core/motion/kinematics.cpp``).
"""

import re

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import ParameterError, UnsupportedError
from mocapress.motion.clip import Clip

Array = NDArray[np.float64]
_EULER = re.compile("(?!.*(.)\\1)[xyzXYZ]{3}")


def positions(clip: Clip, *, end_sites: bool = False, relative: bool = False) -> Array:
    """Give the joints' positions: the same bits from every build, and in the page.

    Parameters
    ----------
    clip
        A clip with a skeleton.
    end_sites
        Whether to append the ends of bones without further joints, in the order of their joints.
    relative
        Whether they are relative to the first joint, the root: its place is subtracted. The axes
        stay those of the space.

    Returns
    -------
    array
        (F, J, 3), or (F, J + E, 3) with end sites; length units of the file.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton, or stretches bones (ASF ``l``).

    """
    placed, turned = _place(clip)
    if relative:
        placed = placed - placed[:, :1]
    return placed if end_sites else placed[:, : turned.shape[1]]


def rotations(clip: Clip, *, local: bool = False, form: str = "quaternion") -> Array:
    """Give the joints' rotations, in space or relative to their parents.

    Parameters
    ----------
    clip
        A clip with a skeleton.
    local
        Whether they are relative to the parents' rotations.
    form
        ``"quaternion"``, unit length and scalar first; ``"matrix"``; ``"6d"``, the first two
        columns of the matrix; or three axes such as ``"zyx"``: the Euler angles of the product of
        turns about these from left to right, in degrees, each about the axes already turned.

    Returns
    -------
    array
        (F, J, 4), (F, J, 3, 3), (F, J, 6) or (F, J, 3).

    Raises
    ------
    ParameterError
        When the form is unknown.
    UnsupportedError
        When the clip has no skeleton, or stretches bones.

    """
    turns = _place(clip, locally=local)[1]
    if form == "quaternion":
        return turns
    if form not in ("matrix", "6d") and not _EULER.fullmatch(form):
        raise ParameterError(
            "form", expected='"quaternion", "matrix", "6d", "zyx"', found=repr(form)
        )
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_quat(np.roll(turns.reshape(-1, 4), -1, axis=1))
    if form not in ("matrix", "6d"):
        angles: Array = rotation.as_euler(form.upper(), degrees=True)
        return angles.reshape(*turns.shape[:2], 3)
    matrices: Array = rotation.as_matrix().reshape(*turns.shape[:2], 3, 3)
    if form == "matrix":
        return matrices
    return matrices[..., :2].swapaxes(-1, -2).reshape(*turns.shape[:2], 6)


def velocities(clip: Clip) -> Array:
    """Give the joints' velocities in space: (F, J, 3), length units of the file per second.

    By differences over the frames before and after; at the ends, over one frame.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton, stretches bones, or its rate is not known.

    """
    if clip.frame_time is None:
        raise UnsupportedError("velocities need the sampling rate; mp.retime states it")
    placed = positions(clip)
    if len(placed) < 2:
        return np.zeros_like(placed)
    speeds: Array = np.gradient(placed, float(clip.frame_time), axis=0)
    return speeds


def local_rotations(clip: Clip) -> Array:
    """Give rotations relative to the parents: (F, J, 4) unit quaternions, scalar first."""
    return _place(clip, locally=True)[1]


def translations(clip: Clip) -> Array:
    """Give positions relative to the parents: (F, J, 3), offset and channels together."""
    return _place(clip, locally=True)[0]


def _place(clip: Clip, *, locally: bool = False) -> tuple[Array, Array]:
    if clip.skeleton is None:
        raise UnsupportedError("the clip has no skeleton; an AMC takes it from an ASF")
    unit = next((column.unit for column in clip.columns if column.kind[:1] == "r"), "deg")
    columns = [(column.joint, column.kind) for column in clip.columns]
    placed = _core.place(clip.values, clip.skeleton, columns, unit == "rad", locally)
    if placed is None:
        raise UnsupportedError("bones that stretch (channel l) have no kinematics here")
    return placed
