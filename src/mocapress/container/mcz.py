"""Writing and reading ``.mcz`` files, as docs/format.md lays them down."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from mocapress.container.sections import read_magic, read_section, section
from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer

MAGIC = b"\x89MCZ"
VERSION = 1
_HEADER, _LAYOUT, _SKELETON, _INDEX = range(1, 5)


class Kind(IntEnum):
    """What kind of file is inside."""

    BYTES = 0
    AMC = 1
    BVH = 2


class Entry(NamedTuple):
    """A chunk in the index."""

    frames: int
    length: int
    restart: bool
    crc: int


@dataclass(frozen=True, slots=True)
class Mcz:
    """A parsed file: the sections' contents, and the payloads where they lie."""

    kind: Kind
    size: int
    """Of the original file, bytes."""
    digest: bytes
    """SHA-256 of the original file."""
    frames: int
    columns: int
    codec: str
    model: bytes
    codec_header: bytes
    layout: bytes
    """Packed; empty in kind ``BYTES``."""
    skeleton: bytes
    """Packed; empty where there is none."""
    index: tuple[Entry, ...]
    data: memoryview
    """The whole file."""
    begin: int
    """Where the payloads begin."""

    def chunk_range(self, first: int, last: int) -> tuple[int, int, int]:
        """Find the chunks that decoding frames [first, last) needs.

        Returns
        -------
        tuple
            Index of the first such chunk, one behind the last, and the first one's first frame.

        """
        start = stop = start_frame = frame = 0
        for i, entry in enumerate(self.index):
            if entry.restart and frame <= first:
                start, start_frame = i, frame
            frame += entry.frames
            if frame >= last:
                stop = i + 1
                break
        return start, max(stop, start), start_frame

    def payload(self, chunk: int) -> bytes:
        """Give one chunk's payload.

        Raises
        ------
        CorruptError
            When its checksum is wrong.

        """
        begin = self.begin + sum(entry.length for entry in self.index[:chunk])
        entry = self.index[chunk]
        payload = bytes(self.data[begin : begin + entry.length])
        if zlib.crc32(payload) != entry.crc:
            raise CorruptError(
                f"chunk {chunk}: wrong checksum",
                offset=begin,
                expected=f"{entry.crc:08x}",
                found=f"{zlib.crc32(payload):08x}",
            )
        return payload


def pack_file(
    *,
    kind: Kind,
    size: int,
    digest: bytes,
    payloads: Sequence[tuple[int, bool, bytes]],
    columns: int = 0,
    codec: str = "",
    model: bytes = b"",
    codec_header: bytes = b"",
    layout: bytes = b"",
    skeleton: bytes = b"",
) -> bytes:
    """Make a file; ``payloads`` are (frames, restart, payload), layout and skeleton packed."""
    header = Writer()
    header.integer(kind)
    header.integer(size)
    header.data += digest
    header.integer(sum(frames for frames, _, _ in payloads))
    header.integer(columns)
    header.bytes(codec.encode())
    header.bytes(model)
    header.bytes(codec_header)
    index = Writer()
    index.integer(len(payloads))
    for frames, restart, payload in payloads:
        index.integer(frames)
        index.integer(len(payload))
        index.data.append(restart)
        index.data += zlib.crc32(payload).to_bytes(4, "little")
    parts = [MAGIC, bytes([VERSION]), section(_HEADER, bytes(header.data))]
    if layout:
        parts.append(section(_LAYOUT, layout))
    if skeleton:
        parts.append(section(_SKELETON, skeleton))
    parts.append(section(_INDEX, bytes(index.data)))
    return b"".join(parts + [payload for _, _, payload in payloads])


def parse(data: bytes | memoryview) -> Mcz:
    """Read a file's sections; payloads are checked when they are taken.

    Raises
    ------
    CorruptError
        When the data is not a ``.mcz`` file, or a damaged one.
    UnsupportedError
        When it is of a later version.

    """
    data = memoryview(data)
    reader = Reader(data, "file")
    read_magic(reader, MAGIC, VERSION, ".mcz")
    sections: dict[int, bytes] = {}
    while _INDEX not in sections:
        number, content = read_section(reader, _INDEX)
        if number <= max(sections, default=0):
            raise reader.fail(f"section {number} in the wrong place")
        sections[number] = content
    if _HEADER not in sections:
        raise reader.fail("no header section")
    mcz = _read_header(sections, data, reader.position)
    length = sum(entry.length for entry in mcz.index)
    if mcz.begin + length != len(data):
        raise CorruptError(
            "wrong length of the file",
            offset=len(data),
            expected=f"{mcz.begin + length} bytes",
            found=f"{len(data)}",
        )
    if mcz.frames * max(mcz.columns, 1) > 2**24 + 512 * length:
        raise CorruptError(f"{mcz.frames} x {mcz.columns} values in {length} bytes")
    if mcz.size > 2**28 + 2**14 * len(data):
        raise CorruptError(f"{mcz.size} bytes announced in a file of {len(data)}")
    return mcz


def _read_header(sections: dict[int, bytes], data: memoryview, begin: int) -> Mcz:
    header = Reader(sections[_HEADER], "header")
    kind = Kind(header.integer(max(Kind)))
    size, digest = header.integer(), header.raw(32)
    frames, columns = header.integer(), header.integer(2**20)
    try:
        codec = header.bytes().decode()
    except UnicodeDecodeError:
        raise header.fail("codec is not text") from None
    model, codec_header = header.bytes(), header.bytes()
    header.end()
    if (kind is Kind.BYTES) == (_LAYOUT in sections) or len(model) not in (0, 32):
        raise header.fail("sections do not fit the kind of file")
    index = Reader(sections[_INDEX], "index")
    entries = []
    for _ in range(index.count(7)):
        entry_frames, length, flags = index.integer(), index.integer(), index.integer(1)
        crc = int.from_bytes(index.raw(4), "little")
        entries.append(Entry(entry_frames, length, bool(flags), crc))
    index.end()
    if sum(entry.frames for entry in entries) != frames or (entries and not entries[0].restart):
        raise index.fail("chunks do not make up the clip")
    if kind is Kind.BYTES and len(entries) != 1:
        raise index.fail("not one chunk")
    return Mcz(
        kind,
        size,
        digest,
        frames,
        columns,
        codec,
        model,
        codec_header,
        sections.get(_LAYOUT, b""),
        sections.get(_SKELETON, b""),
        tuple(entries),
        data,
        begin,
    )
