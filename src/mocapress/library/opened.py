"""Clips of a library as compressed files: put together from the tables as far as they are read."""

import sqlite3
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise

import numpy as np

from mocapress.api.opening import Opened, Rows
from mocapress.codecs import Model
from mocapress.container import Damage, Head, Original, unpack
from mocapress.container.chunks import entry_of, write_end
from mocapress.container.head import join_parts
from mocapress.container.limits import UNPACKED, most_values
from mocapress.container.original import read_problems, write_notes, write_original
from mocapress.container.sections import section
from mocapress.container.tags import MAGIC, VERSION, Tag
from mocapress.errors import CorruptError, ParameterError
from mocapress.library.database import Database
from mocapress.library.rows import RUN_COLUMNS, Facts, Run, checksum, hash_of, read_clip
from mocapress.models import Place, load_model
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
        super().__init__(b"", self.facts.name)
        self.sound = checksum(self.facts) == found[1]
        """Whether the row of the clip has the right checksum."""
        if not self.sound and not (salvage and _possible(self.facts)):
            raise CorruptError("the facts have a wrong checksum", file=self.name)
        rows = db.connection.execute(
            "SELECT flags, first, frames, length(section) FROM chunks WHERE clip = ? "
            "ORDER BY number",
            [clip],
        ).fetchall()
        if any(flags < 0 or first < 0 or frames < 1 for flags, first, frames, _ in rows):
            raise CorruptError("damaged: the list of chunks", file=self.name)
        self._front = self._before_chunks()
        self._starts = [*accumulate((row[3] for row in rows), initial=len(self._front))]
        places = pairwise(self._starts)
        entries = [
            entry_of(flags, first, frames, begin, end)
            for (flags, first, frames, _), (begin, end) in zip(rows, places, strict=True)
        ]
        self._end = section(Tag.END, write_end(entries))

    @property
    def size(self) -> int:
        """Number of bytes."""
        return int(self._starts[-1]) + len(self._end)

    def read(self, start: int = 0, stop: int | None = None) -> bytes:
        """Give bytes [start, stop), or as many of them as there are."""
        stop = self.size if stop is None else min(stop, self.size)
        parts = []
        while start < stop:
            begin, part = self._part(start)
            parts.append(part[start - begin : stop - begin])
            start = begin + len(part)
        return parts[0] if len(parts) == 1 else b"".join(parts)

    def _part(self, at: int) -> tuple[int, bytes]:
        """Give the part of the file that holds a byte, and where it begins."""
        number = bisect_right(self._starts, at) - 1
        if number < 0:
            return 0, self._front
        begin = self._starts[number]
        if number == len(self._starts) - 1:
            return begin, self._end
        size = self._starts[number + 1] - begin
        found = b""
        try:
            row = self.db.connection.execute(
                "SELECT section FROM chunks WHERE clip = ? AND number = ?", (self.clip, number)
            ).fetchone()
            found = row[0] if row else b""
        except sqlite3.DatabaseError:
            if not self._salvage:
                raise
        # What cannot be read has a wrong checksum, as it would in a file.
        return begin, found if len(found) == size else bytes(size)

    def _before_chunks(self) -> bytes:
        facts = self.facts
        parts = [MAGIC, bytes([VERSION])]
        if facts.head is not None:
            parts.append(section(Tag.HEAD, join_parts(self._skeleton(), facts.head)))
        if facts.text is not None:
            parts.append(section(Tag.FILE, write_original(self._original(facts.text))))
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

    def _original(self, text: int) -> Original:
        facts = self.facts
        row = self.db.connection.execute(
            "SELECT packed, hash FROM texts WHERE id = ?", [text]
        ).fetchone()
        if row is None or hash_of(row[0]) != row[1]:
            raise CorruptError(f"damaged: row {text} of texts", file=self.name)
        problems = read_problems(Reader(facts.problems or b"\0", "problems"))
        kind = (facts.format or "") if facts.head is not None else ""
        return Original(
            kind, original_name(facts), facts.size or 0, facts.sha256 or b"", problems, row[0]
        )


def _possible(facts: Facts) -> bool:
    """Say whether facts with a wrong checksum are such that a file can be put together."""
    digest = facts.text is None or len(facts.sha256 or b"") == 32
    return digest and (facts.size or 0) >= 0 and facts.frames >= 0


def original_name(facts: Facts) -> str:
    """Give the name of the original without folders, as a ``.mcz`` has it: in UTF-8."""
    file = facts.name.rpartition("/")[2] if facts.file is None else facts.file
    return file.encode(errors="surrogateescape").decode(errors="replace")


