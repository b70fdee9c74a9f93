"""The head of a file, which decoding begins with: docs/format.md, section "Head"."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

from mocapress.container import limits
from mocapress.container.columns import Bone, Columns, read_columns, write_columns
from mocapress.container.packing import pack, stored, unpack
from mocapress.container.skeletons import read_skeleton, write_skeleton
from mocapress.motion.frame_time import FrameTime
from mocapress.motion.skeleton import Skeleton
from mocapress.motion.stream import Column
from mocapress.records import Reader, Writer

CHANNELS = "channels"
"""The kind of streams that this version knows."""
DIGEST = 32
_WIDE = 2**448 - 1
_LARGEST_EXPONENT = 512
_NOT_SAID, _DECIMAL, _FRACTION = range(3)
_INTEGER, _DOUBLE, _TEXT, _BOOLEAN = range(4)

Parameter = int | float | str | bool


class CodecSpec(NamedTuple):
    """A codec: its id and its parameters."""

    id: str
    parameters: Mapping[str, Parameter]


@dataclass(frozen=True, slots=True)
class StreamHead:
    """What decoding a stream needs, beside its chunks."""

    name: str
    frames: int | None
    """None in a recording, which has those of its chunks."""
    frame_time: FrameTime
    columns: tuple[Column, ...]
    codec: CodecSpec
    model: bytes = b""
    """Name of the model that decoding needs, or nothing."""
    header: bytes = b""
    """The codec's own."""
    bones: tuple[Bone, ...] = ()
    """By what names the source calls the bones of the columns, as far as known."""
    kind: str = CHANNELS
    """Of another kind, only name and kind are known."""


@dataclass(frozen=True, slots=True)
class Head:
    """The skeleton and the streams of a file."""

    streams: tuple[StreamHead, ...]
    skeleton: Skeleton | None = field(default=None)


def write_head(head: Head) -> bytes:
    """Give the content of the section."""
    writer = Writer()
    write_skeleton(writer, head.skeleton)
    _write_streams(writer, head)
    return pack(bytes(writer.data))


def write_parts(head: Head) -> tuple[bytes, bytes]:
    """Give the skeleton and the streams of a head, not packed; a library keeps them apart."""
    skeleton, streams = Writer(), Writer()
    write_skeleton(skeleton, head.skeleton)
    _write_streams(streams, head)
    return bytes(skeleton.data), bytes(streams.data)


def split_parts(content: bytes) -> tuple[bytes, bytes]:
    """Give what ``write_parts`` gives, from the content of a section that is sound."""
    data = unpack(content, "head", limits.UNPACKED)
    reader = Reader(data, "head")
    read_skeleton(reader)
    return data[: reader.position], data[reader.position :]


def join_parts(skeleton: bytes | None, streams: bytes) -> bytes:
    """Give the content of the section from what ``write_parts`` gave; None for no skeleton."""
    return stored((skeleton or b"\0") + streams)


def read_head(content: bytes) -> Head:
    """Read the content of the section.

    Raises
    ------
    CorruptError
        When it is not a head.

    """
    reader = Reader(unpack(content, "head", limits.UNPACKED), "head")
    skeleton = read_skeleton(reader)
    streams: list[StreamHead] = []
    left = limits.COLUMNS
    for _ in range(reader.integer(limits.STREAMS)):
        name, kind, description = reader.text(), reader.text(), reader.bytes()
        if kind == CHANNELS:
            own = Reader(description, f"stream {name!r}")
            streams.append(_read_stream(own, name, skeleton, left))
            left -= len(streams[-1].columns)
        else:
            streams.append(StreamHead(name, 0, None, (), CodecSpec("", {}), kind=kind))
    reader.end()
    if not streams or len({stream.name for stream in streams}) < len(streams):
        raise reader.fail("no streams, or two of one name")
    return Head(tuple(streams), skeleton)


