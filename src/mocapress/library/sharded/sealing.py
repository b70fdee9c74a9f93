"""Making a shard of a library: the same rows in a file whose parts can be read alone.

The rows are copied in a fixed order into a new file, so that equal libraries make equal shards, and
the chunks of a clip stand in successive pages.
"""

import hashlib
import sqlite3
from contextlib import closing
from itertools import product
from mmap import mmap
from pathlib import Path
from typing import Any

from mocapress.container import pack, unpack
from mocapress.container.limits import UNPACKED
from mocapress.errors import FormatError, VerificationError
from mocapress.library import schema
from mocapress.library.database import Database
from mocapress.library.opened import OpenedClip
from mocapress.library.rows import Facts, read_clip, sample_of
from mocapress.library.sharded.manifest import CLIP, COMPANION, MODEL
from mocapress.library.sharded.places import Place, joined, last_values, mapped

_OTHERS = """
SELECT name FROM made.sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite%'
    AND name NOT IN ('migrations', 'texts', 'chunks') ORDER BY name
"""
"""Tables that stand before the values that are read alone."""
_SMALL = 900
"""Bytes up to which a text is in the manifest, too, and is not read from the shard."""


def seal(source: Database, target: Path) -> str:
    """Copy a library into a new file; give the name by which it is known, of its digest."""
    target.write_bytes(schema.empty())
    with closing(sqlite3.connect(target, isolation_level=None)) as connection:
        for pragma in ("foreign_keys = OFF", "journal_mode = OFF", "synchronous = OFF"):
            connection.execute(f"PRAGMA {pragma}")
        connection.text_factory = bytes
        connection.execute("ATTACH ? AS made", [str(source.path)])
        connection.execute("BEGIN")
        # When it was made says nothing of what is in it.
        connection.execute("UPDATE main.migrations SET applied = ''")
        for (table,) in connection.execute(_OTHERS).fetchall():
            _copy(connection, table.decode())
        texts = connection.execute("SELECT DISTINCT text FROM made.companions ORDER BY 1")
        for (text,) in texts.fetchall():
            _copy(connection, "texts", "id", text)
        for clip, text in connection.execute(
            "SELECT id, text FROM made.clips ORDER BY id"
        ).fetchall():
            if text is not None:
                _copy(connection, "texts", "id", text)
            _copy(connection, "chunks", "clip", clip)
        connection.execute("COMMIT")
        connection.execute("DETACH made")
        connection.execute("PRAGMA journal_mode = WAL")
    return digest_of(target)


def _copy(connection: sqlite3.Connection, table: str, key: str = "", value: int = 0) -> None:
    """Copy the rows of a table, or one."""
    where = f"WHERE {key} = ?" if key else ""
    connection.execute(
        f"INSERT OR IGNORE INTO main.{table} SELECT * FROM made.{table} {where}",  # noqa: S608
        [value] if key else [],
    )


