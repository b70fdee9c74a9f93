"""The tables of a library: docs/format/library.md."""

import re
import sqlite3
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import NamedTuple

from mocapress.errors import CorruptError, UnsupportedError
from mocapress.version import __version__

APPLICATION_ID = 0x4D435A4C
PAGE = 1024
"""Bytes of a page."""
_HEADER_WRITE, _HEADER_READ, _WAL = 18, 19, 2
"""Where a database's header says how its journal is kept, and what it says there."""

_TABLES = """
CREATE TABLE migrations(version INTEGER PRIMARY KEY, name TEXT NOT NULL, applied TEXT NOT NULL,
    program TEXT NOT NULL) STRICT;
CREATE TABLE texts(id INTEGER PRIMARY KEY, hash INTEGER NOT NULL, packed BLOB NOT NULL) STRICT;
CREATE TABLE skeletons(id INTEGER PRIMARY KEY, name TEXT NOT NULL, joints INTEGER NOT NULL,
    hash INTEGER NOT NULL, record BLOB NOT NULL) STRICT;
CREATE TABLE models(id INTEGER PRIMARY KEY, digest BLOB NOT NULL UNIQUE, codec TEXT NOT NULL,
    file BLOB NOT NULL) STRICT;
CREATE TABLE clips(id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL UNIQUE, format TEXT,
    file TEXT, frames INTEGER NOT NULL, channels INTEGER NOT NULL, frame_time REAL, size INTEGER,
    sha256 BLOB, modified INTEGER, skeleton INTEGER REFERENCES skeletons,
    text INTEGER REFERENCES texts, codec TEXT, head BLOB, problems BLOB,
    checksum INTEGER NOT NULL) STRICT;
CREATE TABLE chunks(clip INTEGER PRIMARY KEY REFERENCES clips, list BLOB NOT NULL,
    sections BLOB NOT NULL) STRICT;
CREATE TABLE runs(clip INTEGER NOT NULL REFERENCES clips, stream INTEGER NOT NULL,
    first INTEGER NOT NULL, frames INTEGER NOT NULL, source INTEGER NOT NULL REFERENCES clips,
    source_first INTEGER NOT NULL, PRIMARY KEY(clip, stream, first)) STRICT, WITHOUT ROWID;
CREATE TABLE companions(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, format TEXT NOT NULL,
    size INTEGER NOT NULL, sha256 BLOB NOT NULL, modified INTEGER,
    text INTEGER NOT NULL REFERENCES texts) STRICT;
CREATE TABLE belongs(clip INTEGER NOT NULL REFERENCES clips,
    companion INTEGER NOT NULL REFERENCES companions,
    PRIMARY KEY(clip, companion)) STRICT, WITHOUT ROWID;
CREATE TABLE labels(clip INTEGER NOT NULL REFERENCES clips, label TEXT NOT NULL,
    PRIMARY KEY(clip, label)) STRICT, WITHOUT ROWID;
CREATE TABLE notes(clip INTEGER NOT NULL REFERENCES clips, key TEXT NOT NULL, value TEXT NOT NULL,
    PRIMARY KEY(clip, key)) STRICT, WITHOUT ROWID;
CREATE TABLE anchors(clip INTEGER PRIMARY KEY REFERENCES clips, hashes BLOB NOT NULL) STRICT;
CREATE INDEX texts_by_hash ON texts(hash);
CREATE INDEX clips_by_skeleton ON clips(skeleton);
CREATE INDEX clips_by_text ON clips(text);
CREATE INDEX runs_by_source ON runs(source);
CREATE INDEX companions_by_text ON companions(text);
CREATE INDEX belongs_by_companion ON belongs(companion);
CREATE INDEX labels_by_label ON labels(label);
CREATE VIEW catalogue AS SELECT clips.name AS name, format, frames, channels,
    frames * frame_time AS seconds, 1 / frame_time AS rate, skeletons.name AS skeleton,
    (SELECT group_concat(label, ',') FROM labels WHERE labels.clip = clips.id) AS labels, size,
    coalesce((SELECT length(sections) FROM chunks WHERE chunks.clip = clips.id), 0) AS stored,
    codec, lower(hex(sha256)) AS sha256, datetime(modified / 1000000000, 'unixepoch') AS modified
    FROM clips LEFT JOIN skeletons ON skeletons.id = clips.skeleton;
"""


class Migration(NamedTuple):
    """What makes a version of the schema of the one before."""

    name: str
    statements: Sequence[str]


def _statements(text: str) -> list[str]:
    return [part.strip() for part in text.split(";\n") if part.strip()]


_NEEDS = """
CREATE TABLE needs(clip INTEGER NOT NULL REFERENCES clips, digest BLOB NOT NULL,
    stream INTEGER NOT NULL, source INTEGER NOT NULL REFERENCES clips,
    source_first INTEGER NOT NULL, frames INTEGER NOT NULL,
    PRIMARY KEY(clip, digest)) STRICT, WITHOUT ROWID;
CREATE INDEX needs_by_source ON needs(source);
"""

