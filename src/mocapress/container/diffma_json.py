"""Motion files as DiffMA JSON and back (docs/guide/diffma_json.md); ``.xz`` packs the text."""

import lzma
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mocapress import codecs
from mocapress.codecs import Codec
from mocapress.codecs.diffma.document import Document, read_document
from mocapress.codecs.fallback import naming_faults
from mocapress.codecs.loss import Loss
from mocapress.container.columns import Columns, bone_names, bones_of, read_columns, write_columns
from mocapress.container.limits import most_json, most_json_parts, most_printed
from mocapress.container.packing import pack, unpack
from mocapress.errors import (
    CorruptError,
    FormatError,
    ParameterError,
    UnsupportedError,
)
from mocapress.formats.layout import NO_ROWS, Layout
from mocapress.formats.layout_record import read_layout, write_layout
from mocapress.formats.number_formats import SHORTEST
from mocapress.formats.patterns import References
from mocapress.motion import Clip, Column
from mocapress.records import Reader, Writer
from mocapress.source import JSON_SUFFIXES, Named, Source

_XZ = b"\xfd7zXZ\x00"
_FOR_TEXT = [
    {
        "id": lzma.FILTER_LZMA2,
        "preset": 9 | lzma.PRESET_EXTREME,
        "dict_size": 1 << 26,
        "lc": 4,
        "lp": 0,
        "pb": 0,
    }
]
# Decoders that want more memory are refused.
_MOST_MEMORY = 1 << 27


def stem(name: str) -> str:
    """Give a file's name without the ending."""
    ending = max((e for e in JSON_SUFFIXES if name.lower().endswith(e)), key=len, default="")
    return name[: len(name) - len(ending)]


def to_json(
    source: Named | Clip,
    codec: str | Codec = "diffma",
    *,
    asf_path: str | Path | None = None,
) -> bytes:
    """Code a clip, a motion file or its bytes as DiffMA JSON.

    Parameters
    ----------
    source
        A clip, or a motion file: a path, its contents, or a stream.
    codec
        ``diffma`` with parameters, ``"diffma:bound=4"``.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.

    Returns
    -------
    bytes
        JSON text; ``decompress`` makes the motion file again, unless the source was a clip.

    Raises
    ------
    FormatError
        When the source is not a motion file, or is broken.
    ParameterError
        When the codec is another, or has no such parameter.

    """
    made = diffma_codec(codec) if isinstance(codec, str) else codec
    if isinstance(source, Clip):
        return clip_to_json(source, made)
    return file_to_json(Source(source), made, asf_path=asf_path)[0]


def diffma_codec(text: str) -> Codec:
    """Make the codec of a text, which must write DiffMA JSON."""
    made = codecs.codec(text)
    if not made.can.document:
        raise ParameterError("JSON is written by one codec", expected="diffma", found=repr(made.id))
    return made


def file_to_json(
    source: Source, codec: Codec, *, asf_path: str | Path | None = None
) -> tuple[bytes, Loss]:
    """Code a motion file; what comes back of it, by ``json_to_file``, has its layout.

    Returns
    -------
    tuple
        JSON text, and what it has lost, measured from what it decodes to.

    Raises
    ------
    FormatError
        When it is not a motion file, or is broken.

    """
    clip, layout, problems, _ = source.split(asf_path)
    if layout is NO_ROWS:
        raise UnsupportedError("DiffMA JSON holds files of text", file=source.name or None)
    source.accept(problems)
    source.warn_of_guess()
    text = clip_to_json(clip, codec, layout=_packed(layout, clip))
    return text, Loss.of(clip.values, json_to_clip(Source(text, limit=None)).values)


def clip_to_json(clip: Clip, codec: Codec, *, layout: bytes = b"") -> bytes:
    """Code a clip: JSON text, which was read and decoded again and keeps the largest errors.

    Raises
    ------
    UnsupportedError
        When a value is not finite, which JSON cannot express.
    VerificationError
        When the codec fails, or what was decoded is not what was encoded.

    """
    _refuse_not_finite(clip)
    with naming_faults(codec):
        return codec.document(clip, layout)


def named(name: str, text: bytes) -> bytes:
    """Give JSON text as a file of this name holds it: packed where it ends in ``.xz``."""
    return lzma.compress(text, filters=_FOR_TEXT) if name.lower().endswith(".xz") else text


def open_json(data: bytes | memoryview) -> Document:
    """Read a document, packed or not.

    Raises
    ------
    FormatError, CorruptError
        When it breaks the format, or its packing is damaged.

    """
    data = bytes(data)
    if data[:6] == _XZ:
        most = most_json(len(data))
        decoder = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=_MOST_MEMORY)
        try:
            data = decoder.decompress(data, max_length=most)
        except lzma.LZMAError as error:
            raise CorruptError(f"xz: cannot be unpacked ({error})") from error
        if not decoder.eof or decoder.unused_data:
            raise CorruptError(f"xz: cut off, or too long: more than {most} bytes unpacked")
    # No opcode is a comma, a bracket or a colon, so they count what becomes an object in memory.
    parts, most = sum(map(data.count, (b",", b"[", b":"))), most_json_parts(len(data))
    if parts > most:
        raise FormatError(
            "$", expected=f"at most {most} numbers, texts and lists", found=str(parts)
        )
    return read_document(data)


