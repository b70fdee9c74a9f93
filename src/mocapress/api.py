"""The Python interface: ``import mocapress as mp``."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

from mocapress import codecs, formats
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.codecs.fallback import first_that_works
from mocapress.codecs.loss import Loss, checked_loss
from mocapress.container import Kind, diffma_json, pack, pack_file, parse
from mocapress.errors import CorruptError, FormatError, UnsupportedError, VerificationError
from mocapress.formats import Format, Split
from mocapress.models import load_model
from mocapress.motion import Clip
from mocapress.motion.convert import with_rate
from mocapress.restore import chunks_of, decompress, load
from mocapress.source import DIFFMA_JSON, JSON_SUFFIXES, Named, Source
from mocapress.source import read as read_motion
from mocapress.storage import ExistsError, write_all, write_whole

__all__ = ["Compressed", "compress", "compress_source", "decompress", "load", "read", "write"]

# Below this size, or above this share of the original, the general-purpose way is tried as well.
_SMALL = 2**15
_POOR = 0.4


@dataclass(frozen=True, slots=True)
class Compressed:
    """What ``compress_source`` made."""

    blob: bytes
    """The ``.mcz`` file."""
    warning: str | None
    """Why the numbers, or a part of them, were not compressed as motion."""
    loss: Loss | None = None
    """What a lossy codec lost, measured from what it decodes to; None where nothing is lost."""


def compress(
    source: Named,
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
        A path, the contents, or a binary stream, of a motion file or any other.
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
        The ``.mcz`` file; it was decoded again and compared with the source. Where a codec fails,
        another way is taken; ``compress_source`` says so.

    Raises
    ------
    ParameterError
        When there is no such codec, or it has no such parameter, or the model is not for it.
    FormatError
        When the ASF that was given cannot be read.

    """
    if model is not None and not isinstance(model, Model):
        model = load_model(model)
    opened = Source(source)
    return compress_source(opened, codec, asf_path=asf_path, embed_asf=embed_asf, model=model).blob


def compress_source(
    source: Source,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    asf_path: str | Path | None = None,
    embed_asf: bool = False,
    model: Model | None = None,
) -> Compressed:
    """Compress a file; see ``compress``."""
    made = codecs.codec(codec) if isinstance(codec, str) else codec
    if model is not None:
        codecs.learner(made, model)
    data = source.data
    blob, warning, loss = None, None, None
    if source.format is None:
        warning = "not a motion file; stored by a general-purpose compressor"
    elif source.format.split:
        try:
            parts = source.split(asf_path)
        except FormatError as error:
            if asf_path is not None and error.file == str(asf_path):
                raise
            warning = f"{error}; stored by a general-purpose compressor"
        else:
            embedded = source.used.read() if embed_asf and source.used else b""
            if embedded:
                source.warn_of_guess()
            blob, warning, loss = _compress_motion(source, parts, made, embedded, model)
    if blob is None or len(data) < _SMALL or len(blob) > _POOR * len(data):
        plain = _compress_plain(data)
        if blob is None or len(plain) < len(blob):
            blob, loss = plain, None
    return Compressed(blob, warning, loss)


def _compress_motion(
    source: Source, parts: Split, codec: Codec, embedded: bytes, model: Model | None
) -> tuple[bytes | None, str | None, Loss | None]:
    clip, layout, problems = parts
    data, name = source.data, source.name or None
    warning = "; ".join(str(problem.error(name)) for problem in problems) or None
    if not clip.frames or layout.verbatim_bytes() + len(layout.tail) > len(data) / 2:
        reason = "numbers in no regular form" if clip.frames else "no frames"
        return None, warning or f"{reason}; stored by a general-purpose compressor", None

    def work(way: Codec) -> tuple[bytes, Loss | None]:
        own = model if way is codec else None
        encoded = way.encode(clip.main, skeleton=clip.skeleton, model=own)
        blob = pack_file(
            kind=Kind[layout.format.upper()],
            size=len(data),
            digest=hashlib.sha256(data).digest(),
            payloads=[(chunk.frames, chunk.restart, chunk.payload) for chunk in encoded.chunks],
            columns=clip.channels,
            codec=codecs.spec(way),
            model=own.digest if own else b"",
            codec_header=encoded.header,
            layout=pack(layout.to_bytes()),
            skeleton=pack(embedded) if embedded else b"",
        )
        return blob, _check(blob, data, way, clip, own)

    found, failure = first_that_works(codec, work)
    blob, loss = found or (None, None)
    return blob, "; ".join(filter(None, (failure, warning))) or None, loss


