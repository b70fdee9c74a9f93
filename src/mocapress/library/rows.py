"""Rows of a library's tables: once where they are equal, deleted when nothing needs them."""

import hashlib
import sqlite3
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs import Model
from mocapress.container import Entry, Mcz, pack, unpack
from mocapress.container.chunks import stream_and_flags
from mocapress.library import names
from mocapress.models import model_bytes

Connection = sqlite3.Connection


class Facts(NamedTuple):
    """A row of ``clips`` but for its id and checksum: docs/format/library.md."""

    name: str
    format: str | None = None
    file: str | None = None
    frames: int = 0
    channels: int = 0
    frame_time: float | None = None
    size: int | None = None
    sha256: bytes | None = None
    modified: int | None = None
    skeleton: int | None = None
    text: int | None = None
    codec: str | None = None
    head: bytes | None = None
    problems: bytes | None = None


class Run(NamedTuple):
    """Frames of a stream of a clip that the same stream of another clip has."""

    stream: int
    """Its index."""
    first: int
    frames: int
    source: int
    """Id of the other clip."""
    source_first: int
    """Counted among the frames that the other has in chunks of its own."""

    @classmethod
    def whole(cls, stream: int, frames: int, source: int) -> "Run":
        """Give the run that is all of a stream."""
        return cls(stream, 0, frames, source, 0)


RUN_COLUMNS = ", ".join(Run._fields)


COLUMNS = ", ".join(Facts._fields)


def hash_of(data: bytes) -> int:
    """Give the hash by which equal texts and skeletons are found."""
    return int.from_bytes(hashlib.sha256(data).digest()[:8], "big", signed=True)


def checksum(facts: Facts) -> int:
    """Give the checksum of a row of ``clips``."""
    return zlib.crc32(b"".join(_bytes(value) + b"\0" for value in facts))


def _bytes(value: Any) -> bytes:
    if value is None:
        return b""
    if isinstance(value, bytes):
        return value
    if isinstance(value, float):
        return struct.pack("<d", value)
    return str(value).encode(errors="surrogateescape")


def insert_clip(connection: Connection, facts: Facts) -> int:
    """Add a row to ``clips``; give its id."""
    marks = ", ".join(["CAST(? AS TEXT)", *"?" * (len(facts) - 1)])
    made = connection.execute(
        f"INSERT INTO clips({COLUMNS}, checksum) VALUES({marks}, ?)",
        [names.stored(facts.name), *facts[1:], checksum(facts)],
    )
    return int(made.lastrowid or 0)


def update_clip(connection: Connection, clip: int, facts: Facts) -> None:
    """Replace a row of ``clips``."""
    sets = ", ".join(f"{column} = ?" for column in Facts._fields[1:])
    connection.execute(
        f"UPDATE clips SET name = CAST(? AS TEXT), {sets}, checksum = ? WHERE id = ?",  # noqa: S608
        [names.stored(facts.name), *facts[1:], checksum(facts), clip],
    )


def read_clip(connection: Connection, clip: int) -> tuple[Facts, int] | None:
    """Give a row of ``clips`` and its checksum."""
    row = connection.execute(
        f"SELECT {COLUMNS}, checksum FROM clips WHERE id = ?",  # noqa: S608
        [clip],
    ).fetchone()
    return None if row is None else (Facts(*row[:-1]), row[-1])


def text_id(connection: Connection, packed: bytes) -> int:
    """Give the row of a text, which is added where there is none yet."""
    wanted = hash_of(packed)
    row = connection.execute(
        "SELECT id FROM texts WHERE hash = ? AND packed = ?", (wanted, packed)
    ).fetchone()
    if row is None:
        made = connection.execute("INSERT INTO texts(hash, packed) VALUES(?, ?)", (wanted, packed))
        return int(made.lastrowid or 0)
    return int(row[0])


def skeleton_id(connection: Connection, record: bytes, name: str, joints: int) -> int:
    """Give the row of a skeleton, which is added where there is none yet; see ``write_parts``."""
    wanted = hash_of(record)
    # There are few: an index would cost more than it brings.
    for number, packed in connection.execute(
        "SELECT id, record FROM skeletons WHERE hash = ?", [wanted]
    ):
        if unpack(packed, "skeleton", len(record)) == record:
            return int(number)
    made = connection.execute(
        "INSERT INTO skeletons(name, joints, hash, record) VALUES(?, ?, ?, ?)",
        (name, joints, wanted, pack(record)),
    )
    return int(made.lastrowid or 0)


def add_model(connection: Connection, model: Model) -> None:
    """Keep a model, where it is not kept yet."""
    connection.execute(
        "INSERT OR IGNORE INTO models(digest, codec, file) VALUES(?, ?, ?)",
        (model.digest, model.codec, model_bytes(model)),
    )


