"""Clips as the page holds them: as DiffMA JSON, or with their exact values."""

import base64
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mocapress import api
from mocapress.codecs.diffma import DiffMA
from mocapress.codecs.diffma.skeleton_json import skeleton_keys
from mocapress.container import diffma_json
from mocapress.errors import MocapressError, UnsupportedError
from mocapress.motion import Clip
from mocapress.source import DIFFMA_JSON, MCZ, Source

MAX_ERROR = 0.01
"""Of a value, in degrees or the file's unit of length: less than can be seen."""


def file(
    path: Path,
    *,
    asf_path: Path | None = None,
    max_error: float | None = None,
    strict: bool = True,
) -> dict[str, Any]:
    """Give the content of a motion file of any kind that mocapress reads.

    Parameters
    ----------
    path
        A motion file, ``.mcz`` or DiffMA JSON; DiffMA JSON is embedded unchanged.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.
    max_error
        Largest error of a value, in its unit; None embeds exact values.
    strict
        Whether a file that has lost frames is refused, as by ``mocapress.read``.

    Raises
    ------
    MocapressError
        When the file is broken, or is not motion.
    OSError
        When it cannot be read.

    """
    try:
        source = Source(path)
        if source.kind == DIFFMA_JSON:
            return _document(source)
        read = api.load if source.kind == MCZ else api.read
        clip = read(path, asf_path=asf_path, strict=strict)
        if not clip.frames:
            raise UnsupportedError("no frames to be played")
        if max_error is None:
            return exact(clip, path.name)
        return approximate(clip, max_error, path.name)
    except MocapressError as error:
        error.file = error.file or str(path)
        raise


def exact(clip: Clip, name: str = "") -> dict[str, Any]:
    """Give a clip with its exact values: float64, one channel after the other, in base64."""
    values = np.ascontiguousarray(clip.values.T, dtype="<f8").tobytes()
    content: dict[str, Any] = {
        "names": [column.name for column in clip.columns],
        "frames": clip.frames,
        "values": base64.b64encode(values).decode(),
    }
    if clip.frame_time is not None:
        content["frameTime"] = float(clip.frame_time)
    if clip.skeleton is not None:
        places = [(column.joint, column.kind) for column in clip.columns]
        content["skeleton"] = skeleton_keys(clip.skeleton, places)
    return _named(clip, name) | {"exact": content}


def approximate(clip: Clip, max_error: float, name: str = "") -> dict[str, Any]:
    """Give a clip as DiffMA JSON with no value off by more than ``max_error``.

    Raises
    ------
    UnsupportedError
        When a value is not finite, which JSON cannot express.

    """
    text = diffma_json.to_json(clip, DiffMA(max_error=max_error, per="channel"))
    return _named(clip, name) | {"diffma": json.loads(text), "maxError": max_error}


def _named(clip: Clip, name: str) -> dict[str, Any]:
    # An AMC can be in radians whose skeleton is in degrees.
    unit = next((column.unit for column in clip.columns if column.kind[:1] == "r"), "")
    made = {"name": name or clip.name or "clip"}
    return made | {"angleUnit": unit} if unit in ("deg", "rad") else made


def _document(source: Source) -> dict[str, Any]:
    """Give a DiffMA JSON without its layout, which only ``decompress`` needs."""
    document = diffma_json.open_json(source.data)
    text = replace(document, layout=b"").to_json()
    return {"name": Path(source.name).name, "diffma": json.loads(text)}
