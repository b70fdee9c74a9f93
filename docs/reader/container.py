"""The sections of ``.mcz`` and ``.mcm`` files (docs/format.md)."""

import hashlib
import lzma
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path

from records import CorruptError, Record

HEAD, FILE, CHUNK, END = 1, 2, 3, 4
MAY_BE_SKIPPED = 0x80
KINDS = ("tx", "ty", "tz", "rx", "ry", "rz", "l", "sx", "sy", "sz")
DICTIONARY = Path(__file__).resolve().parents[2] / "src/mocapress/container/dictionary1.bin"


@dataclass
class Joint:
    """A joint of the skeleton, as far as printing needs it."""

    name: str
    channels: list[str]
    numbers: list[float]
    """Of the header: offset and end sites."""


@dataclass
class Stream:
    """Numbers of so many columns, and how they are coded."""

    frames: int | None
    """None in a recording."""
    frame_time: tuple[int, int] | None
    """Coefficient and exponent of a decimal."""
    bones: list[str]
    """Of each column, where it has one."""
    formats: list[bytes | None]
    codec: str
    parameters: dict[str, str]
    model: bytes
    header: bytes
    chunks: list["Chunk"] = field(default_factory=list)


@dataclass
class Chunk:
    """A run of frames."""

    frames: int
    digest: int
    header: bytes | None
    payload: bytes
    needs: list[bytes]
    """Digests of the frames of other chunks, in a library."""


@dataclass
class File:
    """What a file holds."""

    joints: list[Joint]
    streams: list[Stream]
    format: str | None = None
    """Of the original; none where the file was made from numbers."""
    size: int = 0
    digest: bytes = b""
    layout: bytes = b""
    """Or the original itself."""


def sections(data: bytes, magic: bytes) -> list[tuple[int, int, bytes]]:
    """Give where each section begins, its tag, and its content."""
    if data[:5] != magic + b"\1":
        raise CorruptError("not a file of version 1 of this kind")
    record, found = Record(data), []
    record.at = 5
    while any(data[record.at :]):
        start = record.at
        try:
            (tag,), content = record.raw(1), record.bytes()
            stored = int.from_bytes(record.raw(4), "little")
        except CorruptError:
            break  # cut off: no part of the file
        if zlib.crc32(data[start : record.at - 4]) != stored:
            raise CorruptError(f"the section from byte {start} on is damaged")
        found.append((start, tag, content))
    return found


def unpacked(record: Record, beside: bytes = b"") -> bytes:
    """Take packed content, which is the rest of a record; ``beside`` is behind the dictionary."""
    (method,), size = record.raw(1), record.integer()
    data = record.raw(len(record.data) - record.at)
    if method == 1:
        dictionary = min(max(4096, 1 << max(size - 1, 0).bit_length()), 2**26)
        filters = [{"id": lzma.FILTER_LZMA2, "dict_size": dictionary}]
        data = lzma.decompress(data, lzma.FORMAT_RAW, filters=filters)
    elif method == 2:
        data = zlib.decompressobj(-15, zdict=DICTIONARY.read_bytes() + beside).decompress(data)
    elif method != 0:
        raise CorruptError("packed by a method that this version does not have")
    if len(data) != size:
        raise CorruptError("packed content of another size")
    return data


def read_file(data: bytes) -> File:
    """Read a ``.mcz``."""
    file, ended = File([], []), False
    for start, tag, content in sections(data, b"\x89MCZ"):
        record = Record(content)
        if tag == HEAD:
            head = Record(unpacked(record))
            file.joints = read_skeleton(head)
            file.streams = [read_stream(head, file.joints) for _ in range(head.integer())]
            head.end()
        elif tag == FILE:
            read_original(record, file)
        elif tag == CHUNK:
            read_chunk(record, file)
        elif tag == END:
            check_end(record, sum(len(stream.chunks) for stream in file.streams), start, data)
            ended = True
        elif not tag & MAY_BE_SKIPPED:
            raise CorruptError("a section that this version does not have")
    for stream in file.streams:
        frames = sum(chunk.frames for chunk in stream.chunks)
        if stream.frames is not None and (frames != stream.frames or not ended):
            raise CorruptError("frames are missing")
    return file


def read_skeleton(record: Record) -> list[Joint]:
    """Take the skeleton; what no text needs is passed by."""
    count = record.integer()
    if count == 0:
        return []
    flags = record.integer()
    record.text()
    for _ in range(2 * record.integer()):
        record.text()
    if flags & 4:
        record.double()
    names = [record.text() for _ in range(count)]
    for _ in range(count):
        record.integer()
    channels = [[KINDS[code] for code in record.bytes()] for _ in range(count)]
    ends = [record.integer() for _ in range(count)]
    numbers = iter(record.numbers(3 * (count + sum(ends))))
    own = [[next(numbers) for _ in range(3 + 3 * end)] for end in ends]
    if flags & 8:
        for _ in range(count):
            record.bytes()
        record.numbers(3 * count)
    if flags & 16:
        record.numbers(2 * sum(record.integer() for _ in range(count)))
    return [Joint(*told) for told in zip(names, channels, own, strict=True)]