class OpenedClip(Opened):
    """A clip of a library: what it has in chunks of its own, and its runs of other clips.

    Parameters
    ----------
    db, clip
        The library, and the clip's id.
    models
        Where models may be that the library lacks.
    salvage
        Whether to go on where something is damaged, and list it in ``damage``.

    Raises
    ------
    CorruptError
        When it is damaged.
    ParameterError
        When there is no such clip.

    """

    def __init__(
        self, db: Database, clip: int, models: Sequence[Place] = (), *, salvage: bool = False
    ) -> None:
        self.db, self.clip = db, clip
        self.stored = StoredMcz(db, clip, salvage=salvage)
        self._others: dict[int, OpenedClip] = {}
        self._given = models
        super().__init__(self.stored, models, salvage=salvage)
        names = {stream.model for stream in self.streams} - {b""}
        kept = [self._kept_model(digest) for digest in sorted(names)]
        self._places = [*models, *(model for model in kept if model is not None)]
        self.runs = [*self._find_runs()]
        self._check_runs()

    @property
    def facts(self) -> Facts:
        """What the library says of the clip."""
        return self.stored.facts

    def _kept_model(self, digest: bytes) -> Model | None:
        row = self.db.connection.execute(
            "SELECT file FROM models WHERE digest = ?", [digest]
        ).fetchone()
        return None if row is None else load_model(row[0])

    def _find_runs(self) -> Iterator[Run]:
        # Where the clip has all its frames itself, nothing else is asked.
        if not self.streams or (len(self.streams) == 1 and super().frames() == self.facts.frames):
            return
        for row in self.db.connection.execute(
            f"SELECT {RUN_COLUMNS} FROM runs WHERE clip = ? ORDER BY stream, first",  # noqa: S608
            [self.clip],
        ):
            yield Run(*row)

    def _check_runs(self) -> None:
        """See that the runs lie one behind the other, before memory is asked for them."""
        fault = CorruptError("damaged: the runs of other clips", file=self.facts.name)
        values = 0
        for index, stream in enumerate(self.streams):
            reached = 0
            for run in self.runs_of(index):
                if run.first < reached or run.frames < 1 or run.source_first < 0:
                    raise fault
                reached = run.first + run.frames
            frames = self.frames(index)
            values += frames * max(len(stream.columns), 1)
            if reached > frames:
                raise fault
        shared = self.runs and values > most_values(self.db.path.stat().st_size)
        unknown = any(run.stream not in range(len(self.streams)) for run in self.runs)
        if shared or unknown:
            raise fault
        if self.streams and self.frames() != self.facts.frames and not self.salvage:
            raise fault

    def runs_of(self, stream: int) -> list[Run]:
        """Give the runs of a stream, in the order of its frames."""
        return [run for run in self.runs if run.stream == stream]

    def whole_source(self) -> "OpenedClip | None":
        """Give the clip whose frames in chunks are all the frames of this one, if there is one."""
        sources = {run.source for run in self.runs}
        if len(sources) != 1:
            return None
        other = self._other(*sources)
        # Decoders go by the columns, too.
        alike = [stream.columns for stream in other.streams] == [
            stream.columns for stream in self.streams
        ]
        whole = [
            Run.whole(index, other.own_frames(index), other.clip)
            for index in range(len(other.streams))
            if other.own_frames(index)
        ]
        nothing_own = not any(self.own_frames(index) for index in range(len(self.streams)))
        return other if alike and nothing_own and whole == self.runs and not other.runs else None

    def own_frames(self, stream: int = 0) -> int:
        """Give how many frames of a stream are in chunks of the clip."""
        return super().frames(stream)

    def own_rows(self, stream: int = 0, first: int = 0, last: int | None = None) -> Rows:
        """Decode frames of a stream that are in chunks of the clip, counted among these."""
        return super().rows(stream, first, last)

    def frames(self, stream: int = 0) -> int:
        """Give how many frames a stream has."""
        return self.own_frames(stream) + sum(run.frames for run in self.runs_of(stream))

    def rows(self, stream: int = 0, first: int = 0, last: int | None = None) -> Rows:
        """Decode frames [first, last) of a stream; see ``Opened.rows``."""
        if not self.runs_of(stream):
            return super().rows(stream, first, last)
        last = self.frames(stream) if last is None else last
        values = np.full((max(last - first, 0), len(self.streams[stream].columns)), np.nan)
        kept = np.zeros(len(values), np.bool_)
        for begin, end, source, source_first in self._pieces(stream):
            start, stop = max(begin, first), min(end, last)
            if start < stop:
                offset = source_first - begin
                rows = self._rows_of(source, stream, start + offset, stop + offset)
                values[start - first : stop - first] = rows.values
                kept[start - first : stop - first] = rows.kept
        return Rows(values, kept)

    def _pieces(self, stream: int) -> list[tuple[int, int, int, int]]:
        """Give all frames in pieces: first, behind the last, whose, and where among these."""
        pieces = []
        reached = own = 0
        end = Run(stream, self.frames(stream), 0, self.clip, 0)
        for run in [*self.runs_of(stream), end]:
            if run.first > reached:
                pieces.append((reached, run.first, self.clip, own))
                own += run.first - reached
            reached = run.first + run.frames
            pieces.append((run.first, reached, run.source, run.source_first))
        return pieces

    def _rows_of(self, clip: int, stream: int, first: int, last: int) -> Rows:
        if clip == self.clip:
            return self.own_rows(stream, first, last)
        other = self._other(clip)
        columns = len(self.streams[stream].columns)
        if (
            stream >= len(other.streams)
            or last > other.own_frames(stream)
            or len(other.streams[stream].columns) != columns
        ):
            raise CorruptError("damaged: a run of frames that are not there", file=self.facts.name)
        seen = len(other.damage)
        rows = other.own_rows(stream, first, last)
        self.damage.extend(
            Damage(f"{where} of clip {other.facts.name}", error)
            for where, error in other.damage[seen:]
        )
        return rows

    def _other(self, clip: int) -> "OpenedClip":
        if clip not in self._others:
            self._others[clip] = OpenedClip(self.db, clip, self._given, salvage=self.salvage)
        return self._others[clip]


def inherited(heir: OpenedClip, other: OpenedClip) -> Head:
    """Give the head of a clip that has the chunks of another for its own."""
    assert heir.mcz.head is not None
    streams = (
        replace(own, frames=coded.frames, codec=coded.codec, model=coded.model, header=coded.header)
        for own, coded in zip(heir.streams, other.streams, strict=True)
    )
    return Head(tuple(streams), heir.mcz.head.skeleton)
