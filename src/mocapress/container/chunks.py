"""Chunks and the list of them at a file's end: docs/format.md, sections "Chunk" and "End"."""

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

from mocapress.container import limits
from mocapress.container.sections import CHECKSUM, LEAST
from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer

DISTANCE = 4
_CONTINUES, _OWN_HEADER, _NEEDS, _FLAGS = 1, 2, 4, 8
_DIGEST = 32
_MOST_FRAMES = 2**40


class Entry(NamedTuple):
    """Where a chunk stands, and what it holds."""

    stream: int
    first: int
    """Its first frame."""
    frames: int
    restart: bool
    """Whether decoding may begin here; otherwise it begins at the last chunk before with it."""
    own_header: bool
    """Whether it has a codec header of its own."""
    dependent: bool
    """Whether decoding needs chunks of other clips."""
    begin: int
    """Byte offset of its section."""
    end: int

    @property
    def last(self) -> int:
        """One behind its last frame."""
        return self.first + self.frames


class CodedChunk(NamedTuple):
    """A chunk's content."""

    entry: Entry
    digest: int
    """CRC-32 of the decoded values."""
    header: bytes
    """The codec header that is the chunk's own, or nothing."""
    payload: bytes
    needs: tuple[bytes, ...] = ()
    """Which chunks of other clips decoding needs, by SHA-256."""


def write_chunk(chunk: CodedChunk) -> bytes:
    """Give the content of the section."""
    writer = Writer()
    entry = chunk.entry
    writer.integer(stream_and_flags(entry))
    writer.integer(entry.first)
    writer.integer(entry.frames)
    writer.data += chunk.digest.to_bytes(4, "little")
    if entry.own_header:
        writer.bytes(chunk.header)
    if entry.dependent:
        writer.integer(len(chunk.needs))
        writer.data += b"".join(chunk.needs)
    return bytes(writer.data) + chunk.payload


def read_chunk(content: bytes, begin: int, end: int) -> CodedChunk:
    """Read the content of the section that stands at [begin, end).

    Raises
    ------
    CorruptError
        When it is no chunk.

    """
    reader = Reader(content, "chunk")
    head = reader.integer(_FLAGS * limits.STREAMS - 1)
    first, frames = reader.integer(_MOST_FRAMES), reader.integer(_MOST_FRAMES)
    digest = int.from_bytes(reader.raw(4), "little")
    entry = entry_of(head, first, frames, begin, end)
    header = reader.bytes() if entry.own_header else b""
    needed = reader.count(_DIGEST) if entry.dependent else 0
    needs = tuple(reader.raw(_DIGEST) for _ in range(needed))
    if frames == 0:
        raise CorruptError("a chunk without frames", offset=begin)
    return CodedChunk(entry, digest, header, reader.raw(reader.left), needs)


def write_end(entries: Sequence[Entry]) -> bytes:
    """Give the content of the last section, for chunks in the order of the file."""
    listed = write_list(entries)
    length = len(listed) + DISTANCE
    header = Writer()
    header.integer(length)
    distance = 1 + len(header.data) + length + CHECKSUM
    return listed + distance.to_bytes(DISTANCE, "little")


def write_list(entries: Sequence[Entry]) -> bytes:
    """Give what the last section says of the chunks: all of it but its distance."""
    writer = Writer()
    writer.integer(len(entries))
    writer.runs([stream_and_flags(entry) for entry in entries])
    writer.runs([entry.frames for entry in entries])
    ends = chain([0], (entry.end for entry in entries))
    writer.runs([entry.begin - end for entry, end in zip(entries, ends, strict=False)])
    for entry in entries:
        writer.integer(entry.end - entry.begin)
    return bytes(writer.data)


def read_end(content: bytes, begin: int) -> list[Entry]:
    """Read the content of the last section, which stands at ``begin``.

    Raises
    ------
    CorruptError
        When it is no such section, or chunks would not lie before it.

    """
    reader = Reader(content, "end")
    entries = _read_entries(reader, begin)
    reader.raw(DISTANCE)
    reader.end()
    return entries


def read_list(content: bytes, size: int) -> list[Entry]:
    """Read what ``write_list`` gives for chunks among so many bytes.

    Raises
    ------
    CorruptError
        When it is no such list.

    """
    reader = Reader(content, "list of chunks")
    entries = _read_entries(reader, size)
    reader.end()
    return entries


def _read_entries(reader: Reader, begin: int) -> list[Entry]:
    # Every chunk has a length of at least one byte here, and a section before.
    count = reader.integer(min(reader.left, begin // LEAST))
    heads = reader.runs(count, _FLAGS * limits.STREAMS - 1).tolist()
    frames = reader.runs(count, _MOST_FRAMES).tolist()
    gaps = reader.runs(count, begin).tolist()
    entries: list[Entry] = []
    reached: dict[int, int] = {}
    place = 0
    for head, of_chunk, gap in zip(heads, frames, gaps, strict=True):
        stream, start = head // _FLAGS, place + gap
        place = start + reader.integer(begin)
        if of_chunk == 0 or place - start < LEAST or place > begin:
            raise reader.fail("a chunk without frames, or outside the file")
        first = reached.get(stream, 0)
        reached[stream] = first + of_chunk
        entries.append(entry_of(head, first, of_chunk, start, place))
    return entries


def entry_of(head: int, first: int, frames: int, begin: int, end: int) -> Entry:
    """Make an entry; ``head`` is the first field of its chunk."""
    return Entry(
        head // _FLAGS,
        first,
        frames,
        not head & _CONTINUES,
        bool(head & _OWN_HEADER),
        bool(head & _NEEDS),
        begin,
        end,
    )


def stream_and_flags(entry: Entry) -> int:
    """Give the first field of a chunk."""
    return (
        _FLAGS * entry.stream
        + _CONTINUES * (not entry.restart)
        + _OWN_HEADER * entry.own_header
        + _NEEDS * entry.dependent
    )
