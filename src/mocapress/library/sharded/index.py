"""The catalogue of a sharded library as a library on this machine, made of the manifest."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

from mocapress.container import unpack
from mocapress.container.limits import UNPACKED
from mocapress.errors import CorruptError
from mocapress.library import schema
from mocapress.library.index import checksum as index_checksum
from mocapress.library.rows import COLUMNS, Facts, checksum, hash_of
from mocapress.library.sharded.manifest import COMPANION, MODEL, Manifest

SERIAL = 2**32
"""An id is that of the clip in its shard, and this times the shard's serial number."""


def writable(file: Path) -> sqlite3.Connection:
    """Connect to the library on this machine; what is lost of it is read again."""
    connection = sqlite3.connect(file, isolation_level=None)
    connection.execute("PRAGMA synchronous = OFF")
    return connection


def fill(file: Path, found: Manifest, of: str) -> tuple[dict[tuple[str, int], int], dict[str, int]]:
    """Make a library of what a manifest says; give the row of each clip, and ids of models.

    Raises
    ------
    CorruptError
        When the manifest says what cannot be.

    """
    try:
        return _fill(file, found)
    except (ValueError, TypeError, KeyError, OverflowError, sqlite3.Error) as error:
        raise CorruptError(f"the manifest is damaged ({error!r})", file=of) from error


def _fill(file: Path, found: Manifest) -> tuple[dict[tuple[str, int], int], dict[str, int]]:
    rows: dict[tuple[str, int], int] = {}
    models: dict[str, int] = {}
    skeletons: dict[bytes, int] = {}
    companions: dict[str, int] = {}
    belongs: list[tuple[int, str]] = []
    file.write_bytes(schema.empty())
    with closing(writable(file)) as connection:
        connection.execute("BEGIN")
        for index, row in enumerate(_each(found)):
            serial = found.shards[row["shard"]][0]
            number = serial * SERIAL + row["id"]
            rows[row["kind"], number] = index
            if row["kind"] == MODEL:
                models[row["name"]] = number
            elif row["kind"] == COMPANION:
                companions[row["name"]] = number
                facts = (row["format"], row["size"], row["sha256"], row["modified"])
                connection.execute(
                    "INSERT INTO companions VALUES(?, ?, ?, ?, ?, ?, ?)",
                    (number, row["name"], *facts, -number),
                )
            else:
                _insert_clip(connection, number, serial, row, skeletons)
                belongs += [(number, name) for name in row["companions"] or ()]
        connection.executemany(
            "INSERT INTO belongs VALUES(?, ?)",
            [(clip, companions[name]) for clip, name in belongs if name in companions],
        )
        connection.execute("COMMIT")
    return rows, models


def _each(found: Manifest) -> Iterator[dict[str, Any]]:
    for batch in found.rows.to_batches(max_chunksize=1000):
        yield from batch.to_pylist()


def _insert_clip(
    connection: sqlite3.Connection,
    number: int,
    serial: int,
    row: dict[str, Any],
    skeletons: dict[bytes, int],
) -> None:
    """Insert all of a clip but its text and its chunks."""
    record = row["skeleton_record"]
    if record is not None and record not in skeletons:
        skeletons[record] = len(skeletons) + 1
        wanted = hash_of(unpack(record, "skeleton", UNPACKED))
        facts = (skeletons[record], row["skeleton"], row["joints"], wanted, record)
        connection.execute("INSERT INTO skeletons VALUES(?, ?, ?, ?, ?, NULL)", facts)
    elsewhere = ("skeleton", "text", "layout")
    own = {column: row[column] for column in Facts._fields if column not in elsewhere}
    text = None if row["text_size"] is None else number
    clip = Facts(**own, skeleton=skeletons.get(record), text=text)
    marks = ", ".join("?" * (len(clip) + 2))
    connection.execute(
        f"INSERT INTO clips(id, {COLUMNS}, checksum) VALUES({marks})",
        (number, *clip, checksum(clip)),
    )
    if row["signature"] is not None and row["index_version"] is not None:
        crc = index_checksum(row["index_version"], row["signature"])
        connection.execute(
            "INSERT INTO signatures VALUES(?, ?, ?, ?)",
            (number, row["index_version"], row["signature"], crc),
        )
    for label in row["labels"] or ():
        connection.execute("INSERT INTO labels VALUES(?, ?)", (number, label))
    for key, value in row["notes"] or ():
        connection.execute("INSERT INTO notes VALUES(?, ?, ?)", (number, key, value))
    for stream, first, frames, source, source_first in row["runs"] or ():
        connection.execute(
            "INSERT INTO runs VALUES(?, ?, ?, ?, ?, ?)",
            (number, stream, first, frames, serial * SERIAL + source, source_first),
        )
    for digest, need in zip(row["needs_digests"] or (), row["needs"] or (), strict=True):
        stream, source, source_first, frames = need
        connection.execute(
            "INSERT INTO needs VALUES(?, ?, ?, ?, ?, ?)",
            (number, digest, stream, serial * SERIAL + source, source_first, frames),
        )


def insert_values(
    connection: sqlite3.Connection,
    key: tuple[str, int],
    row: dict[str, Any],
    value: bytes,
    text: bytes | None,
) -> None:
    """Insert what was read of a clip, companion or model; a forked process may have done it."""
    kind, number = key
    if text is not None:
        own = -number if kind == COMPANION else number
        connection.execute(
            "INSERT OR IGNORE INTO texts VALUES(?, ?, ?)", (own, hash_of(text), text)
        )
    if kind == MODEL:
        connection.execute(
            "INSERT OR IGNORE INTO models VALUES(?, ?, ?, ?)",
            (number, bytes.fromhex(row["name"]), row["codec"], value),
        )
    elif row["chunk_list"] is not None:
        begin = len(row["chunk_list"])
        if value[:begin] != row["chunk_list"]:
            raise CorruptError("not what the manifest says is in the shard", file=row["name"])
        connection.execute(
            "INSERT OR IGNORE INTO chunks VALUES(?, ?, ?)",
            (number, row["chunk_list"], value[begin:]),
        )
