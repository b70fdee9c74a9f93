"""Writing ``.mcz`` files, section by section: docs/format.md."""

from collections.abc import Callable, Mapping

from mocapress.container.chunks import CodedChunk, Entry, write_chunk, write_end
from mocapress.container.head import Head, write_head
from mocapress.container.original import (
    Companion,
    Original,
    write_companion,
    write_notes,
    write_original,
)
from mocapress.container.sections import section
from mocapress.container.tags import MAGIC, VERSION, Tag


class MczWriter:
    """Puts a file together; whatever is complete is given to ``sink`` at once."""

    def __init__(self, sink: Callable[[bytes], object]) -> None:
        self._sink = sink
        self._entries: list[Entry] = []
        self.length = 0
        """Bytes so far."""
        self._put(MAGIC + bytes([VERSION]))

    def head(self, head: Head) -> None:
        """Append the head, which is first where there is one."""
        self._section(Tag.HEAD, write_head(head))

    def original(self, original: Original) -> None:
        """Append the original file's facts and layout."""
        self._section(Tag.FILE, write_original(original))

    def notes(self, notes: Mapping[str, str]) -> None:
        """Append what the owner says about the file."""
        self._section(Tag.NOTES, write_notes(notes))

    def companion(self, companion: Companion) -> None:
        """Append another file that belongs to the original."""
        self._section(Tag.COMPANION, write_companion(companion))

    def chunk(self, chunk: CodedChunk) -> None:
        """Append a chunk; where it stands is filled in."""
        begin = self.length
        self._section(Tag.CHUNK, write_chunk(chunk))
        self._entries.append(chunk.entry._replace(begin=begin, end=self.length))

    def stored_chunk(self, entry: Entry, stored: bytes) -> None:
        """Append the section of a chunk as another file has it."""
        begin = self.length
        self._put(stored)
        self._entries.append(entry._replace(begin=begin, end=self.length))

    def end(self) -> None:
        """Close the file."""
        self._section(Tag.END, write_end(self._entries))

    def _section(self, tag: Tag, content: bytes) -> None:
        self._put(section(tag, content))

    def _put(self, data: bytes) -> None:
        self._sink(data)
        self.length += len(data)