def companion_id(
    connection: Connection,
    name: str,
    kind: str,
    data: bytes,
    packed: Callable[[], bytes],
    modified: int | None,
) -> int:
    """Give the row of a companion, which is added, or changed where its contents are others."""
    digest = hashlib.sha256(data).digest()
    row = connection.execute(
        "SELECT id, sha256, text FROM companions WHERE name = CAST(? AS TEXT)",
        [names.stored(name)],
    ).fetchone()
    if row is not None and row[1] == digest:
        return int(row[0])
    text = text_id(connection, packed())
    values = (kind, len(data), digest, modified, text)
    if row is None:
        made = connection.execute(
            "INSERT INTO companions(name, format, size, sha256, modified, text) "
            "VALUES(CAST(? AS TEXT), ?, ?, ?, ?, ?)",
            (names.stored(name), *values),
        )
        return int(made.lastrowid or 0)
    connection.execute(
        "UPDATE companions SET format = ?, size = ?, sha256 = ?, modified = ?, text = ? "
        "WHERE id = ?",
        (*values, row[0]),
    )
    drop_text(connection, row[2])
    return int(row[0])


def insert_chunks(connection: Connection, clip: int, mcz: Mcz) -> None:
    """Add the chunks of a file as they are."""
    connection.executemany(
        "INSERT INTO chunks(clip, number, flags, first, frames, section) VALUES(?, ?, ?, ?, ?, ?)",
        (_chunk(clip, number, entry, mcz) for number, entry in enumerate(mcz.entries)),
    )


def _chunk(clip: int, number: int, entry: Entry, mcz: Mcz) -> tuple[int, int, int, int, int, bytes]:
    section = mcz.ranges.read(entry.begin, entry.end)
    return clip, number, stream_and_flags(entry), entry.first, entry.frames, section


def insert_runs(connection: Connection, clip: int, runs: Sequence[Run]) -> None:
    """Add runs of a clip."""
    connection.executemany(
        "INSERT INTO runs(clip, stream, first, frames, source, source_first) "
        "VALUES(?, ?, ?, ?, ?, ?)",
        [(clip, *run) for run in runs],
    )


def insert_notes(connection: Connection, clip: int, notes: Mapping[str, str]) -> None:
    """Set what is said about a clip."""
    connection.executemany(
        "INSERT OR REPLACE INTO notes VALUES(?, ?, ?)",
        [(clip, key, value) for key, value in notes.items()],
    )


def insert_labels(connection: Connection, clip: int, labels: Sequence[str]) -> None:
    """Give a clip labels beside those that it has."""
    connection.executemany(
        "INSERT OR IGNORE INTO labels VALUES(?, ?)", [(clip, label) for label in labels]
    )


def insert_belongs(connection: Connection, clip: int, companion: int) -> None:
    """Say that a clip has a companion."""
    connection.execute("INSERT OR IGNORE INTO belongs VALUES(?, ?)", (clip, companion))


def insert_anchors(connection: Connection, clip: int, hashes: NDArray[np.uint32] | None) -> None:
    """Keep by what frames of a clip are found."""
    if hashes is not None:
        data = hashes.astype("<u4").tobytes()
        connection.execute("INSERT INTO anchors VALUES(?, ?)", (clip, data))


def drop_contents(connection: Connection, clip: int) -> None:
    """Delete what a clip has in chunks and runs, and by what it is found."""
    for table in ("chunks", "runs", "needs", "anchors"):
        connection.execute(f"DELETE FROM {table} WHERE clip = ?", [clip])  # noqa: S608


def drop_clip(connection: Connection, clip: int) -> None:
    """Delete a clip that no other refers to, and what only it needed."""
    drop_contents(connection, clip)
    found = read_clip(connection, clip)
    if found is None:
        return
    facts = found[0]
    companions = connection.execute(
        "SELECT companion FROM belongs WHERE clip = ?", [clip]
    ).fetchall()
    for table in ("belongs", "labels", "notes"):
        connection.execute(f"DELETE FROM {table} WHERE clip = ?", [clip])  # noqa: S608
    connection.execute("DELETE FROM clips WHERE id = ?", [clip])
    drop_text(connection, facts.text)
    if facts.skeleton is not None:
        connection.execute(
            "DELETE FROM skeletons WHERE id = ? AND NOT EXISTS"
            "(SELECT 1 FROM clips WHERE skeleton = skeletons.id)",
            [facts.skeleton],
        )
    for (companion,) in companions:
        row = connection.execute(
            "DELETE FROM companions WHERE id = ? AND NOT EXISTS"
            "(SELECT 1 FROM belongs WHERE companion = companions.id) RETURNING text",
            [companion],
        ).fetchone()
        drop_text(connection, row and row[0])


def drop_text(connection: Connection, text: int | None) -> None:
    """Delete a text that nothing needs any more."""
    if text is not None:
        connection.execute(
            "DELETE FROM texts WHERE id = ? "
            "AND NOT EXISTS(SELECT 1 FROM clips WHERE text = texts.id) "
            "AND NOT EXISTS(SELECT 1 FROM companions WHERE text = texts.id)",
            [text],
        )
