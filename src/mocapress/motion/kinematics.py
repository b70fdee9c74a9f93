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

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import UnsupportedError
from mocapress.motion.clip import Clip

Array = NDArray[np.float64]


def positions(clip: Clip, *, end_sites: bool = False) -> Array:
    """Give the joints' positions: the same bits from every build, and in the page.

    Parameters
    ----------
    clip
        A clip with a skeleton.
    end_sites
        Whether to append the ends of bones without further joints, in the order of their joints.

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
    return placed if end_sites else placed[:, : turned.shape[1]]


def rotations(clip: Clip) -> Array:
    """Give the joints' global rotations: (F, J, 4) unit quaternions, scalar first.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton, or stretches bones.

    """
    return _place(clip)[1]


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