def _write_streams(writer: Writer, head: Head) -> None:
    writer.integer(len(head.streams))
    for stream in head.streams:
        description = Writer()
        _write_stream(description, stream, head.skeleton)
        writer.text(stream.name)
        writer.text(stream.kind)
        writer.bytes(bytes(description.data))


def _write_stream(writer: Writer, stream: StreamHead, skeleton: Skeleton | None) -> None:
    writer.integer(0 if stream.frames is None else stream.frames + 1)
    _write_time(writer, stream.frame_time)
    write_columns(writer, stream.columns, skeleton)
    _write_codec(writer, stream.codec)
    writer.bytes(stream.model)
    writer.bytes(stream.header)


def _read_stream(
    reader: Reader, name: str, skeleton: Skeleton | None, most_columns: int
) -> StreamHead:
    frames = reader.integer()
    frame_time = _read_time(reader)
    columns: Columns = read_columns(reader, skeleton, most_columns)
    codec = _read_codec(reader)
    model, header = reader.bytes(), reader.bytes()
    reader.end()
    if len(model) not in (0, DIGEST):
        raise reader.fail("no name of a model")
    return StreamHead(
        name,
        frames - 1 if frames else None,
        frame_time,
        columns.columns,
        codec,
        model,
        header,
        columns.bones,
    )


def _write_time(writer: Writer, frame_time: FrameTime) -> None:
    if isinstance(frame_time, Decimal):
        _, digits, exponent = frame_time.as_tuple()
        writer.integer(_DECIMAL)
        writer.integer(int("".join(map(str, digits))))
        writer.signed(int(exponent))
    elif frame_time is not None:
        writer.integer(_FRACTION)
        writer.integer(frame_time.numerator)
        writer.integer(frame_time.denominator)
    else:
        writer.integer(_NOT_SAID)


def is_storable_time(frame_time: FrameTime) -> bool:
    """Tell whether a frame time has few enough digits to be stored."""
    if isinstance(frame_time, Decimal):
        sign, digits, exponent = frame_time.as_tuple()
        small = int("".join(map(str, digits))) <= _WIDE
        return not sign and small and abs(int(exponent)) <= _LARGEST_EXPONENT
    return frame_time is None or (
        0 <= frame_time.numerator <= _WIDE and frame_time.denominator <= _WIDE
    )


def _read_time(reader: Reader) -> FrameTime:
    form = reader.integer(_FRACTION)
    if form == _NOT_SAID:
        return None
    first = reader.integer(_WIDE)
    if form == _DECIMAL:
        exponent = reader.signed()
        if abs(exponent) > _LARGEST_EXPONENT:
            raise reader.fail("no frame time")
        return Decimal((0, tuple(map(int, str(first))), exponent))
    denominator = reader.integer(_WIDE)
    if denominator == 0:
        raise reader.fail("no frame time")
    return Fraction(first, denominator)


def _write_codec(writer: Writer, codec: CodecSpec) -> None:
    writer.text(codec.id)
    writer.integer(len(codec.parameters))
    for name, value in codec.parameters.items():
        writer.text(name)
        if isinstance(value, bool):
            writer.data += bytes((_BOOLEAN, value))
        elif isinstance(value, int):
            writer.data.append(_INTEGER)
            writer.signed(value)
        elif isinstance(value, float):
            writer.data.append(_DOUBLE)
            writer.double(value)
        else:
            writer.data.append(_TEXT)
            writer.text(value)


def _read_codec(reader: Reader) -> CodecSpec:
    name = reader.text()
    parameters: dict[str, Parameter] = {}
    for _ in range(reader.integer(limits.PARAMETERS)):
        parameter, form = reader.text(), reader.raw(1)[0]
        if form == _INTEGER:
            parameters[parameter] = reader.signed()
        elif form == _DOUBLE:
            parameters[parameter] = reader.double()
        elif form == _TEXT:
            parameters[parameter] = reader.text()
        elif form == _BOOLEAN:
            parameters[parameter] = reader.integer(1) == 1
        else:
            raise reader.fail("a parameter of no type")
    return CodecSpec(name, parameters)
