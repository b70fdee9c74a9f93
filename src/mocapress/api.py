"""The Python interface: ``import mocapress as mp``."""

import hashlib
import mmap
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs, convert
from mocapress.codecs import Chunk, Codec
from mocapress.container import Kind, Mcz, pack, pack_file, parse, unpack
from mocapress.errors import CorruptError, FormatError, MocapressError, ParameterError
from mocapress.files import write_whole
from mocapress.formats import asf
from mocapress.formats.files import columns_of, find_asf, format_clip, read, sniff, split
from mocapress.formats.layout import Layout
from mocapress.model import Clip, Skeleton

__all__ = ["Compressed", "compress", "compress_bytes", "decompress", "load", "read", "write"]

DEFAULT_CODEC = "app"
# Below this size, or above this share of the original, the general-purpose way is tried as well.
_SMALL = 2**15
_POOR = 0.4


@dataclass(frozen=True, slots=True)
class Compressed:
    """What ``compress_bytes`` made."""

    blob: bytes
    """The ``.mcz`` file."""
    warning: str | None
    """Why the numbers, or a part of them, were not compressed as motion."""


def compress(
    source: str | Path | bytes,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    asf_path: str | Path | None = None,
    embed_asf: bool = False,
) -> bytes:
    """Compress a file, or its bytes, to a ``.mcz``.

    Parameters
    ----------
    source
        A path, or the contents of an AMC, BVH, ASF or any other file.
    codec
        A codec or its text, ``"app:t=15,table=k3-non-uniform"``.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.
    embed_asf
        Whether to store the skeleton of an AMC, too.

    Returns
    -------
    bytes
        The ``.mcz`` file; it was decoded again and compared with the source.

    Raises
    ------
    ParameterError
        When there is no such codec, or it has no such parameter.
    FormatError
        When the ASF cannot be read.

    """
    if isinstance(source, bytes):
        data, name = source, ""
    else:
        data, name = Path(source).read_bytes(), str(source)
        if asf_path is None and sniff(data, name) == "amc":
            asf_path = find_asf(Path(source))
    skeleton = Path(asf_path).read_bytes() if asf_path else b""
    return compress_bytes(data, codec, name=name, asf_data=skeleton, embed_asf=embed_asf).blob


def compress_bytes(
    data: bytes,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    name: str = "",
    asf_data: bytes = b"",
    embed_asf: bool = False,
) -> Compressed:
    """Compress the contents of a file; see ``compress``. ``name`` is for messages."""
    made = codecs.codec(codec) if isinstance(codec, str) else codec
    skeleton = asf.parse_asf(asf_data) if asf_data else None
    kind = sniff(data, name)
    blob, warning = None, None
    if kind in ("amc", "bvh"):
        try:
            blob, warning = _compress_motion(
                data, kind, made, skeleton, asf_data if embed_asf else b"", name
            )
        except FormatError as error:
            warning = f"{error}; stored by a general-purpose compressor"
    elif kind is None:
        warning = "not a motion file; stored by a general-purpose compressor"
    if blob is None or len(data) < _SMALL or len(blob) > _POOR * len(data):
        plain = _compress_plain(data)
        if blob is None or len(plain) < len(blob):
            blob = plain
    return Compressed(blob, warning)


def _compress_motion(
    data: bytes, kind: str, codec: Codec, skeleton: Skeleton | None, embedded: bytes, name: str
) -> tuple[bytes | None, str | None]:
    clip, layout, error = split(data, kind, skeleton=skeleton, file=name or None)
    warning = f"{error}; the rest of the file is kept as text" if error else None
    if layout.verbatim_bytes() + len(layout.tail) > len(data) / 2:
        return None, warning or "numbers in no regular form; stored by a general-purpose compressor"
    encoded = codec.encode(clip)
    blob = pack_file(
        kind=Kind[kind.upper()],
        size=len(data),
        digest=hashlib.sha256(data).digest(),
        payloads=[(chunk.frames, chunk.restart, chunk.payload) for chunk in encoded.chunks],
        columns=clip.channels,
        codec=codecs.spec(codec),
        codec_header=encoded.header,
        layout=pack(layout.to_bytes()),
        skeleton=pack(embedded) if embedded else b"",
    )
    if codec.lossless:
        try:
            restored = decompress(blob)
        except MocapressError as failure:
            return None, f"codec {codec.id} failed its check ({failure}); stored without it"
        if restored != data:
            return None, f"codec {codec.id} does not restore this file; stored without it"
    return blob, warning


