"""What a clip's joints and channels do, in a few numbers each."""

from typing import Any

import numpy as np

from mocapress.errors import UnsupportedError
from mocapress.motion.clip import Clip
from mocapress.motion.kinematics import positions


def statistics(clip: Clip) -> dict[str, list[dict[str, Any]]]:
    """Give rows of statistics, as plain data.

    Parameters
    ----------
    clip
        Statistics leave out values that are not finite; ``missing`` counts them.

    Returns
    -------
    dict
        ``channels``: name, low, high, mean, deviation, and largest speed, of the first stream, in
        the unit of the channel. ``joints``, if there is a skeleton that can be placed: name, the
        extent of the joint's way along x, y and z, its length, and mean and largest speed, in
        length units of the file; of feet, ``contact``: the part of the frames in which they stand.
        Speeds are per second, or per frame where no rate is known, and contacts are not either.

    """
    rate = clip.fps or 1.0
    channels = []
    for c, column in enumerate(clip.columns):
        values = clip.values[:, c]
        known = values[np.isfinite(values)]
        with np.errstate(invalid="ignore"):
            steps = np.abs(np.diff(values))
        steps = steps[np.isfinite(steps)]
        channels.append(
            {
                "name": column.name,
                "low": float(known.min()) if known.size else None,
                "high": float(known.max()) if known.size else None,
                "mean": float(known.mean()) if known.size else None,
                "deviation": float(known.std()) if known.size else None,
                "largest_speed": float(steps.max() * rate) if steps.size else None,
                "missing": len(values) - len(known),
            }
        )
    return {"joints": _joints(clip, rate), "channels": channels}


def _joints(clip: Clip, rate: float) -> list[dict[str, Any]]:
    if clip.skeleton is None or not clip.frames:
        return []
    try:
        placed = positions(clip)
    except UnsupportedError:
        return []
    steps = np.linalg.norm(np.diff(placed, axis=0), axis=2)
    steps = steps if len(steps) else np.zeros((1, placed.shape[1]))
    extent = np.ptp(placed, axis=0)
    try:
        standing = clip.contacts()
    except UnsupportedError:  # no feet, or no rate
        standing = {}
    return [
        {
            "name": name,
            **dict(zip(("x_extent", "y_extent", "z_extent"), map(float, extent[j]), strict=True)),
            "way": float(steps[:, j].sum()),
            "mean_speed": float(steps[:, j].mean() * rate),
            "largest_speed": float(steps[:, j].max() * rate),
            "contact": float(standing[name].mean()) if name in standing else None,
        }
        for j, name in enumerate(clip.skeleton.names)
    ]
