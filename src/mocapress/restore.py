"""From compressed files back to the original files, and to clips."""

import hashlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs, formats
from mocapress.codecs import Chunk, Codec, Model
from mocapress.container import Kind, Mcz, diffma_json, parse, unpack
from mocapress.errors import CorruptError, FormatError, ParameterError
from mocapress.formats import columns_of
from mocapress.formats.layout import Layout
from mocapress.models import Place, find_model
from mocapress.motion import Clip
from mocapress.source import DIFFMA_JSON, Named, Source

__all__ = ["chunks_of", "decompress", "load", "load_source"]


def decompress(source: Named | Source, *, models: Sequence[Place] = ()) -> bytes:
    """Give the original file's bytes (for a lossy codec: the decoded values in its layout).

    Parameters
    ----------
    source
        A ``.mcz`` or a DiffMA JSON, packed or not: a path, the file's bytes, or a stream.
    models
        Where to look for the model that the file may need: models, their files, or folders of
        them; then beside the file, then in the folders that ``MOCAPRESS_MODELS`` names.

    Raises
    ------
    CorruptError
        When the file is damaged; also when what was decoded is not what its digest says.
    MissingModelError
        When the model that the file needs is nowhere.

    """
    source = source if isinstance(source, Source) else Source(source)
    if source.kind == DIFFMA_JSON:
        return diffma_json.json_to_file(source.data)[1]
    mcz = parse(source.data)
    if mcz.kind is Kind.BYTES:
        restored, lossless = unpack(mcz.payload(0), "contents", mcz.size), True
    else:
        codec, layout = _open(mcz)
        clip = _columns(layout)
        lossless = codec.lossless
        model = _model(mcz, codec, source, models)
        values = _decode(mcz, codec, clip, 0, mcz.frames, model)
        restored = layout.join(values, mcz.size if lossless else 2**40)
    digest = hashlib.sha256(restored).digest()
    if lossless and digest != mcz.digest:
        raise CorruptError(
            "wrong digest of the contents", expected=mcz.digest.hex(), found=digest.hex()
        )
    return restored


def load(
    source: Named,
    frames: slice | None = None,
    *,
    asf_path: str | Path | None = None,
    models: Sequence[Place] = (),
    strict: bool = True,
) -> Clip:
    """Give the clip in a ``.mcz`` or a DiffMA JSON, or some of its frames.

    Parameters
    ----------
    source
        A path, the file's bytes, or a stream.
    frames
        Only these frames, e.g. ``slice(100, 200)``; just the chunks they lie in are decoded.
    asf_path
        The skeleton of an AMC; without it, the one in the file, or the ASF beside it, is taken, as
        by ``read``.
    models
        Where to look for the model that the file may need, as in ``decompress``.
    strict
        Whether a clip is refused whose file had lost frames before it was compressed, as by
        ``read``.

    Raises
    ------
    CorruptError
        When the file is damaged, as far as it was read.
    FormatError
        When it holds no motion, or only a part of it.
    MissingModelError
        When the model that the file needs is nowhere.

    """
    return load_source(Source(source), frames, asf_path=asf_path, models=models, strict=strict)


def load_source(
    source: Source,
    frames: slice | None = None,
    *,
    asf_path: str | Path | None = None,
    models: Sequence[Place] = (),
    strict: bool = True,
) -> Clip:
    """Give a clip or some of its frames; see ``load``."""
    if source.kind == DIFFMA_JSON:
        clip = diffma_json.json_to_clip(source.data)
        return clip if frames is None else clip[frames]
    mcz = parse(source.data)
    if mcz.kind is Kind.BYTES:
        contents = decompress(source)
        of = formats.recognise(contents)
        if of is None or of.split is None:
            expected = f"{formats.listed(formats.readable())} inside"
            raise FormatError("no motion in this file", expected=expected)
        clip, _, problems = source.split(asf_path, of, contents)
        source.accept(problems, strict=strict)
        return clip if frames is None else clip[frames]
    codec, layout = _open(mcz)
    clip = _columns(layout, source, asf_path, mcz.skeleton)
    source.warn_of_guess()
    rows = range(mcz.frames)[frames or slice(None)]
    if not rows:
        return clip[:: rows.step]
    first, last = min(rows[0], rows[-1]), max(rows[0], rows[-1]) + 1
    model = _model(mcz, codec, source, models)
    decoded = _decode(mcz, codec, clip, first, last, model)
    return clip.with_frames(decoded, clip.frame_time)[:: rows.step]


def _columns(
    layout: Layout,
    source: Source | None = None,
    asf_path: str | Path | None = None,
    skeleton: bytes = b"",
) -> Clip:
    """Give the clip without its frames; with the skeleton, where the source is given."""
    try:
        if source is None:
            return columns_of(layout)
        embedded = unpack(skeleton, "skeleton") if skeleton and asf_path is None else b""
        of, make = formats.by_id(layout.format), partial(columns_of, layout)
        return source.told(source.with_skeleton(of, make, asf_path, embedded))
    except FormatError as error:
        if error.file:
            raise
        raise CorruptError(f"layout: {error}") from error


def _model(mcz: Mcz, codec: Codec, source: Source, places: Sequence[Place]) -> Model | None:
    if not mcz.model:
        return None
    model = find_model(mcz.model, places, source.path.parent if source.path else None)
    try:
        codecs.learner(codec, model)
    except ParameterError as error:
        raise CorruptError(f"header: {error}") from error
    return model


def _open(mcz: Mcz) -> tuple[Codec, Layout]:
    """Read what decoding needs."""
    try:
        codec = codecs.codec(mcz.codec)
    except ParameterError as error:
        raise CorruptError(f"header: {error}") from error
    packed_limit = 2 * mcz.size + 2**20  # the layout's literals can exceed the rows of a short file
    layout = Layout.from_bytes(
        unpack(mcz.layout, "layout", packed_limit), mcz.kind.name.lower(), mcz.frames
    )
    if len(layout.formats) != mcz.columns:
        raise CorruptError(
            "layout: columns", expected=str(mcz.columns), found=str(len(layout.formats))
        )
    return codec, layout


def chunks_of(
    mcz: Mcz, start: int = 0, stop: int | None = None, frame: int = 0
) -> tuple[Chunk, ...]:
    """Take the chunks [start, stop) out of a file; the first begins at ``frame``."""
    chunks = []
    for i, entry in list(enumerate(mcz.index))[start:stop]:
        chunks.append(Chunk(frame, entry.frames, mcz.payload(i), entry.restart))
        frame += entry.frames
    return tuple(chunks)


def _decode(
    mcz: Mcz, codec: Codec, clip: Clip, first: int, last: int, model: Model | None
) -> NDArray[np.float64]:
    """Decode frames [first, last) and the fewest chunks that they need."""
    start, stop, frame = mcz.chunk_range(first, last)
    chunks = chunks_of(mcz, start, stop, frame)
    frames = last - frame
    values = codec.decode(mcz.codec_header, chunks, clip.columns, model=model, stop=frames)
    if values.shape != (frames, mcz.columns):
        raise CorruptError(
            "decoded values",
            expected=f"{frames} x {mcz.columns}",
            found=" x ".join(map(str, values.shape)),
        )
    return values[first - frame :]