def digest_of(file: Path) -> str:
    """Give the first 32 digits of a file's SHA-256."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()[:32]


def rows_of(db: Database, name: str) -> list[dict[str, Any]]:
    """Give what the manifest says of the clips, companions and models of a sealed shard.

    Raises
    ------
    VerificationError
        When a value is not where the manifest would say.

    """
    with db.reading() as connection:
        chunks = _sizes(connection, "SELECT clip, length(list) + length(sections) FROM chunks")
        texts = _sizes(connection, "SELECT id, length(packed) FROM texts")
        models = _sizes(connection, "SELECT id, length(file) FROM models")
        features = _sizes(connection, "SELECT clip, length(rows) FROM features")
        places = {
            table: last_values(connection, db.path, table, sizes)
            for table, sizes in (
                *(("chunks", chunks), ("texts", texts), ("models", models)),
                ("features", features),
            )
        }
        rows = []
        for (clip,) in connection.execute("SELECT id FROM clips ORDER BY id").fetchall():
            row = _clip(db, clip) | {"shard": name}
            if clip in chunks:
                row |= _value(places["chunks"][clip], chunks[clip])
            if clip in features:
                row |= _value(places["features"][clip], features[clip], "features")
            rows.append(row | _text(connection, row.pop("text_row"), places["texts"], texts))
        for number, own, kind, size, sha256, modified, text in connection.execute(
            "SELECT id, name, format, size, sha256, modified, text FROM companions ORDER BY id"
        ).fetchall():
            row = {"kind": COMPANION, "name": own, "format": kind, "size": size, "id": number}
            row |= {"shard": name, "sha256": sha256, "modified": modified}
            rows.append(row | _text(connection, text, places["texts"], texts))
        for number, digest, codec in connection.execute("SELECT id, digest, codec FROM models"):
            row = {"kind": MODEL, "name": digest.hex(), "shard": name, "id": number, "codec": codec}
            rows.append(row | _value(places["models"][number], models[number]))
    _check(db, rows)
    return rows


def _sizes(connection: sqlite3.Connection, query: str) -> dict[int, int]:
    return dict(connection.execute(query))


def _value(places: list[Place], size: int, what: str = "value") -> dict[str, Any]:
    return {f"{what}_size": size, f"{what}_places": [int(n) for place in places for n in place]}


def _text(
    connection: sqlite3.Connection,
    text: int | None,
    places: dict[int, list[Place]],
    sizes: dict[int, int],
) -> dict[str, Any]:
    if text is None:
        return {}
    if sizes[text] <= _SMALL:
        packed = connection.execute("SELECT packed FROM texts WHERE id = ?", [text]).fetchone()[0]
        return {"text": packed, "text_size": sizes[text]}
    flat = [int(number) for place in places[text] for number in place]
    return {"text_size": sizes[text], "text_places": flat}


def _clip(db: Database, clip: int) -> dict[str, Any]:
    """Give what the manifest says of a clip, but for where its values stand."""
    connection = db.connection
    found = read_clip(connection, clip)
    assert found is not None
    facts: Facts = found[0]
    try:
        facts.name.encode()
    except UnicodeEncodeError:
        raise FormatError("names in a sharded library are UTF-8", file=repr(facts.name)) from None
    opened = OpenedClip(db, clip)
    own = (
        *("name", "format", "file", "frames", "channels", "frame_time", "size", "sha256"),
        *("modified", "codec", "head", "problems"),
    )
    row: dict[str, Any] = {"kind": CLIP, "id": clip, "text_row": facts.text}
    row |= {column: getattr(facts, column) for column in own}
    sample = sample_of(connection, facts.skeleton)
    if facts.head is not None:
        row["head"] = pack(unpack(facts.head, "head", UNPACKED, beside=sample))
    if facts.layout is not None:
        row["text"] = pack(unpack(facts.layout, "layout", beside=sample))
        row["text_size"] = len(row["text"])
    row["models"] = sorted({stream.model.hex() for stream in opened.streams} - {""})
    if facts.skeleton is not None:
        row["skeleton"], row["joints"], row["skeleton_record"] = connection.execute(
            "SELECT name, joints, record FROM skeletons WHERE id = ?", [facts.skeleton]
        ).fetchone()

    def several(query: str) -> list[Any]:
        return connection.execute(query, [clip]).fetchall()

    row["labels"] = [n for (n,) in several("SELECT label FROM labels WHERE clip = ? ORDER BY 1")]
    row["notes"] = several("SELECT key, value FROM notes WHERE clip = ? ORDER BY 1")
    row["companions"] = [
        own
        for (own,) in several(
            "SELECT name FROM companions JOIN belongs ON companion = id WHERE clip = ? ORDER BY 1"
        )
    ]
    row["runs"] = several(
        "SELECT stream, first, frames, source, source_first FROM runs WHERE clip = ? ORDER BY 1, 2"
    )
    needs = several(
        "SELECT digest, stream, source, source_first, frames FROM needs WHERE clip = ? ORDER BY 1"
    )
    row["needs"], row["needs_digests"] = [n[1:] for n in needs], [n[0] for n in needs]
    for version, signature, checksum in several(
        "SELECT version, signature, features.checksum FROM signatures "
        "LEFT JOIN features ON features.clip = signatures.clip WHERE signatures.clip = ?"
    ):
        row["index_version"], row["signature"] = version, signature
        row["features_checksum"] = checksum
    row["chunk_list"] = next(iter(several("SELECT list FROM chunks WHERE clip = ?")), (None,))[0]
    return row


def _check(db: Database, rows: list[dict[str, Any]]) -> None:
    """See that what stands at the places is what the tables say."""
    data = mapped(db.path)
    queries = {
        (CLIP, "value"): "SELECT list, sections FROM chunks WHERE clip = ?",
        (CLIP, "features"): "SELECT rows FROM features WHERE clip = ?",
        (MODEL, "value"): "SELECT file FROM models WHERE id = ?",
    }
    for row, what in product(rows, ("value", "features")):
        size = row.get(f"{what}_size")
        if size is not None:
            query = queries[row["kind"], what]
            wanted = b"".join(db.connection.execute(query, [row["id"]]).fetchone())
            if value_of(data, row[f"{what}_places"], size) != wanted:
                raise VerificationError(f"{row['name']} is not where it should be in the shard")


def value_of(data: bytes | mmap, flat: list[int], size: int) -> bytes:
    """Give the value that stands at places of a file."""
    places = unflattened(flat)
    parts = [data[place.begin : place.begin + place.size] for place in places]
    return joined(parts, places, size, schema.PAGE)


def unflattened(flat: list[int]) -> list[Place]:
    """Give the places that a row of the manifest lists."""
    threes = zip(flat[::3], flat[1::3], flat[2::3], strict=True)
    return [Place(begin, size, bool(chained)) for begin, size, chained in threes]
