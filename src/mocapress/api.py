"""The Python interface: ``import mocapress as mp``."""

import hashlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mocapress import codecs
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.container import Kind, diffma_json, pack, pack_file
from mocapress.errors import FormatError, MocapressError
from mocapress.formats import asf
from mocapress.formats import files as motion_files
from mocapress.formats.files import find_asf, format_clip, sniff, split
from mocapress.models import load_model
from mocapress.motion import Clip, Skeleton, convert
from mocapress.restore import decompress, load
from mocapress.storage import write_whole

__all__ = ["Compressed", "compress", "compress_bytes", "decompress", "load", "read", "write"]

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
    model: Model | str | Path | None = None,
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
    model
        What the codec learned from other clips (``train``), or its file. Decompressing needs it
        again.

    Returns
    -------
    bytes
        The ``.mcz`` file; it was decoded again and compared with the source.

    Raises
    ------
    ParameterError
        When there is no such codec, or it has no such parameter, or the model is not for it.
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
    if model is not None and not isinstance(model, Model):
        model = load_model(model)
    return compress_bytes(
        data, codec, name=name, asf_data=skeleton, embed_asf=embed_asf, model=model
    ).blob


def compress_bytes(
    data: bytes,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    name: str = "",
    asf_data: bytes = b"",
    embed_asf: bool = False,
    model: Model | None = None,
) -> Compressed:
    """Compress the contents of a file; see ``compress``. ``name`` is for messages."""
    made = codecs.codec(codec) if isinstance(codec, str) else codec
    if model is not None:
        codecs.learner(made, model)
    skeleton = asf.parse_asf(asf_data) if asf_data else None
    kind = sniff(data, name)
    blob, warning = None, None
    if kind in ("amc", "bvh"):
        try:
            blob, warning = _compress_motion(
                data, kind, made, skeleton, asf_data if embed_asf else b"", name, model
            )
        except FormatError as error:
            warning = f"{error}; stored by a general-purpose compressor"
            if skeleton is not None and not embed_asf:
                # The ASF that lay beside may be another's.
                with suppress(FormatError):
                    blob, _ = _compress_motion(data, kind, made, None, b"", name, model)
                    warning = f"{error}; compressed without a skeleton"
    elif kind is None:
        warning = "not a motion file; stored by a general-purpose compressor"
    if blob is None or len(data) < _SMALL or len(blob) > _POOR * len(data):
        plain = _compress_plain(data)
        if blob is None or len(plain) < len(blob):
            blob = plain
    return Compressed(blob, warning)


def _compress_motion(
    data: bytes,
    kind: str,
    codec: Codec,
    skeleton: Skeleton | None,
    embedded: bytes,
    name: str,
    model: Model | None,
) -> tuple[bytes | None, str | None]:
    clip, layout, problems = split(data, kind, skeleton=skeleton, file=name or None)
    warning = "; ".join(str(problem.error(name or None)) for problem in problems) or None
    if layout.verbatim_bytes() + len(layout.tail) > len(data) / 2:
        return None, warning or "numbers in no regular form; stored by a general-purpose compressor"
    encoded = codec.encode(clip, model=model)
    blob = pack_file(
        kind=Kind[kind.upper()],
        size=len(data),
        digest=hashlib.sha256(data).digest(),
        payloads=[(chunk.frames, chunk.restart, chunk.payload) for chunk in encoded.chunks],
        columns=clip.channels,
        codec=codecs.spec(codec),
        model=model.digest if model else b"",
        codec_header=encoded.header,
        layout=pack(layout.to_bytes()),
        skeleton=pack(embedded) if embedded else b"",
    )
    if codec.lossless:
        try:
            restored = decompress(blob, models=[model] if model else [])
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


def read(path: str | Path, *, asf_path: str | Path | None = None, strict: bool = True) -> Clip:
    """Read a motion file: AMC, BVH, ASF or DiffMA JSON.

    Parameters
    ----------
    path
        An ASF alone gives a clip of its skeleton without frames.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.
    strict
        Whether a file that has lost frames is refused: one with fewer rows than it declares, or
        with rows that cannot be read. With ``strict=False`` it is read as far as possible, with a
        ``MotionWarning``; a row that cannot be read between others keeps the values of the one
        before. What loses nothing, such as a row more than declared, always is a warning.

    Raises
    ------
    FormatError
        When the file does not follow its format: with file, place, expected and found.
    OSError
        When it cannot be opened.

    """
    if diffma_json.is_json(b"", str(path)):
        return diffma_json.json_to_clip(Path(path).read_bytes())
    return motion_files.read(path, asf_path=asf_path, strict=strict)


def write(clip: Clip, path: str | Path, *, force: bool = False) -> None:
    """Write a clip as AMC, BVH or (``.diffma.json``, ``.diffma.json.xz``) DiffMA JSON.

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
    if diffma_json.is_json(b"", path.name):
        write_whole(path, diffma_json.named(path.name, diffma_json.to_json(clip)), force=force)
        return
    kind = path.suffix.lower()[1:]
    if kind == "bvh":
        clip = convert.to_bvh_clip(clip)
    elif kind == "amc" and clip.skeleton is not None:
        clip = convert.to_amc_clip(clip)
    data = format_clip(clip, kind)
    if kind == "amc" and clip.skeleton is not None:
        write_whole(path.with_suffix(".asf"), asf.format_asf(clip.skeleton), force=force)
    write_whole(path, data, force=force)
