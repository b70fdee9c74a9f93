"""Files that come out of a library: originals and companions, also of a damaged one."""

import sqlite3
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from mocapress.container import unpack
from mocapress.container.limits import most_companions
from mocapress.errors import CorruptError
from mocapress.library import rows
from mocapress.library.checking import survivors
from mocapress.library.clips import StoredClip
from mocapress.library.library import Library
from mocapress.library.rows import Connection


class Item(NamedTuple):
    """A file that can be written."""

    name: str
    size: int
    modified: int | None
    """In nanoseconds since 1970."""
    read: Callable[[bool], bytes]
    """Gives its contents; True: what is left of it where it is damaged."""


def items(library: Library, clips: Sequence[StoredClip], *, every: bool) -> list[Item]:
    """Give the files of clips and of their companions; of ``every`` clip also other companions."""
    found = [
        Item(clip.name, clip.size or 1, clip.modified, _original(library, clip.id))
        for clip in clips
    ]
    with library.db.reading() as connection:
        wanted = {clip.id for clip in clips}
        belongs: dict[int, bool] = {}
        for clip, companion in connection.execute("SELECT clip, companion FROM belongs"):
            belongs[companion] = belongs.get(companion, False) or clip in wanted
        found += [
            item for number, item in _companions(library, connection) if belongs.get(number, every)
        ]
    return found


def left(library: Library) -> list[Item]:
    """Give the files of all clips and companions that a damaged library still knows of."""
    found: list[Item] = []
    with library.db.reading() as connection:
        for number, name in survivors(connection):
            try:
                row = rows.read_clip(connection, number)
            except sqlite3.DatabaseError as error:
                found.append(Item(name, 0, None, _raising(name, error)))
                continue
            if row is not None:
                facts = row[0]
                found.append(
                    Item(name, facts.size or 1, facts.modified, _original(library, number))
                )
        try:
            found.extend(item for _, item in _companions(library, connection))
        except sqlite3.DatabaseError as error:
            found.append(Item("companions", 0, None, _raising("companions", error)))
    return found


def _original(library: Library, number: int) -> Callable[[bool], bytes]:
    def read(salvage: bool) -> bytes:
        return library.restore(number, salvage=salvage).data

    return read


def _companions(library: Library, connection: Connection) -> Iterator[tuple[int, Item]]:
    for number, name, size, modified in connection.execute(
        "SELECT id, name, size, modified FROM companions ORDER BY name"
    ):
        yield number, Item(name, size, modified, _companion(library, number, name, size))


def _companion(library: Library, number: int, name: str, size: int) -> Callable[[bool], bytes]:
    def read(salvage: bool) -> bytes:  # noqa: ARG001 - a companion is whole or not at all
        library.fetch((), [number])
        with library.db.reading() as connection:
            row = connection.execute(
                "SELECT packed FROM texts WHERE id = (SELECT text FROM companions WHERE id = ?)",
                [number],
            ).fetchone()
        if row is None:
            raise CorruptError("the companion is damaged", file=name)
        return unpack(row[0], "companion", min(size, most_companions(len(row[0]))))

    return read


def _raising(name: str, error: Exception) -> Callable[[bool], bytes]:
    def read(salvage: bool) -> bytes:  # noqa: ARG001
        raise CorruptError(f"lost: its row cannot be read ({error})", file=name)

    return read
