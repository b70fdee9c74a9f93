"""Measures of the predictor from the paper: ideal alphas and the average prediction error."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.app.coding import Coding, make_plan
from mocapress.codecs.app.parents import parent_columns
from mocapress.motion import Clip


class Predictor(Protocol):
    """``App``, or a baseline with another table."""

    @property
    def coding(self) -> Coding:
        """Table, cluster and chunk."""
        ...


def ideal_alphas(clip: Clip, t: int = 15) -> NDArray[np.float64]:
    """Give the alpha with the least squared error for every cluster and column (Eq. 9).

    Parameters
    ----------
    clip
        A clip of F frames and C columns.
    t
        Frames per cluster.

    Returns
    -------
    (ceil(F / t), C) float64. NaN for columns without a parent; 0 where the parent does not move.

    """
    parents = parent_columns(clip.columns, clip.skeleton)
    plan = make_plan(clip.columns, parents, [0] * clip.channels)
    alphas = _core.app_ideal_alphas(np.ascontiguousarray(clip.values), plan, t)
    found = np.array(alphas, dtype=np.float64).reshape(-(-clip.frames // t), clip.channels)
    found[:, np.array(parents, dtype=np.intp) < 0] = np.nan
    return found


def average_prediction_error(clip: Clip, codec: Predictor) -> float:
    """Give APE, the mean of ``|m - P|`` (Eq. 13), in the units of the columns.

    The mean is over all values that have a prediction, which excludes the first frame of a chunk;
    0 if there are none.
    """
    coding = codec.coding
    values = np.ascontiguousarray(clip.values)
    plan = make_plan(clip.columns, parent_columns(clip.columns, clip.skeleton), [0] * clip.channels)
    plan[:, 1] = _core.app_precisions(values, plan)
    table = np.array(coding.alphas, dtype=np.float64)
    error = 0.0
    predicted = 0
    for first in range(0, clip.frames, coding.frames_per_chunk):
        rows = values[first : first + coding.frames_per_chunk]
        error += _core.app_prediction_error(rows, plan, table, coding.t)
        predicted += (len(rows) - 1) * clip.channels
    return error / predicted if predicted else 0.0