_SEARCH = """
CREATE TABLE signatures(clip INTEGER PRIMARY KEY REFERENCES clips ON DELETE CASCADE,
    version INTEGER NOT NULL, signature BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE features(clip INTEGER PRIMARY KEY REFERENCES clips ON DELETE CASCADE,
    checksum INTEGER NOT NULL, rows BLOB NOT NULL) STRICT;
"""

_SETTINGS = """
CREATE TABLE settings(name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
"""

_ALIKE = """
ALTER TABLE skeletons ADD COLUMN sample BLOB;
ALTER TABLE clips ADD COLUMN layout BLOB;
DROP INDEX clips_by_text;
CREATE INDEX clips_by_text ON clips(text) WHERE text IS NOT NULL;
DROP INDEX companions_by_text;
DROP INDEX belongs_by_companion;
DROP INDEX labels_by_label;
"""

SEARCH = 3
"""The first version of the schema that has an index for search."""
SETTINGS = 4
"""The first version of the schema that has settings."""
ALIKE = 5
"""The first version of the schema in which clips are packed beside a sample of their skeleton."""
NO_INDEX = ("index", "no")
"""The setting of a library whose clips are not indexed for search when they are added."""
MIGRATIONS = [
    Migration("create", _statements(_TABLES)),
    Migration("needs", _statements(_NEEDS)),
    Migration("search", _statements(_SEARCH)),
    Migration("settings", _statements(_SETTINGS)),
    Migration("alike", _statements(_ALIKE)),
]
"""Version n of the schema is what the first n of them make."""


def empty(*, indexed: bool = True) -> bytes:
    """Give the contents of a library without clips; see ``NO_INDEX``."""
    connection = sqlite3.connect(":memory:", isolation_level=None)
    try:
        connection.execute(f"PRAGMA page_size = {PAGE}")
        migrate(connection)
        if not indexed:
            connection.execute("INSERT INTO settings VALUES(?, ?)", NO_INDEX)
        connection.execute("VACUUM")
        data = bytearray(connection.serialize())
    finally:
        connection.close()
    data[_HEADER_WRITE] = data[_HEADER_READ] = _WAL
    return bytes(data)


def migrate(connection: sqlite3.Connection) -> None:
    """Bring a database to the newest version, all at once or not at all."""
    if version_of(connection) == len(MIGRATIONS):
        return
    connection.execute("BEGIN IMMEDIATE")
    try:
        reached = version_of(connection)  # another process may have been quicker
        for version, migration in enumerate(MIGRATIONS[reached:], reached + 1):
            for statement in migration.statements:
                connection.execute(statement)
            now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S")
            connection.execute(
                "INSERT INTO migrations VALUES(?, ?, ?, ?)",
                (version, migration.name, now, f"mocapress {__version__}"),
            )
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {len(MIGRATIONS)}")
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


def version_of(connection: sqlite3.Connection) -> int:
    """Give the version of a database's schema."""
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    return version


def _made_by(migrations: Sequence[Migration]) -> set[str]:
    """Give what ``sqlite_schema`` says of all that migrations made."""
    made: dict[str, str] = {}
    for statement in (each for migration in migrations for each in migration.statements):
        does, _, name = re.split(r"[ (]", statement)[:3]
        if does == "CREATE":
            made[name] = statement
        elif does == "DROP":
            del made[name]
        else:
            column = statement.partition(" ADD COLUMN ")[2]
            made[name] = made[name].replace(") STRICT", f", {column}) STRICT")
    return {*made.values()}


def check(connection: sqlite3.Connection, file: str) -> None:
    """See that a database is a library that this version can read.

    The tables have to be those of the version to the letter, and there may be no triggers: a file
    from elsewhere must not make anything happen.

    Raises
    ------
    CorruptError
        When it is no library.
    UnsupportedError
        When it is one of a later version.

    """
    found = connection.execute("PRAGMA application_id").fetchone()[0]
    if found != APPLICATION_ID:
        raise CorruptError(
            "not a library",
            file=file,
            expected=f"application id {APPLICATION_ID:08x}",
            found=f"{found & 0xFFFFFFFF:08x}",
        )
    version = version_of(connection)
    if not 1 <= version <= len(MIGRATIONS):
        raise UnsupportedError(
            "version of the library", file=file, expected=str(len(MIGRATIONS)), found=str(version)
        )
    rows = connection.execute("SELECT type, name, sql FROM sqlite_schema").fetchall()
    made = _made_by(MIGRATIONS[:version])
    missing = made - {sql for _, _, sql in rows}
    triggers = [name for kind, name, _ in rows if kind == "trigger"]
    if missing or triggers:
        first = min(missing).split("(")[0] if missing else f"trigger {triggers[0]}"
        raise CorruptError(
            "not the tables of a library",
            file=file,
            expected=f"those of version {version}",
            found=f"another or no {first.removeprefix('CREATE ').lower()}" if missing else first,
        )
