"""Reading ``.mcz`` files, as docs/format.md lays them down."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from mocapress.container import limits
from mocapress.container.chunks import DISTANCE, CodedChunk, Entry, read_chunk, read_end
from mocapress.container.head import Head, read_head
from mocapress.container.original import (
    Companion,
    Original,
    read_companion,
    read_notes,
    read_original,
)
from mocapress.container.sections import (
    CHECKSUM,
    LEAST,
    MAY_BE_SKIPPED,
    Section,
    checked,
    next_section,
    read_magic,
)
from mocapress.container.tags import MAGIC, VERSION, Tag
from mocapress.errors import CorruptError, MocapressError, UnsupportedError
from mocapress.records import Ranges, Reader

_BEGIN = len(MAGIC) + 1
_FRONT = 2**14
"""Bytes that are read first; mostly all that stands before the chunks is in them."""


class Damage(NamedTuple):
    """Something in a file that cannot be read."""

    where: str
    error: MocapressError


@dataclass(slots=True)
class Mcz:
    """A file, opened: all but its chunks is read."""

    ranges: Ranges
    size: int
    head: Head | None = None
    """None of a file that is no motion."""
    head_content: bytes = b""
    """The section that ``head`` was read from."""
    original: Original | None = None
    """None where there is no original file."""
    notes: dict[str, str] = field(default_factory=dict)
    companions: list[Companion] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    """All chunks, in the order of the file."""
    of_stream: list[list[Entry]] = field(default_factory=list)
    """The chunks of each stream, in the order of their frames."""
    closed: bool = True
    """Whether the file has its end; a recording that was killed has none."""
    damage: list[Damage] = field(default_factory=list)
    """What could not be read; empty unless the file was opened to be salvaged."""

    def frames(self, stream: int = 0) -> int:
        """Give how many frames a stream has."""
        announced = self.head.streams[stream].frames if self.head else 0
        if announced is not None:
            return announced
        return self.of_stream[stream][-1].last if self.of_stream[stream] else 0

    def read_chunk(self, entry: Entry) -> CodedChunk:
        """Read a chunk.

        Raises
        ------
        CorruptError
            When it is damaged, or not the one that the file's end announces.

        """
        where = f"chunk of frames {entry.first} to {entry.last - 1}"
        reader = Reader(_whole(self.ranges, entry.begin, entry.end), where)
        found = next_section(reader, entry.begin)
        reader.end()
        chunk = read_chunk(checked(found, where), entry.begin, entry.end)
        if found.tag != Tag.CHUNK or chunk.entry != entry:
            raise CorruptError(f"{where}: another section stands here", offset=entry.begin)
        return chunk


def open_mcz(ranges: Ranges, *, salvage: bool = False) -> Mcz:
    """Read a file's sections up to the chunks, and where these are.

    Parameters
    ----------
    ranges
        The file.
    salvage
        Whether to go on where something is damaged and list it, as far as there is a head or an
        original.

    Raises
    ------
    CorruptError
        When the data is not a ``.mcz`` file, or a damaged one.
    UnsupportedError
        When it is of a later version, or has a section that this version must know and does not.

    """
    size = ranges.size
    front = _whole(ranges, 0, min(size, _FRONT))
    read_magic(Reader(front, "file"), MAGIC, VERSION, "not compressed by mocapress")
    mcz = Mcz(ranges, size)
    collect = _Collector(mcz, salvage)
    end = _find_end(ranges, size)
    if end is None:
        _walk(mcz, collect)
    else:
        try:
            mcz.entries = read_end(end.content, end.begin)
        except CorruptError as error:
            collect.damaged("end", error)
            _walk(mcz, collect)
        else:
            _read_between(mcz, collect, front, end)
    if mcz.head is None and mcz.original is None:
        raise CorruptError(
            "nothing in this file can be read" if salvage else "neither head nor file section"
        )
    _check(mcz, collect)
    return mcz


class _Collector:
    """Takes the sections beside chunks, in the order of the file."""

    def __init__(self, mcz: Mcz, salvage: bool) -> None:
        self.mcz, self.salvage = mcz, salvage
        self.seen: set[int] = set()

    def damaged(self, where: str, error: MocapressError) -> None:
        """List what is damaged, or raise it."""
        if not self.salvage:
            raise error
        self.mcz.damage.append(Damage(where, error))

    def take(self, section: Section, *, chunks_before: bool) -> None:
        """Read a section."""
        name = _name(section.tag)
        try:
            content = checked(section, f"section {name}")
            if section.tag in self.seen and section.tag != Tag.COMPANION:
                raise CorruptError(f"a second section {name}", offset=section.begin)
            self.seen.add(section.tag)
            self._read(section.tag, content, section.begin, chunks_before=chunks_before)
        except MocapressError as error:
            self.damaged(f"section {name} at byte {section.begin}", error)

    def _read(self, tag: int, content: bytes, begin: int, *, chunks_before: bool) -> None:
        mcz = self.mcz
        must_know = not tag & MAY_BE_SKIPPED
        if must_know and (chunks_before or (tag == Tag.HEAD and mcz.original)):
            raise CorruptError(f"section {_name(tag)} in the wrong place", offset=begin)
        if tag == Tag.HEAD:
            mcz.head, mcz.head_content = read_head(content), content
        elif tag == Tag.FILE:
            mcz.original = read_original(content, mcz.size)
        elif tag == Tag.NOTES:
            mcz.notes = read_notes(content)
        elif tag == Tag.COMPANION:
            room = limits.most_companions(mcz.size) - sum(len(c.data) for c in mcz.companions)
            mcz.companions.append(read_companion(content, room))
        elif must_know:
            raise UnsupportedError(
                f"section {_name(tag)} is not known to this version of mocapress", offset=begin
            )


def _find_end(ranges: Ranges, size: int) -> Section | None:
    """Find the last section by the file's last bytes; None where there is none."""
    tail = ranges.read(max(size - DISTANCE - CHECKSUM, 0), size)
    distance = int.from_bytes(tail[:DISTANCE], "little")
    if not LEAST + DISTANCE < distance <= size - _BEGIN:
        return None
    try:
        reader = Reader(_whole(ranges, size - distance, size), "end")
        found = next_section(reader, size - distance)
        reader.end()
    except CorruptError:
        return None
    return found if found.tag == Tag.END and found.sound else None