def _compress_plain(data: bytes) -> bytes:
    return pack_file(
        kind=Kind.BYTES,
        size=len(data),
        digest=hashlib.sha256(data).digest(),
        payloads=[(0, True, pack(data))],
    )


def decompress(source: str | Path | bytes) -> bytes:
    """Give the original file's bytes (for a lossy codec: the decoded values in its layout).

    Raises
    ------
    CorruptError
        When the file is damaged; also when what was decoded is not what its digest says.

    """
    mcz = parse(_contents(source))
    if mcz.kind is Kind.BYTES:
        restored, lossless = unpack(mcz.payload(0), "contents", mcz.size), True
    else:
        codec, layout, clip = _open(mcz, None)
        lossless = codec.lossless
        values = _decode(mcz, codec, clip, 0, mcz.frames)
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
) -> Clip:
    """Give the clip in a ``.mcz``, or some of its frames.

    Parameters
    ----------
    source
        A path or the file's bytes.
    frames
        Only these frames, e.g. ``slice(100, 200)``; just the chunks they lie in are decoded.
    asf_path
        The skeleton of an AMC; without it, the one in the file, or the ASF beside it, is taken.

    Raises
    ------
    CorruptError
        When the file is damaged, as far as it was read.

    """
    mcz = parse(_contents(source))
    skeleton = _skeleton(mcz, source, asf_path)
    if mcz.kind is Kind.BYTES:
        contents = decompress(source)
        kind = sniff(contents)
        if kind not in ("amc", "bvh"):
            raise FormatError("no motion in this file", expected="AMC or BVH inside")
        clip = split(contents, kind, skeleton=skeleton).clip
        return clip if frames is None else clip.with_values(clip.values[frames])
    codec, _, clip = _open(mcz, skeleton)
    rows = range(mcz.frames)[frames or slice(None)]
    if not rows:
        return clip
    first, last = min(rows[0], rows[-1]), max(rows[0], rows[-1]) + 1
    return clip.with_values(_decode(mcz, codec, clip, first, last)[:: rows.step])


def write(clip: Clip, path: str | Path, *, force: bool = False) -> None:
    """Write a clip as AMC or BVH, as the name's ending says.

    The clip is converted where its columns are those of the other format. Beside an AMC its
    skeleton is written as an ASF of the same name.

    Raises
    ------
    ExistsError
        When a file exists and ``force`` is not given.
    UnsupportedError
        When the clip lacks what the format needs.

    """
    path = Path(path)
    kind = path.suffix.lower()[1:]
    if kind == "bvh":
        clip = convert.to_bvh_clip(clip)
    elif kind == "amc" and clip.skeleton is not None:
        clip = convert.to_amc_clip(clip)
    data = format_clip(clip, kind)
    if kind == "amc" and clip.skeleton is not None:
        write_whole(path.with_suffix(".asf"), asf.format_asf(clip.skeleton), force=force)
    write_whole(path, data, force=force)


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


def _decode(mcz: Mcz, codec: Codec, clip: Clip, first: int, last: int) -> NDArray[np.float64]:
    """Decode frames [first, last) and the fewest chunks that they need."""
    start, stop, frame = mcz.chunk_range(first, last)
    chunks = chunks_of(mcz, start, stop, frame)
    frames = sum(chunk.frames for chunk in chunks)
    values = codec.decode(mcz.codec_header, chunks, clip.columns)
    if values.shape != (frames, mcz.columns):
        raise CorruptError(
            "decoded values",
            expected=f"{frames} x {mcz.columns}",
            found=" x ".join(map(str, values.shape)),
        )
    return values[first - frame : last - frame]
