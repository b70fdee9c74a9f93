"""Forward kinematics word by word: one frame and one joint at a time, with 4 x 4 matrices.

Rotations come from SciPy, whose lower-case sequences turn about fixed axes and upper-case ones
about axes already turned.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from mocapress.motion import Clip, Joint, Skeleton

Array = NDArray[np.float64]


def turned(sequence: str, angles: list[float]) -> Array:
    made: Array = np.eye(4)
    if sequence:
        made[:3, :3] = Rotation.from_euler(sequence, angles, degrees=True).as_matrix()
    return made


def moved(vector: list[float]) -> Array:
    made: Array = np.eye(4)
    made[:3, 3] = vector
    return made


def bvh_local(joint: Joint, values: dict[str, float]) -> Array:
    """Translation channels stand for the offset's components; rotations in the channels' order."""
    place = [values.get(f"t{axis}", joint.offset[i]) for i, axis in enumerate("xyz")]
    kinds = [kind for kind in joint.channels if kind[0] == "r"]
    turn = turned("".join(k[1] for k in kinds).upper(), [values[k] for k in kinds])
    return moved(place) @ turn


def asf_local(joint: Joint, values: dict[str, float]) -> Array:
    """L = C M C^-1 about the bone's start, which lies at the end of the parent's bone."""
    place = [joint.offset[i] + values.get(f"t{axis}", 0.0) for i, axis in enumerate("xyz")]
    frame = turned(joint.axis_order, [joint.axis["xyz".index(a)] for a in joint.axis_order])
    turn = turned(joint.axis_order, [values.get(f"r{a}", 0.0) for a in joint.axis_order])
    return moved(place) @ frame @ turn @ np.linalg.inv(frame)


def world(skeleton: Skeleton, values: list[dict[str, float]]) -> list[Array]:
    local = bvh_local if skeleton.rotation == "moving" else asf_local
    matrices: list[Array] = []
    for joint, own in zip(skeleton.joints, values, strict=True):
        matrix = local(joint, own)
        matrices.append(matrix if joint.parent < 0 else matrices[joint.parent] @ matrix)
    return matrices


def world_of_frame(clip: Clip, frame: int) -> list[Array]:
    assert clip.skeleton is not None
    values: list[dict[str, float]] = [{} for _ in clip.skeleton.joints]
    for column, value in zip(clip.columns, clip.values[frame], strict=True):
        values[column.joint][column.kind] = float(value)
    return world(clip.skeleton, values)
