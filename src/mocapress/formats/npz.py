"""NumPy's ``.npz``, arrays by name: read from anybody's files, and written from a clip."""

import io
import json
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mocapress.formats.array_layout import read_layout
from mocapress.formats.array_splitting import split_npz
from mocapress.formats.contract import Format
from mocapress.formats.npz_digests import with_right_digests
from mocapress.formats.table_writing import with_frames
from mocapress.motion import Clip, Stream
from mocapress.motion.markers import POINTS, RESIDUALS, Markers, markers


def write(clip: Clip) -> dict[str, bytes]:
    """Give a file of plain arrays; ``np.load(file)`` reads it, nothing in it is pickled.

    Of each stream ``NAME`` there are ``NAME``, (F, C) float64, ``NAME_names``, ``NAME_units`` and
    ``NAME_rate``, in frames per second, NaN where it is not known. Points are (F, P, 3), with one
    name for each, and ``valid``, (F, P); residuals are lengths. Of a skeleton there are
    ``joint_names``, ``joint_parents`` and ``joint_offsets``; ``metadata`` is JSON.
    """
    arrays: dict[str, NDArray[np.generic]] = {}
    for name, stream in clip.streams.items():
        arrays[name] = stream.values
        arrays[f"{name}_names"] = np.array([column.name for column in stream.columns], str)
        arrays[f"{name}_units"] = np.array([column.unit for column in stream.columns], str)
        arrays[f"{name}_rate"] = np.array(_rate(stream))
    if POINTS in clip.streams:
        arrays |= _of_markers(markers(clip))
    if clip.skeleton is not None:
        joints = clip.skeleton.joints
        arrays["joint_names"] = np.array([joint.name for joint in joints], str)
        arrays["joint_parents"] = np.array([joint.parent for joint in joints], np.int64)
        arrays["joint_offsets"] = np.array([joint.offset for joint in joints], np.float64)
    arrays["metadata"] = np.array(json.dumps({"name": clip.name, **clip.metadata}))
    contents = io.BytesIO()
    np.savez(contents, allow_pickle=False, **arrays)
    return {".npz": contents.getvalue()}


def _of_markers(found: Markers) -> dict[str, NDArray[np.generic]]:
    arrays: dict[str, NDArray[np.generic]] = {
        POINTS: found.positions,
        f"{POINTS}_names": np.array(found.labels, str),
        f"{POINTS}_units": np.array([found.unit] * len(found.labels), str),
        "valid": found.valid,
    }
    return arrays if found.residuals is None else {**arrays, RESIDUALS: found.residuals}


def _rate(stream: Stream) -> float:
    return float(1 / Fraction(stream.frame_time)) if stream.frame_time else float("nan")


FORMAT = Format(
    id="npz",
    name="NPZ",
    suffixes=(".npz",),
    # Other zip files, workbooks and the like, begin alike.
    recognises=lambda head: head.startswith(b"PK\x03\x04") and b".npy" in head[30:286],
    split=split_npz,
    read_layout=partial(read_layout, kind="npz"),
    completed=with_right_digests,
    fit=with_frames,
    write=write,
    any_columns=True,
    timed=False,
)
