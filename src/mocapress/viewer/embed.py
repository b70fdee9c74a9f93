"""Clips as the page holds them: as ``.mcz`` files, or as DiffMA JSON."""

import base64
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mocapress import api
from mocapress.api.opening import Opened
from mocapress.codecs import Codec
from mocapress.codecs.diffma import DiffMA
from mocapress.codecs.exact import Exact
from mocapress.container import Head, Mcz, MczWriter, diffma_json, open_mcz
from mocapress.errors import MocapressError, UnsupportedError
from mocapress.motion import Clip, Stream
from mocapress.motion.clip import MOTION
from mocapress.motion.markers import ANALOG, POINTS, markers
from mocapress.records import Reader
from mocapress.source import DIFFMA_JSON, MCZ, Source
from mocapress.viewer import page

LEVEL = Exact().level
FAST = 1
"""Level for a page that is not kept."""


def file(
    path: Path,
    *,
    asf_path: Path | None = None,
    max_error: float | None = None,
    near: Codec | None = None,
    level: int = LEVEL,
    strict: bool = True,
) -> dict[str, Any]:
    """Give the content of a motion file of any kind that mocapress reads.

    Parameters
    ----------
    path
        A motion file, ``.mcz`` or DiffMA JSON. The numbers of a ``.mcz`` stay as they are coded,
        where the page has their decoder; DiffMA JSON is embedded unchanged.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.
    max_error
        Largest error of a value, in its unit, as DiffMA JSON; None embeds exact values.
    near
        The lossy codec that is to code the motion anew, which the page has the decoder of.
    level
        Of the codec ``exact``.
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
        if max_error is not None:
            return approximate(clip, max_error, path.name)
        if near is not None:
            return lossy(clip, near, path.name)
        if source.kind == MCZ and (blob := as_coded(Opened(source).mcz, clip)):
            return _named(clip, path.name) | {"mcz": base64.b64encode(blob).decode()}
        return exact(clip, path.name, level=level)
    except MocapressError as error:
        error.file = error.file or str(path)
        raise


def exact(clip: Clip, name: str = "", *, level: int = LEVEL) -> dict[str, Any]:
    """Give a clip's first stream, of markers also analog data, coded by ``exact``.

    Raises
    ------
    UnsupportedError
        When a ``.mcz`` cannot hold the clip.

    """
    blob = coded_anew(clip, level=level)
    return _named(clip, name) | {"mcz": base64.b64encode(blob).decode()}


def lossy(clip: Clip, codec: Codec, name: str = "") -> dict[str, Any]:
    """Give a clip's first stream, coded by a lossy codec.

    Raises
    ------
    ParameterError
        When a length is asked for, and nothing says how long the clip's units are.
    UnsupportedError
        When a ``.mcz`` cannot hold the clip.

    """
    alone = Clip(dict([next(iter(clip.streams.items()))]), clip.skeleton)
    blob = api.compress_clip(codec.prepared(alone), codec).blob
    return _named(clip, name) | {"mcz": base64.b64encode(blob).decode()}


def coded_anew(clip: Clip, *, level: int) -> bytes:
    """Give what is played of a clip as a ``.mcz``; see ``exact``."""
    streams = _recorded(clip) if POINTS in clip.streams else {MOTION: clip.main}
    return api.compress_clip(Clip(streams, clip.skeleton), Exact(level=level)).blob


def _recorded(clip: Clip) -> dict[str, Stream]:
    """Give markers, without places that are not valid, and what is measured beside them."""
    points, valid = clip.streams[POINTS], markers(clip).valid
    values = np.where(np.repeat(valid, 3, axis=1), points.values, np.nan)
    streams = {POINTS: replace(points, values=values)}
    if ANALOG in clip.streams:
        streams[ANALOG] = clip.streams[ANALOG]
    return streams


def assets(clips: Sequence[dict[str, Any]]) -> list[str]:
    """Give the names of the binary files that a page of these clips needs."""
    codecs, methods = set(), set()
    for content in clips:
        if "mcz" in content:
            blob = base64.b64decode(content["mcz"])
            head = open_mcz(Source(blob)).head
            codecs |= {stream.codec.id for stream in head.streams} if head else set()
            methods.add(Reader(blob[_HEAD:], "head").bytes()[0])
    return page.assets_for(codecs, methods)


_HEAD = 6
"""Where the length of the first section stands."""


def as_coded(mcz: Mcz, clip: Clip) -> bytes | None:
    """Give the first stream of a ``.mcz`` with its chunks as they are.

    Parameters
    ----------
    mcz
        The file.
    clip
        What it holds, or some frames of it: for columns and skeleton.

    Returns
    -------
    bytes or None
        A ``.mcz``; None where the page cannot decode it.

    """
    stream = mcz.head.streams[0] if mcz.head else None
    known = stream and f"wasm/{stream.codec.id}.wasm" in page.asset_names()
    if POINTS in clip.streams:  # as the file has them, they are without names and scales
        return None
    if stream is None or not known or stream.model or not mcz.closed:
        return None
    if any(entry.dependent for entry in mcz.of_stream[0]):
        return None
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.head(Head((replace(stream, columns=clip.columns),), clip.skeleton))
    for entry in mcz.of_stream[0]:
        writer.chunk(mcz.read_chunk(entry))
    writer.end()
    return b"".join(parts)


def approximate(clip: Clip, max_error: float, name: str = "") -> dict[str, Any]:
    """Give a clip as DiffMA JSON with no value off by more than ``max_error``.

    Raises
    ------
    UnsupportedError
        When a value is not finite, which JSON cannot express.

    """
    text = diffma_json.to_json(clip, DiffMA(max_error=max_error, per="channel"))
    # An AMC can be in radians whose skeleton is in degrees.
    unit = next((column.unit for column in clip.columns if column.kind[:1] == "r"), "")
    made = _named(clip, name) | {"diffma": json.loads(text), "maxError": max_error}
    return made | {"angleUnit": unit} if unit in ("deg", "rad") else made


def _named(clip: Clip, name: str) -> dict[str, Any]:
    return {"name": name or clip.name or "clip"}


def _document(source: Source) -> dict[str, Any]:
    """Give a DiffMA JSON without its layout, which only ``decompress`` needs."""
    document = diffma_json.open_json(source.data)
    text = replace(document, layout=b"").to_json()
    return {"name": Path(source.name).name, "diffma": json.loads(text)}
