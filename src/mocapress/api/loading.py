"""From compressed files to clips."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mocapress import formats
from mocapress.api.opening import Opened
from mocapress.api.restoring import contents, own_layout
from mocapress.container import CHANNELS, StreamHead, diffma_json
from mocapress.errors import (
    CorruptError,
    FormatError,
    ParameterError,
    UnsupportedError,
)
from mocapress.formats import Format
from mocapress.models import Place
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.columns import bone_columns
from mocapress.source import DIFFMA_JSON, EMBEDDED, LIMIT, Beside, Named, Source

_RAISE, _SKIP = "raise", "skip"


def load(
    source: Named,
    frames: slice | None = None,
    *,
    stream: str | None = None,
    asf_path: str | Path | None = None,
    models: Sequence[Place] = (),
    strict: bool = True,
    errors: str = _RAISE,
    limit: int | None = LIMIT,
) -> Clip:
    """Give the clip in a ``.mcz`` or a DiffMA JSON, or some of its frames.

    Parameters
    ----------
    source
        A path, the contents or a binary stream.
    frames
        Only these frames of one stream, e.g. ``slice(100, 200)``; just the chunks they lie in are
        read, and decoded as far as needed.
    stream
        Name of the only stream that is wanted. Without it, all streams come, and with ``frames``
        the first.
    asf_path
        The skeleton of an AMC; without it, the one in the file, or the ASF beside it, is taken.
    models
        Where to look for the model that the file may need, as in ``decompress``.
    strict
        Whether a file is refused that was compressed from one that had lost frames, as ``read``
        refuses that one. With ``strict=False`` it is a ``MotionWarning``.
    errors
        ``"raise"``, or ``"skip"`` to go on in a damaged file: rows that are lost are NaN, and a
        ``MotionWarning`` names each loss.
    limit
        Bytes that may be restored: of the numbers, 8 each, 4 GiB by default; None for any number.

    Raises
    ------
    CorruptError
        When the file is damaged, as far as it was read.
    FormatError
        When the original had lost frames, in strict reading; or there is no motion in it.
    MissingModelError
        When the model that the file needs is nowhere.
    UnsupportedError
        When more would be restored than ``limit`` allows.

    """
    return load_source(
        Source(source, limit=limit),
        frames,
        stream=stream,
        asf_path=asf_path,
        models=models,
        strict=strict,
        errors=errors,
    )


def load_source(
    source: Source,
    frames: slice | None = None,
    *,
    stream: str | None = None,
    asf_path: str | Path | None = None,
    models: Sequence[Place] = (),
    strict: bool = True,
    errors: str = _RAISE,
) -> Clip:
    """Load a clip; see ``load``."""
    if errors not in (_RAISE, _SKIP):
        raise ParameterError("errors", expected="raise or skip", found=repr(errors))
    if frames is not None and not isinstance(frames, slice):
        raise ParameterError("frames", expected="a slice, e.g. slice(10, 11)", found=repr(frames))
    if source.kind == DIFFMA_JSON:
        clip = diffma_json.json_to_clip(source)
        return clip if frames is None else clip[frames]
    opened = Opened(source, models, salvage=errors == _SKIP)
    return load_opened(opened, frames, stream=stream, asf_path=asf_path, strict=strict)


def load_opened(
    opened: Opened,
    frames: slice | None = None,
    *,
    stream: str | None = None,
    asf_path: str | Path | None = None,
    strict: bool = True,
) -> Clip:
    """Load a clip from a file that is open; see ``load``."""
    source, original = opened.source, opened.mcz.original
    if not opened.streams:
        clip = _of_contents(opened, asf_path, strict=strict)
        return clip if frames is None else clip[frames]
    if original is not None:
        source.accept(original.problems, strict=strict)
    clip = _clip(opened, frames, stream, asf_path)
    source.warn_of_guess()
    _warn(opened)
    return _described(opened, clip)


def columns_of(opened: Opened, asf_path: str | Path | None = None) -> Clip:
    """Give the clip of a file without its frames: columns, timing, skeleton."""
    streams = {
        head.name: Stream(np.empty((0, len(head.columns))), head.columns, head.frame_time)
        for head in opened.streams
        if head.kind == CHANNELS
    }
    return _described(opened, _with_skeleton(opened, Clip(streams), asf_path))


def _described(opened: Opened, clip: Clip) -> Clip:
    """Give streams the names and units that the layout of the original knows."""
    original = opened.mcz.original
    of = _format(original.format) if original and original.format else None
    if original is None or of is None or of.describe is None:
        return clip
    return opened.source.described(of, own_layout(original), clip)


def _clip(
    opened: Opened, frames: slice | None, stream: str | None, asf_path: str | Path | None
) -> Clip:
    known = [index for index, head in enumerate(opened.streams) if head.kind == CHANNELS]
    names = [opened.streams[index].name for index in known]
    if stream is not None and stream not in names:
        raise ParameterError("no such stream", expected=", ".join(names), found=repr(stream))
    if not known:
        kinds = ", ".join(head.kind for head in opened.streams)
        raise UnsupportedError(f"all streams are of kinds that are not known yet: {kinds}")
    wanted = known if stream is None else [known[names.index(stream)]]
    if frames is not None:
        wanted = wanted[:1]
    streams = {}
    if frames is None:
        opened.source.allow(sum(opened.bytes_of(i, opened.frames(i)) for i in wanted))
    for index in wanted:
        head = opened.streams[index]
        rows = range(opened.frames(index))[frames or slice(None)]
        values = np.empty((0, len(head.columns)))
        if rows:
            first, last = min(rows[0], rows[-1]), max(rows[0], rows[-1]) + 1
            values = opened.rows(index, first, last).filled()[:: rows.step]
        # Every second frame lasts twice as long.
        time = None if head.frame_time is None else head.frame_time * abs(rows.step)
        streams[head.name] = Stream(values, head.columns, time)
    for index in set(range(len(opened.streams))) - set(known):
        _unknown(opened, opened.streams[index])
    original, notes = opened.mcz.original, dict(opened.mcz.notes)
    name = Path(original.name).stem if original else notes.pop("name", "")
    return _with_skeleton(opened, Clip(streams, None, name, notes), asf_path)


def _with_skeleton(opened: Opened, clip: Clip, asf_path: str | Path | None) -> Clip:
    """Give the clip its skeleton: that of the file, or one that was given or lies beside it."""
    source, original, head = opened.source, opened.mcz.original, opened.mcz.head
    stored = head.skeleton if head else None
    of = _format(original.format) if original else None
    if stored is not None and (asf_path is None or of is None or of.companion is None):
        if of is not None and of.companion is not None:
            source.used = Beside(source.name, EMBEDDED, lambda: b"")
        return source.told(replace(clip, skeleton=stored))
    if of is None:
        return clip
    return source.told(
        source.with_skeleton(of, lambda skeleton: _fitted(opened, clip, skeleton), asf_path)
    )


def _format(name: str) -> Format | None:
    try:
        return formats.by_id(name)
    except UnsupportedError:
        return None


def _fitted(opened: Opened, clip: Clip, skeleton: Skeleton | None) -> Clip:
    """Give the columns of the first stream as a skeleton has them."""
    bones = [(bone.name, bone.columns) for bone in opened.streams[0].bones]
    if skeleton is None or not bones:
        return clip
    units = {column.unit for column in clip.columns}
    unit = "rad" if "rad" in units else "deg" if "deg" in units else None
    found = bone_columns(skeleton, bones, unit)
    columns: list[Column] = [
        replace(new, decimal=old.decimal) for new, old in zip(found, clip.columns, strict=True)
    ]
    return replace(clip.with_columns(tuple(columns)), skeleton=skeleton)


def _of_contents(opened: Opened, asf_path: str | Path | None, *, strict: bool) -> Clip:
    """Read the motion file that is packed in this one as it is."""
    source, original = opened.source, opened.mcz.original
    assert original is not None  # a file has a head or an original
    data = contents(opened, original)
    of = formats.recognise(data, original.name)
    if of is None or not (of.split or of.read):
        known = formats.listed(formats.readable())
        raise FormatError("no motion in this file", expected=f"{known} inside")
    parts = source.split(asf_path, of, data)
    source.accept(parts.problems, strict=strict)
    return source.described(of, parts.stored, parts.clip)


def _unknown(opened: Opened, head: StreamHead) -> None:
    fact = UnsupportedError(
        f"stream {head.name!r} is of a kind that is not known yet, {head.kind!r}",
        file=opened.source.name or None,
    )
    opened.source.warn("unknown-stream", fact)


def _warn(opened: Opened) -> None:
    source = opened.source
    if not opened.mcz.closed and not opened.damage:
        what = "the recording was not closed; all whole chunks are read"
        source.warn("unfinished-recording", CorruptError(what, file=source.name or None))
    opened.warn_of_losses()
