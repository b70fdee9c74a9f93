"""Whether a library is sound, and what is left of one that is not."""

import hashlib
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from mocapress.api.checking import verify_opened
from mocapress.container import unpack
from mocapress.container.limits import most_companions
from mocapress.errors import CorruptError, LimitError, MissingModelError, MocapressError
from mocapress.library.database import Database
from mocapress.library.index import damaged as damaged_index
from mocapress.library.needs import NEED_COLUMNS, Need
from mocapress.library.opened import OpenedClip
from mocapress.library.rows import RUN_COLUMNS, Connection, Run, hash_of
from mocapress.library.stored import StoredMcz
from mocapress.models import Place

_MOST_LINES = 20
"""Of what SQLite says of a damaged database."""

Places = dict[tuple[int, int], list[range]]
"""Frames of a stream of a clip, among those in its chunks."""
Users = dict[tuple[int, bytes], list[range]]
"""Frames of a clip's chunks that need the frames of a digest."""


class Fault(NamedTuple):
    """Something in a library that is damaged."""

    name: str
    """Of the clip or companion; empty for the database itself."""
    what: str


def survivors(connection: Connection) -> Iterator[tuple[int, str]]:
    """Give ids and names of all clips, as far as they can be found at all, in the order of ids.

    Ids come from the table and from the index of names, so that where one of them is damaged the
    other still knows the clips.
    """
    found: dict[int, str] = {}
    last = 0
    for query in (
        "SELECT id, name FROM clips INDEXED BY sqlite_autoindex_clips_1 ORDER BY name",
        "SELECT id, name FROM clips INDEXED BY sqlite_autoindex_clips_1 ORDER BY name DESC",
        "SELECT id, name FROM clips NOT INDEXED ORDER BY id",
        "SELECT id, name FROM clips NOT INDEXED ORDER BY id DESC",
    ):
        try:
            found.update(connection.execute(query))
        except sqlite3.DatabaseError:
            last = -1
    if last < 0:  # what stands between two damaged pages
        for clip in range(1, max([*found, *_last_ids(connection)]) + 1):
            try:
                row = connection.execute("SELECT name FROM clips WHERE id = ?", [clip]).fetchone()
            except sqlite3.DatabaseError:
                continue
            if row is not None:
                found.setdefault(clip, row[0])
    yield from sorted(found.items())


def _last_ids(connection: Connection) -> list[int]:
    try:
        return [seq for (seq,) in connection.execute("SELECT seq FROM sqlite_sequence")]
    except sqlite3.DatabaseError:
        return [0]


def verify_clip(db: Database, clip: int, name: str, models: Sequence[Place] = ()) -> list[Fault]:
    """Decode all of a clip, and check every checksum and digest.

    Raises
    ------
    MissingModelError
        When the model that it needs is nowhere.

    """
    faults: list[Fault] = []
    with _collecting(faults, name), db.reading():
        opened = OpenedClip(db, clip, models, salvage=True)
        if not opened.stored.sound:
            faults.append(Fault(name, "facts: wrong checksum"))
        for where, error in verify_opened(opened).damage:
            faults.append(Fault(name, f"{where}: {error.what}"))
    return faults


def check(db: Database) -> Iterator[list[Fault]]:
    """Read everything in a library, and check its checksums; nothing is decoded.

    Gives the faults of the database, of each clip, and of the companions, as they are found.
    """
    with db.reading() as connection:
        yield [*_integrity(connection)]
        damaged: Places = {}
        own: dict[tuple[int, int], int] = {}
        users: Users = {}
        clips = [*survivors(connection)]
        for clip, name in clips:
            faults: list[Fault] = []
            with _collecting(faults, name):
                faults += _read(db, clip, name, damaged, own, users)
            yield faults
        names = dict(clips)
        faults = []
        with _collecting(faults, ""):
            faults += _needing(connection, names, damaged, users)
        yield faults
        for clip, name in clips:
            faults = []
            with _collecting(faults, name):
                faults += _of_others(connection, clip, names, damaged, own)
            yield faults
        yield [*_companions(connection)]
        yield [*_index(connection, names)]


@contextmanager
def _collecting(faults: list[Fault], name: str) -> Iterator[None]:
    try:
        yield
    except (MissingModelError, LimitError):  # nothing is wrong with the clip
        raise
    except MocapressError as error:
        faults.append(Fault(name, error.what))
    except sqlite3.DatabaseError as error:
        faults.append(Fault(name, f"cannot be read ({error})"))


