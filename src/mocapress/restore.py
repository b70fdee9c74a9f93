"""From compressed files back to the original files, and to clips."""

import hashlib
import mmap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.codecs import Chunk, Codec, Model
from mocapress.container import Kind, Mcz, diffma_json, parse, unpack
from mocapress.errors import CorruptError, FormatError, ParameterError
from mocapress.formats import asf
from mocapress.formats.files import columns_of, find_asf, sniff, split
from mocapress.formats.layout import Layout
from mocapress.formats.problems import report
from mocapress.models import Place, find_model
from mocapress.motion import Clip, Skeleton

__all__ = ["chunks_of", "decompress", "load"]


def decompress(source: str | Path | bytes, *, models: Sequence[Place] = ()) -> bytes:
    """Give the original file's bytes (for a lossy codec: the decoded values in its layout).

    Parameters
    ----------
    source
        A ``.mcz`` or a DiffMA JSON, packed or not: a path or the file's bytes.
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
    contents = _contents(source)
    if diffma_json.is_json(contents):
        return diffma_json.json_to_file(contents)[1]
    mcz = parse(contents)
    if mcz.kind is Kind.BYTES:
        restored, lossless = unpack(mcz.payload(0), "contents", mcz.size), True
    else:
        codec, layout, clip = _open(mcz, None)
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
    source: str | Path | bytes,
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
        A path or the file's bytes.
    frames
        Only these frames, e.g. ``slice(100, 200)``; just the chunks they lie in are decoded.
    asf_path
        The skeleton of an AMC; without it, the one in the file, or the ASF beside it, is taken.
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
    packed = _contents(source)
    if diffma_json.is_json(packed):
        clip = diffma_json.json_to_clip(packed)
        return clip if frames is None else clip.with_values(clip.values[frames])
    mcz = parse(packed)
    skeleton = _skeleton(mcz, source, asf_path)
    if mcz.kind is Kind.BYTES:
        contents = decompress(source)
        kind = sniff(contents)
        if kind not in ("amc", "bvh"):
            raise FormatError("no motion in this file", expected="AMC or BVH inside")
        clip, _, problems = split(contents, kind, skeleton=skeleton)
        file = None if isinstance(source, bytes) else str(source)
        report(problems, file, strict=strict)
        return clip if frames is None else clip.with_values(clip.values[frames])
    codec, _, clip = _open(mcz, skeleton)
    rows = range(mcz.frames)[frames or slice(None)]
    if not rows:
        return clip
    first, last = min(rows[0], rows[-1]), max(rows[0], rows[-1]) + 1
    model = _model(mcz, codec, source, models)
    return clip.with_values(_decode(mcz, codec, clip, first, last, model)[:: rows.step])


def _contents(source: str | Path | bytes) -> memoryview:
    if isinstance(source, bytes):
        return memoryview(source)
    with Path(source).open("rb") as file:
        if Path(source).stat().st_size == 0:
            return memoryview(b"")
        return memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))


def _skeleton(mcz: Mcz, source: str | Path | bytes, asf_path: str | Path | None) -> Skeleton | None:
    if asf_path is None and mcz.skeleton:
        return asf.parse_asf(unpack(mcz.skeleton, "skeleton"))
    if asf_path is None and not isinstance(source, bytes) and mcz.kind is not Kind.BVH:
        asf_path = find_asf(Path(source).with_suffix(""))
    return asf.parse_asf(Path(asf_path).read_bytes(), str(asf_path)) if asf_path else None


def _model(
    mcz: Mcz, codec: Codec, source: str | Path | bytes, places: Sequence[Place]
) -> Model | None:
    if not mcz.model:
        return None
    model = find_model(
        mcz.model, places, None if isinstance(source, bytes) else Path(source).parent
    )
    try:
        codecs.learner(codec, model)
    except ParameterError as error:
        raise CorruptError(f"header: {error}") from error
    return model


def _open(mcz: Mcz, skeleton: Skeleton | None) -> tuple[Codec, Layout, Clip]:
    """Read what decoding needs; the clip has no frames yet."""
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
    try:
        return codec, layout, columns_of(layout, skeleton)
    except FormatError as error:
        raise CorruptError(f"layout: {error}") from error


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
    frames = sum(chunk.frames for chunk in chunks)
    values = codec.decode(mcz.codec_header, chunks, clip.columns, model=model)
    if values.shape != (frames, mcz.columns):
        raise CorruptError(
            "decoded values",
            expected=f"{frames} x {mcz.columns}",
            found=" x ".join(map(str, values.shape)),
        )
    return values[first - frame : last - frame]
