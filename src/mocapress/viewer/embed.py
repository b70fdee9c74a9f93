"""Clips as the page carries them."""

import base64
from pathlib import Path
from typing import Any

import numpy as np

from mocapress import api
from mocapress.model import Clip, Skeleton


def file(
    path: Path, *, asf_path: Path | None = None, max_error: float | None = None
) -> dict[str, Any]:
    """Give what is in a motion file, of any kind that mocapress reads.

    Raises
    ------
    MocapressError
        When the file is broken, or no motion.
    OSError
        When it cannot be read.

    """
    compressed = path.suffix.lower() == ".mcz"
    clip = (api.load if compressed else api.read)(path, asf_path=asf_path)
    return exact(clip, path.name)


def exact(clip: Clip, name: str = "") -> dict[str, Any]:
    """Give a clip with its values as they are: float64, one channel after the other, in base64."""
    values = np.ascontiguousarray(clip.values.T, dtype="<f8").tobytes()
    content: dict[str, Any] = {
        "names": [column.name for column in clip.columns],
        "frames": clip.frames,
        "values": base64.b64encode(values).decode(),
    }
    if clip.frame_time is not None:
        content["frameTime"] = float(clip.frame_time)
    if clip.skeleton is not None:
        content["skeleton"] = skeleton_json(clip, clip.skeleton)
    unit = next((column.unit for column in clip.columns if column.kind[0] == "r"), None)
    if unit is not None:
        content["angleUnit"] = unit
    return {"name": name or clip.name or "clip", "exact": content}


def skeleton_json(clip: Clip, skeleton: Skeleton) -> dict[str, Any]:
    """Give the skeleton as DiffMA JSON has it."""
    return {
        "rotation": skeleton.rotation,
        "angleUnit": skeleton.angle_unit,
        "lengthUnit": skeleton.length_unit,
        "joints": [
            {
                "name": joint.name,
                "parent": joint.parent,
                "offset": joint.offset,
                "channels": joint.channels,
                "axis": joint.axis,
                "axisOrder": joint.axis_order,
                "ends": joint.ends,
            }
            for joint in skeleton.joints
        ],
        "columns": [[column.joint, column.kind] for column in clip.columns],
    }
