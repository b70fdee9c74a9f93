"""Forward kinematics: from channels to positions and rotations in space.

Conventions, with their evidence in docs/decisions/002-kinematics.md:

- A joint's rotation L is the product of its channels' rotations. BVH: in the order of the channels,
  each about the axes already turned. ASF: L = C M C⁻¹, with M the turns about fixed axes in the
  order of the bone's ``axis`` and C the rotation of the bone's ``axis`` angles.
- In a BVH, a joint's translation channels replace its OFFSET, axis by axis; in an ASF they add.
- A channel that the clip lacks is 0 (a BVH translation: the OFFSET).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import UnsupportedError
from mocapress.motion.clip import Clip
from mocapress.motion.skeleton import Joint, Skeleton

Array = NDArray[np.float64]


def positions(clip: Clip, *, end_sites: bool = False) -> Array:
    """Give the joints' positions.

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
    placed, turned = _forward(clip)
    if end_sites:
        for index, joint in enumerate(_skeleton(clip).joints):
            placed += [placed[index] + rotate(turned[index], np.array(end)) for end in joint.ends]
    return np.stack(placed, axis=1)


def rotations(clip: Clip) -> Array:
    """Give the joints' global rotations: (F, J, 4) unit quaternions, scalar first.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton.

    """
    return np.stack(_forward(clip)[1], axis=1)


def local_rotations(clip: Clip) -> Array:
    """Give rotations relative to the parents: (F, J, 4) unit quaternions, scalar first."""
    skeleton = _skeleton(clip)
    columns = _columns(clip)
    angle = np.pi / 180 if _angle_unit(clip) == "deg" else 1.0
    axis_angle = np.pi / 180 if skeleton.angle_unit == "deg" else 1.0
    return np.stack(
        [
            _local_rotation(clip, joint, columns[i], skeleton.rotation, angle, axis_angle)
            for i, joint in enumerate(skeleton.joints)
        ],
        axis=1,
    )


def translations(clip: Clip) -> Array:
    """Give positions relative to the parents: (F, J, 3), offset and channels together."""
    skeleton = _skeleton(clip)
    columns = _columns(clip)
    offsets = np.array([joint.offset for joint in skeleton.joints], dtype=np.float64)
    placed = np.tile(offsets, (clip.frames, 1, 1))
    for i in range(len(skeleton.joints)):
        for axis, kind in enumerate(("tx", "ty", "tz")):
            if kind in columns[i]:
                values = clip.values[:, columns[i][kind]]
                replaces = skeleton.rotation == "moving"
                placed[:, i, axis] = values if replaces else placed[:, i, axis] + values
        if "l" in columns[i] and clip.values[:, columns[i]["l"]].any():
            raise UnsupportedError("bones that stretch (channel l) have no kinematics here")
    return placed


def multiply(a: Array, b: Array) -> Array:
    """Multiply quaternions, (..., 4), scalar first."""
    aw, ax, ay, az = np.moveaxis(a, -1, 0)
    bw, bx, by, bz = np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def rotate(turn: Array, vector: Array) -> Array:
    """Rotate vectors, (..., 3), by unit quaternions, (..., 4)."""
    w, axis = turn[..., :1], turn[..., 1:]
    twice = 2 * np.cross(axis, vector)
    turned: Array = vector + w * twice + np.cross(axis, twice)
    return turned


def euler(angles: Sequence[tuple[str, Array]]) -> Array:
    """Multiply rotations about x, y or z, (F,) radians each, from left to right: (F, 4)."""
    turn: Array | None = None
    for axis, angle in angles:
        one = np.zeros((*np.shape(angle), 4))
        one[..., 0] = np.cos(angle / 2)
        one[..., 1 + "xyz".index(axis)] = np.sin(angle / 2)
        turn = one if turn is None else multiply(turn, one)
    return np.array([1.0, 0, 0, 0]) if turn is None else turn


def conjugate(turn: Array) -> Array:
    """Give the inverse of unit quaternions."""
    inverse: Array = turn * np.array([1.0, -1, -1, -1])
    return inverse


def _forward(clip: Clip) -> tuple[list[Array], list[Array]]:
    local, placed = local_rotations(clip), translations(clip)
    at: list[Array] = []
    turned: list[Array] = []
    for i, joint in enumerate(_skeleton(clip).joints):
        if joint.parent < 0:
            at.append(placed[:, i])
            turned.append(local[:, i])
        else:
            at.append(at[joint.parent] + rotate(turned[joint.parent], placed[:, i]))
            turned.append(multiply(turned[joint.parent], local[:, i]))
    return at, turned


def _local_rotation(
    clip: Clip,
    joint: Joint,
    columns: dict[str, int],
    order: str,
    angle: float,
    axis_angle: float,
) -> Array:
    turns = [(kind[1], clip.values[:, columns[kind]] * angle) for kind in columns if kind[0] == "r"]
    if order == "fixed":
        turns.sort(key=lambda turn: -joint.axis_order.index(turn[0]))
    turn = euler(turns)
    if any(joint.axis):
        frame = axis_rotation(joint, axis_angle)
        turn = multiply(multiply(frame, turn), conjugate(frame))
    return np.broadcast_to(turn, (clip.frames, 4))


def axis_rotation(joint: Joint, unit: float) -> Array:
    """Give C, the rotation of an ASF bone's ``axis``, (4,); ``unit`` is that of its angles."""
    return euler(
        [(axis, np.array(joint.axis["xyz".index(axis)] * unit)) for axis in joint.axis_order[::-1]]
    )


def _columns(clip: Clip) -> list[dict[str, int]]:
    """Give per joint the columns of its channels, in the joint's order."""
    found: list[dict[str, int]] = [{} for _ in _skeleton(clip).joints]
    for index, column in enumerate(clip.columns):
        if 0 <= column.joint < len(found):
            found[column.joint][column.kind] = index
    return [
        {kind: columns[kind] for kind in joint.channels if kind in columns}
        for joint, columns in zip(_skeleton(clip).joints, found, strict=True)
    ]


def _skeleton(clip: Clip) -> Skeleton:
    if clip.skeleton is None:
        raise UnsupportedError("the clip has no skeleton; an AMC takes it from an ASF")
    return clip.skeleton


def _angle_unit(clip: Clip) -> str:
    return next((column.unit for column in clip.columns if column.kind[0] == "r"), "deg")