def read_stream(record: Record, joints: list[Joint]) -> Stream:
    """Take a stream."""
    record.text()
    if record.text() != "channels":
        raise CorruptError("a stream of a kind that this version does not have")
    told = Record(record.bytes())
    frames = told.integer() - 1
    frame_time = None
    time = told.integer()
    if time == 1:
        frame_time = told.integer(), told.signed()
    elif time == 2:
        told.integer()
        told.integer()
    count = told.integer()
    bones = read_bones(told, joints, count)
    formats = [None, *(told.raw(4) for _ in range(told.integer()))]
    own = [formats[index] for index in told.list_in_runs(count)]
    codec, parameters = told.text(), dict[str, str]()
    for _ in range(told.integer()):
        name = told.text()
        parameters[name] = read_parameter(told)
    model, header = told.bytes(), told.bytes()
    told.end()
    return Stream(
        frames if frames >= 0 else None, frame_time, bones, own, codec, parameters, model, header
    )


def read_bones(told: Record, joints: list[Joint], count: int) -> list[str]:
    """Take columns; give the bone of each, where they have bones."""
    bones = list[str]()
    form = told.integer()
    if form == 0:
        bones = [joint.name for joint in joints for _ in joint.channels]
    elif form == 1:
        for _ in range(told.integer()):
            bones += [told.text()] * told.integer()
            told.signed()
    elif form == 3:
        for _ in range(told.integer()):
            told.text()
    else:
        for _ in range(count):
            told.text()
        told.list_in_runs(count)
    if form in (1, 2):
        for _ in range(count):
            told.text()
        text_runs(told, count)
    return bones


def text_runs(record: Record, count: int) -> None:
    """Pass ``text runs`` by."""
    while count > 0:
        record.text()
        count -= record.integer()


def read_parameter(record: Record) -> str:
    """Take the value of a parameter, as text."""
    (kind,) = record.raw(1)
    if kind == 0:
        return str(record.signed())
    if kind == 1:
        return repr(record.double())
    return record.text() if kind == 2 else str(record.raw(1)[0])


def read_original(record: Record, file: File) -> None:
    """Take the section about the original file."""
    file.format = record.text()
    record.text()
    file.size, file.digest = record.integer(), record.raw(32)
    for _ in range(record.integer()):
        record.integer()
        record.text()
        record.text()
        record.integer()
        record.integer()
        record.text()
        record.text()
    file.layout = unpacked(record)


def read_chunk(record: Record, file: File, *, needs: bool = False) -> None:
    """Take a chunk; whether it may need others is for the caller to say."""
    flags = record.integer()
    stream = file.streams[flags // 8]
    if flags & (1 if needs else 5):
        raise CorruptError("a chunk that needs others, which no codec of this version makes")
    if record.integer() != sum(chunk.frames for chunk in stream.chunks):
        raise CorruptError("a chunk that does not begin where the one before ends")
    frames = record.integer()
    digest = int.from_bytes(record.raw(4), "little")
    header = record.bytes() if flags & 2 else None
    needed = [record.raw(32) for _ in range(record.integer())] if flags & 4 else []
    payload = record.raw(len(record.data) - record.at)
    stream.chunks.append(Chunk(frames, digest, header, payload, needed))


def check_end(record: Record, chunks: int, start: int, data: bytes) -> None:
    """See that the end fits what stands before it."""
    if record.integer() != chunks:
        raise CorruptError("chunks are missing")
    for _ in range(3):
        record.list_in_runs(chunks)
    for _ in range(chunks):
        record.integer()
    if int.from_bytes(record.raw(4), "little") != len(data) - start:
        raise CorruptError("the end does not stand where it says")


def read_model(data: bytes, name: bytes) -> bytes:
    """Give the payload of a ``.mcm`` of this name."""
    (_, _, header), (_, _, content) = sections(data, b"\x89MCM")
    payload = unpacked(Record(content))
    codec = Record(header).bytes()
    named = b"".join(varint(len(part)) + part for part in (codec, payload))
    if hashlib.sha256(named).digest() != name:
        raise CorruptError("another model than the file names")
    return payload


def varint(number: int) -> bytes:
    """Give an ``int``."""
    text = bytearray()
    while number > 127:
        text.append(number & 127 | 128)
        number >>= 7
    return bytes([*text, number])


def packed(row: list[float]) -> bytes:
    """Give a row as the digest of a chunk sees it."""
    return struct.pack(f"<{len(row)}d", *row)
