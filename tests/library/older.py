"""Libraries as earlier versions made them."""

import sqlite3
from contextlib import closing
from pathlib import Path

import mocapress as mp
from mocapress.container import pack, unpack
from mocapress.library import schema
from mocapress.library.rows import read_clip, sample_of, text_id, update_clip

_LATER = {2: ["needs"], 3: ["signatures", "features"], 4: ["settings"]}
_INDEXES = ("clips_by_text", "companions_by_text", "belongs_by_companion", "labels_by_label")


def make_older(path: Path, version: int) -> None:
    """Bring a library back to version 1 to 4, with all that is in it."""
    with mp.open_library(path, "a") as library, library.db.writing() as connection:
        for clip in library:
            found = read_clip(connection, clip.id)
            assert found is not None
            facts = found[0]
            sample = sample_of(connection, facts.skeleton)
            if facts.head is not None:
                facts = facts._replace(head=pack(unpack(facts.head, "head", beside=sample)))
            if facts.layout is not None:
                text = text_id(connection, pack(unpack(facts.layout, "layout", beside=sample)))
                facts = facts._replace(text=text, layout=None)
            update_clip(connection, clip.id, facts)
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("ALTER TABLE clips DROP COLUMN layout")
        connection.execute("ALTER TABLE skeletons DROP COLUMN sample")
        connection.execute("DROP INDEX clips_by_text")
        for statement in schema.MIGRATIONS[0].statements:
            if any(statement.startswith(f"CREATE INDEX {name} ") for name in _INDEXES):
                connection.execute(statement)
        for later, tables in _LATER.items():
            for table in tables if version < later else ():
                connection.execute(f"DROP TABLE {table}")
        connection.execute("DELETE FROM migrations WHERE version > ?", [version])
        connection.execute(f"PRAGMA user_version = {version}")