def _check(blob: bytes, data: bytes, codec: Codec, clip: Clip, model: Model | None) -> Loss | None:
    """Decode a file and compare: bytes of a lossless codec, else values."""
    failure = "the file does not come back"
    try:
        if not codec.lossless:
            mcz = parse(blob)
            values = codec.decode(mcz.codec_header, chunks_of(mcz), clip.columns, model=model)
            return checked_loss(codec, clip, values)
        if decompress(blob, models=[model] if model else []) == data:
            return None
    except CorruptError as error:
        failure = error.what
    raise VerificationError(f"codec {codec.id} failed its check ({failure}); please report this")


def _compress_plain(data: bytes) -> bytes:
    return pack_file(
        kind=Kind.BYTES,
        size=len(data),
        digest=hashlib.sha256(data).digest(),
        payloads=[(0, True, pack(data))],
    )


def read(source: Named, *, asf_path: str | Path | None = None, strict: bool = True) -> Clip:
    """Read a motion file: of any format, or DiffMA JSON.

    Parameters
    ----------
    source
        A path, the contents, or a binary stream. A skeleton alone (ASF) gives a clip without
        frames.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one:
        that of the same name, of the subject, or the only one in the folder, which is warned of.
        ``metadata`` of the clip says which one was used (``skeleton``) and how it was found
        (``skeleton_found``). One that is broken or does not fit is left away with a warning.
    strict
        Whether a file that has lost frames is refused: one with fewer rows than it declares, or
        with rows that cannot be read. With ``strict=False`` it is read as far as possible, with a
        ``MotionWarning``; a row that cannot be read between others keeps the values of the one
        before. What loses nothing, such as a row more than declared, always is a warning.

    Raises
    ------
    FormatError
        When the file does not follow its format, or the given ASF cannot be read or is another's:
        with file, place, expected and found.
    OSError
        When it cannot be opened.

    """
    return read_source(Source(source), asf_path, strict=strict)


def read_source(source: Source, asf_path: str | Path | None = None, *, strict: bool = True) -> Clip:
    """Read a motion file; see ``read``."""
    if source.kind == DIFFMA_JSON:
        return diffma_json.json_to_clip(source.data)
    return read_motion(source, asf_path, strict=strict)


def write(
    clip: Clip,
    path: str | Path,
    *,
    to: str | None = None,
    fps: float | None = None,
    force: bool = False,
) -> None:
    """Write a clip to a motion file, or as DiffMA JSON.

    The clip is converted to what the format can hold. What belongs beside the file is written,
    too: the skeleton of an AMC as an ASF of the same name.

    Parameters
    ----------
    clip
        With a skeleton, except for formats that need none.
    path
        Its ending names the format.
    to
        Id of the format, whatever the ending.
    fps
        Frames per second, instead of those of the clip. A BVH has to state its frame time: where
        neither the clip nor ``fps`` says it, 120 are assumed, with a ``MotionWarning``.
    force
        Whether to replace existing files.

    Raises
    ------
    ParameterError
        When ``fps`` is no number above 0.
    ExistsError
        When a file exists and ``force`` is not given.
    UnsupportedError
        When there is no such format to write in, or the clip lacks what it needs.

    """
    path = Path(path)
    if to is None and path.name.lower().endswith(JSON_SUFFIXES):
        clip = with_rate(clip, fps)
        write_whole(path, diffma_json.named(path.name, diffma_json.to_json(clip)), force=force)
        return
    of = formats.by_id(to) if to else formats.by_name(path.name)
    if of is None:
        known = formats.listed(formats.writable())
        raise UnsupportedError("no format for clips", expected=known, found=repr(path.suffix))
    write_all(printed(with_rate(clip, fps, needed=of.timed), of, path), force=force)


def printed(clip: Clip, of: Format, path: Path) -> dict[Path, bytes]:
    """Print a clip in a format: contents by path, of the file itself first.

    Raises
    ------
    ExistsError
        When something else lies where the skeleton would go, and no file of this name beside it:
        then it is not a skeleton that came with this file, but one of others.
    UnsupportedError
        When the clip lacks what the format needs.

    """
    if of.write is None:
        known = formats.listed(formats.writable())
        raise UnsupportedError("no format for clips", expected=known, found=of.name)
    (_, data), *companions = of.write(of.fit(clip)).items()
    files = {path: data}
    for suffix, contents in companions:
        place = path.with_suffix(suffix)
        if not place.exists() or path.exists():
            files[place] = contents
        elif place.read_bytes() != contents:
            raise ExistsError(
                f"file exists and did not come with {path.name}",
                file=str(place),
                expected="another name for the output, or this file elsewhere",
            )
    return files