def _read_between(mcz: Mcz, collect: _Collector, front: bytes, end: Section) -> None:
    """Read the sections before, between and behind the chunks."""
    begin, chunks_before = _BEGIN, False
    for begin_of_next, end_of_next in [*((e.begin, e.end) for e in mcz.entries), (end.begin, 0)]:
        if begin_of_next > begin or begin == _BEGIN:
            held = begin_of_next <= len(front)
            part = front[begin:begin_of_next] if held else _whole(mcz.ranges, begin, begin_of_next)
            reader = Reader(part, "file")
            try:
                while reader.left:
                    collect.take(next_section(reader, begin), chunks_before=chunks_before)
            except CorruptError as error:
                collect.damaged(f"what stands at byte {begin + reader.position}", error)
        begin, chunks_before = end_of_next, True


def _walk(mcz: Mcz, collect: _Collector) -> None:
    """Go from section to section, where the file's end is missing or damaged."""
    mcz.closed = False
    data = _whole(mcz.ranges, _BEGIN, mcz.size)
    for section in _sections(data, collect):
        if section.tag == Tag.CHUNK:
            try:
                content = checked(section, "chunk")
                mcz.entries.append(read_chunk(content, section.begin, section.end).entry)
            except CorruptError as error:
                collect.damaged(f"chunk at byte {section.begin}", error)
        elif section.tag == Tag.END:
            if section.end < mcz.size:
                behind = CorruptError("bytes behind the end of the file", offset=section.end)
                collect.damaged("what follows", behind)
            break
        else:
            collect.take(section, chunks_before=bool(mcz.entries))


def _sections(data: bytes, collect: _Collector) -> Iterator[Section]:
    """Give whole sections; what is cut off at the end is none."""
    reader = Reader(data, "file")
    while reader.left:
        start = reader.position
        try:
            section = next_section(reader, _BEGIN)
        except CorruptError:
            return
        torn = not section.sound and (not reader.left or not any(data[start:]))
        if torn:
            return
        if not section.sound and data[reader.position] not in set(Tag):
            error = CorruptError("no section", offset=section.begin)
            collect.damaged(f"what stands at byte {section.begin} and behind", error)
            return
        yield section


def _check(mcz: Mcz, collect: _Collector) -> None:
    """See that streams, chunks and announcements fit each other."""
    streams = mcz.head.streams if mcz.head else ()
    recording = bool(streams) and not mcz.original and all(s.frames is None for s in streams)
    if not mcz.closed and not recording:
        error = CorruptError(
            "the file is cut off, or its end has a wrong checksum", offset=mcz.size
        )
        collect.damaged("end", error)
    if mcz.head is None and (mcz.entries or (mcz.original and mcz.original.format)):
        collect.damaged("head", CorruptError("a motion file without a head"))
    mcz.of_stream = [[] for _ in streams]
    for entry in mcz.entries:
        _place(mcz, entry, collect)
    values = 0
    for index, stream in enumerate(streams):
        values += mcz.frames(index) * max(len(stream.columns), 1)
        reached = mcz.of_stream[index][-1].last if mcz.of_stream[index] else 0
        # What is missing of a file that is salvaged shows when its frames are asked for.
        if stream.frames not in (None, reached) and not collect.salvage:
            raise CorruptError(
                f"chunks of stream {stream.name!r}",
                expected=f"{stream.frames} frames",
                found=str(reached),
            )
    limits.check_values(values, mcz.size)


def _place(mcz: Mcz, entry: Entry, collect: _Collector) -> None:
    """Add a chunk to its stream, where it follows those before it."""
    if entry.stream >= len(mcz.of_stream):
        error = CorruptError("a chunk of no stream", offset=entry.begin)
        collect.damaged(f"chunk at byte {entry.begin}", error)
        return
    before = mcz.of_stream[entry.stream]
    expected = before[-1].last if before else 0
    if entry.first < expected or (entry.first > expected and not collect.salvage):
        error = CorruptError(
            "chunks in the wrong order",
            offset=entry.begin,
            expected=f"frame {expected}",
            found=str(entry.first),
        )
        collect.damaged(f"chunk at byte {entry.begin}", error)
    if not before and not entry.restart and not collect.salvage:
        error = CorruptError("a first chunk that needs one before", offset=entry.begin)
        collect.damaged(f"chunk at byte {entry.begin}", error)
    if entry.first >= expected:
        before.append(entry)


def _name(tag: int) -> str:
    return Tag(tag).name.lower() if tag in set(Tag) else f"{tag:02x}"


def _whole(ranges: Ranges, start: int, stop: int) -> bytes:
    data = ranges.read(start, stop)
    if len(data) != stop - start:
        raise CorruptError(
            "the file became shorter while it was read",
            offset=start + len(data),
            expected=f"{stop - start} bytes at byte {start}",
            found=str(len(data)),
        )
    return data