def _integrity(connection: Connection) -> Iterator[Fault]:
    """Give what SQLite says of the database's pages."""
    try:
        for (line,) in connection.execute(f"PRAGMA integrity_check({_MOST_LINES})"):
            if line != "ok":
                yield Fault("", line)
    except sqlite3.DatabaseError as error:
        yield Fault("", str(error))


def _read(
    db: Database,
    clip: int,
    name: str,
    damaged: Places,
    own: dict[tuple[int, int], int],
    users: Users,
) -> Iterator[Fault]:
    stored = StoredMcz(db, clip, salvage=True)
    if not stored.sound:
        yield Fault(name, "facts: wrong checksum")
    opened = OpenedClip(db, clip, salvage=True)
    for index in range(len(opened.streams)):
        announced = own[clip, index] = opened.own_frames(index)
        found = sum(entry.frames for entry in opened.mcz.of_stream[index])
        if found != announced:
            yield Fault(name, f"chunks have {found} frames of {announced}")
            damaged.setdefault((clip, index), []).append(range(announced))
    for where, error in opened.damage:
        yield Fault(name, f"{where}: {error.what}")
    for entry in opened.mcz.entries:
        try:
            chunk = opened.mcz.read_chunk(entry)
            for digest in chunk.needs:
                users.setdefault((clip, digest), []).append(range(entry.first, entry.last))
        except MocapressError as error:
            yield Fault(name, error.what)
            damaged.setdefault((clip, entry.stream), []).append(range(entry.first, entry.last))


def _needing(
    connection: Connection, names: dict[int, str], damaged: Places, users: Users
) -> Iterator[Fault]:
    """Name the chunks that are predicted from damaged frames, and those predicted from these."""
    if not users:  # libraries of version 1 have no such table
        return
    rows = connection.execute(f"SELECT clip, {NEED_COLUMNS} FROM needs").fetchall()  # noqa: S608
    waiting = [(clip, Need(*row)) for clip, *row in rows if clip in names]
    found = True
    while found:
        found, left = False, []
        for clip, need in waiting:
            begin, end = need.source_first, need.source_first + need.frames
            lost = damaged.get((need.source, need.stream), [])
            if not any(r.start < end and r.stop > begin for r in lost):
                left.append((clip, need))
                continue
            found = True
            other = names.get(need.source, f"of id {need.source}")
            for frames in users.get((clip, need.digest), []):
                damaged.setdefault((clip, need.stream), []).append(frames)
                told = f"chunk of frames {frames.start} to {frames.stop - 1}"
                yield Fault(names[clip], f"{told} needs frames of clip {other}, which is damaged")
        waiting = left


def _of_others(
    connection: Connection,
    clip: int,
    names: dict[int, str],
    damaged: Places,
    own: dict[tuple[int, int], int],
) -> Iterator[Fault]:
    """Name the frames of a clip that are damaged in another."""
    for row in connection.execute(
        f"SELECT {RUN_COLUMNS} FROM runs WHERE clip = ?",  # noqa: S608
        [clip],
    ).fetchall():
        run = Run(*row)
        begin, end = run.source_first, run.source_first + run.frames
        place = run.source, run.stream
        lost = any(r.start < end and r.stop > begin for r in damaged.get(place, []))
        if lost or end > own.get(place, 0):
            other = names.get(run.source, f"of id {run.source}")
            frames = f"frames {run.first} to {run.first + run.frames - 1}"
            yield Fault(names[clip], f"{frames} are those of clip {other}, which is damaged")


def _companions(connection: Connection) -> Iterator[Fault]:
    try:
        for name, size, sha256, packed, wanted in connection.execute(
            "SELECT name, size, sha256, packed, hash FROM companions "
            "LEFT JOIN texts ON texts.id = companions.text"
        ):
            if packed is None or hash_of(packed) != wanted:
                yield Fault(name, "the companion is damaged")
                continue
            data = unpack(packed, "companion", min(size, most_companions(len(packed))))
            if hashlib.sha256(data).digest() != sha256:
                yield Fault(name, "the companion is damaged")
    except (sqlite3.DatabaseError, CorruptError) as error:
        yield Fault("", f"companions cannot be read ({error})")


def _index(connection: Connection, names: dict[int, str]) -> Iterator[Fault]:
    try:
        for clip, what in damaged_index(connection):
            yield Fault(names.get(clip, ""), what)
    except sqlite3.DatabaseError as error:
        yield Fault("", f"the index for search cannot be read ({error})")
