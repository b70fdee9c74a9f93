"""The ``.mcz`` of a clip in a library: put together from the tables as far as it is read."""

import sqlite3
from functools import cached_property

from mocapress.container import Entry, Original, unpack
from mocapress.container.chunks import read_list, write_end
from mocapress.container.head import join_parts
from mocapress.container.limits import UNPACKED, most_layout
from mocapress.container.original import read_problems, write_notes, write_original
from mocapress.container.packing import stored
from mocapress.container.sections import section
from mocapress.container.tags import MAGIC, VERSION, Tag
from mocapress.errors import CorruptError, ParameterError
from mocapress.library.chunks import Chunks
from mocapress.library.database import Database
from mocapress.library.rows import Facts, checksum, hash_of, read_clip, sample_of
from mocapress.records import Reader
from mocapress.source import Source


class StoredMcz(Source):
    """The ``.mcz`` that holds a clip's own chunks; each chunk is read when it is asked for.

    Parameters
    ----------
    db, clip
        The library, and the clip's id.
    salvage
        Whether chunks that cannot be read, and a wrong checksum of the clip's facts, are left to
        be found as damage.

    Raises
    ------
    CorruptError
        When it cannot be read.
    ParameterError
        When there is no such clip.

    """

    def __init__(self, db: Database, clip: int, *, salvage: bool = False) -> None:
        self.db, self.clip, self._salvage = db, clip, salvage
        found = read_clip(db.connection, clip)
        if found is None:
            raise ParameterError("no such clip", file=str(db.path), found=f"id {clip}")
        self.facts: Facts = found[0]
        super().__init__(b"", self.facts.name, limit=db.limit)
        self.sound = checksum(self.facts) == found[1]
        """Whether the row of the clip has the right checksum."""
        if not self.sound and not salvage:
            raise CorruptError("the facts have a wrong checksum", file=self.name)
        if not _possible(self.facts):
            raise CorruptError("the facts cannot be", file=self.name)
        self._front = self._before_chunks()
        self._chunks = Chunks(db, clip, salvage=salvage)
        start = len(self._front)
        self._behind = start + self._chunks.size
        entries = [
            entry._replace(begin=start + entry.begin, end=start + entry.end)
            for entry in self._listed()
        ]
        self._end = section(Tag.END, write_end(entries))

    def _listed(self) -> list[Entry]:
        try:
            return read_list(self._chunks.listed, self._chunks.size)
        except CorruptError as error:
            raise CorruptError("damaged: the list of chunks", file=self.name) from error

    @property
    def size(self) -> int:
        """Number of bytes."""
        return self._behind + len(self._end)

    def read(self, start: int = 0, stop: int | None = None) -> bytes:
        """Give bytes [start, stop), or as many of them as there are."""
        stop = self.size if stop is None else min(stop, self.size)
        front, behind = len(self._front), self._behind
        parts = [self._front[start:stop]]
        if start < behind and stop > front:
            parts.append(self._chunks.read(max(start - front, 0), min(stop, behind) - front))
        if stop > behind:
            parts.append(self._end[max(start - behind, 0) : stop - behind])
        return b"".join(parts)

    def _before_chunks(self) -> bytes:
        facts = self.facts
        parts = [MAGIC, bytes([VERSION])]
        if facts.head is not None:
            parts.append(section(Tag.HEAD, join_parts(self._skeleton(), self._streams(facts.head))))
        packed = self._text()
        if packed is not None:
            parts.append(section(Tag.FILE, write_original(self._original(packed))))
        notes = self._notes()
        if notes:
            parts.append(section(Tag.NOTES, write_notes(notes)))
        return b"".join(parts)

    def _notes(self) -> dict[str, str]:
        try:
            return dict(
                self.db.connection.execute(
                    "SELECT key, value FROM notes WHERE clip = ? ORDER BY key", [self.clip]
                )
            )
        except sqlite3.DatabaseError:
            if not self._salvage:
                raise
            return {}

    def _skeleton(self) -> bytes | None:
        if self.facts.skeleton is None:
            return None
        number = self.facts.skeleton
        row = self.db.connection.execute(
            "SELECT record, hash FROM skeletons WHERE id = ?", [number]
        ).fetchone()
        record = b"" if row is None else unpack(row[0], "skeleton", UNPACKED)
        if row is None or hash_of(record) != row[1]:
            raise CorruptError(f"damaged: row {number} of skeletons", file=self.name)
        return record

    def _streams(self, packed: bytes) -> bytes:
        return unpack(packed, "head", UNPACKED, beside=self._sample)

    @cached_property
    def _sample(self) -> bytes:
        try:
            return sample_of(self.db.connection, self.facts.skeleton)
        except CorruptError as error:
            raise CorruptError(error.what, file=self.name) from error

    def _text(self) -> bytes | None:
        """Give the layout, or a file that is no motion, packed."""
        facts = self.facts
        if facts.layout is not None:
            most = most_layout(facts.size or 0, len(facts.layout) + len(self._sample))
            return stored(unpack(facts.layout, "layout", most, beside=self._sample))
        if facts.text is None:
            return None
        row = self.db.connection.execute(
            "SELECT packed, hash FROM texts WHERE id = ?", [facts.text]
        ).fetchone()
        if row is None or hash_of(row[0]) != row[1]:
            raise CorruptError(f"damaged: row {facts.text} of texts", file=self.name)
        packed: bytes = row[0]
        return packed

    def _original(self, packed: bytes) -> Original:
        facts = self.facts
        problems = read_problems(Reader(facts.problems or b"\0", "problems"))
        kind = (facts.format or "") if facts.head is not None else ""
        return Original(
            kind, original_name(facts), facts.size or 0, facts.sha256 or b"", problems, packed
        )


def _possible(facts: Facts) -> bool:
    """Say whether facts are such that a file can be put together."""
    digest = (facts.text is None and facts.layout is None) or len(facts.sha256 or b"") == 32
    return digest and (facts.size or 0) >= 0 and facts.frames >= 0


def original_name(facts: Facts) -> str:
    """Give the name of the original without folders, as a ``.mcz`` has it: in UTF-8."""
    file = facts.name.rpartition("/")[2] if facts.file is None else facts.file
    return file.encode(errors="surrogateescape").decode(errors="replace")