def json_to_clip(source: Source, *, bound: float | None = None) -> Clip:
    """Give the clip in a document; ``bound`` asks for a coarser level of detail.

    Columns, skeleton and frame time are as far known as the document says.

    Raises
    ------
    UnsupportedError
        When it has more numbers than the source's limit allows.

    """
    document = open_json(source.data)
    source.allow(8 * document.frames * len(document.names))
    columns = _unpacked(document)[0].columns if document.layout else _columns(document)
    return Clip.of(document.decode(bound), columns, document.frame_time, document.skeleton)


def json_to_file(source: Source) -> tuple[str, bytes]:
    """Give the motion file that a document was made of, with the decoded values in its layout.

    Returns
    -------
    tuple
        The id of its format, and the file's bytes.

    Raises
    ------
    UnsupportedError
        When the document has no layout, as those of other writers; or when more would be restored
        than the source's limit allows.

    """
    document = open_json(source.data)
    source.allow(8 * document.frames * len(document.names))
    if not document.layout:
        raise UnsupportedError(
            "$.layout is not there to make the file again",
            expected="one made of a motion file; this one can only be converted",
        )
    found, kind, record = _unpacked(document)
    values = document.decode()
    most = most_printed(1 << 24, values.size + source.size)
    formats = tuple(column.decimal or SHORTEST for column in found.columns)
    layout = read_layout(record, kind, document.frames, formats, _references(found), most)
    return kind, source.printed(lambda allowed: layout.join(values, allowed), most)


def format_of(data: bytes | memoryview) -> str:
    """Give the id of the format of the motion file that a document was made of, or ``json``."""
    document = open_json(data)
    return _unpacked(document)[1] if document.layout else "json"


def _packed(layout: Layout, clip: Clip) -> bytes:
    """Give the layout of a document: format, frames, and, packed, the columns and the layout."""
    writer, record = Writer(), Writer()
    write_columns(record, clip.columns, None)
    columns = Columns(clip.columns, bones_of(clip.columns))
    writer.text(layout.format)
    writer.integer(clip.frames)
    packed = pack(bytes(record.data) + write_layout(layout, _references(columns)))
    return bytes(writer.data) + packed


def _unpacked(document: Document) -> tuple[Columns, str, bytes]:
    """Give the columns, the format's id, and the layout that is not read yet."""
    reader = Reader(document.layout, "$.layout")
    kind, frames = reader.text(), reader.integer()
    if frames != document.frames:
        raise _misfit("frames", document.frames, frames)
    most = (1 << 22) + 64 * len(document.layout)
    record = Reader(unpack(reader.raw(reader.left), "$.layout", most), "$.layout")
    columns = read_columns(record, None)
    joints = len(document.skeleton.joints) if document.skeleton else len(document.names)
    if len(columns.columns) != len(document.names):
        raise _misfit("channels", len(document.names), len(columns.columns))
    if any(column.joint >= joints for column in columns.columns):
        raise _misfit("joints", joints, max(column.joint for column in columns.columns) + 1)
    return columns, kind, record.raw(record.left)


def _references(columns: Columns) -> References:
    """Give what the layout refers to: bones alone, as the rest stands in the document as text."""
    return References.of(None, bone_names(columns.bones), None)


def _misfit(what: str, expected: int, found: int) -> FormatError:
    return FormatError(f"$.layout: {what}", expected=str(expected), found=str(found))


def _columns(document: Document) -> tuple[Column, ...]:
    places: Sequence[tuple[int, str]] = document.places
    unit = document.skeleton.angle_unit if document.skeleton else "deg"
    if document.skeleton is None:
        joints: dict[str, int] = {}
        parted = [name.rpartition(".") for name in document.names]
        places = [(joints.setdefault(joint, len(joints)), kind) for joint, _, kind in parted]
    columns = []
    for name, (joint, kind) in zip(document.names, places, strict=True):
        known = {"r": unit, "t": "length", "l": "length"} if len(kind) <= 2 else {}
        columns.append(Column(name, joint, kind, known.get(kind[:1], "")))
    return tuple(columns)


def _refuse_not_finite(clip: Clip) -> None:
    wrong = np.argwhere(~np.isfinite(clip.values))
    if len(wrong):
        frame, column = wrong[0].tolist()
        value = float(clip.values[frame, column])
        raise UnsupportedError(
            f"{clip.columns[column].name} in frame {frame + 1} cannot stand in JSON",
            expected="a finite number",
            found=str(value),
        )
