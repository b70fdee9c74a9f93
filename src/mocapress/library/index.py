"""Rows of a library's index for search by example: a signature and features for each clip."""

import zlib
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from mocapress.errors import UnsupportedError
from mocapress.library.rows import Connection
from mocapress.library.schema import NO_INDEX, SEARCH, SETTINGS, version_of
from mocapress.motion import Clip
from mocapress.search.index import VERSION, Entry, entry_of
from mocapress.search.signatures import BYTES
from mocapress.search.standard import standard_motion

NOTHING = Entry(b"", b"")
"""Of a clip that has no body to be searched; kept, so that nobody tries again."""


class Kept(NamedTuple):
    """What the index has of a clip."""

    clip: int
    signature: bytes | None
    """None where there is none, or it is damaged or of another version; empty as ``NOTHING``."""


def made_of(clip: Clip, joints: Mapping[str, str] | None = None) -> Entry:
    """Index a clip; one without frames or joints of a body gives ``NOTHING``.

    ``joints`` count for skeletons that have all of their names; see ``standard_motion``.
    """
    names = clip.skeleton.names if clip.skeleton else ()
    fitting = joints if joints and {*joints.values()} <= {*names} else None
    try:
        return entry_of(standard_motion(clip, fitting))
    except UnsupportedError:
        return NOTHING


def is_wanted(connection: Connection) -> bool:
    """Say whether clips are indexed when they are added: unless the library was made without."""
    if version_of(connection) < SETTINGS:
        return True
    found = connection.execute("SELECT value FROM settings WHERE name = ?", NO_INDEX[:1]).fetchone()
    return bool(found != NO_INDEX[1:])


def write(connection: Connection, clip: int, entry: Entry) -> None:
    """Put an entry in the place of what the index has of a clip, if the clip is still there."""
    if connection.execute("SELECT 1 FROM clips WHERE id = ?", [clip]).fetchone() is None:
        return
    connection.execute(
        "INSERT OR REPLACE INTO signatures VALUES(?, ?, ?, ?)",
        (clip, VERSION, entry.signature, checksum(VERSION, entry.signature)),
    )
    connection.execute("DELETE FROM features WHERE clip = ?", [clip])
    if not entry.signature:
        return
    connection.execute(
        "INSERT INTO features VALUES(?, ?, ?)",
        (clip, checksum(VERSION, entry.features), entry.features),
    )


def checksum(version: int, data: bytes) -> int:
    """Give the checksum of a row of the index."""
    return zlib.crc32(version.to_bytes(8, "little", signed=True) + data)


def signatures(connection: Connection) -> list[Kept]:
    """Give what the index has of all clips that have frames, in the order of ids."""
    if version_of(connection) < SEARCH:
        rows = connection.execute("SELECT id FROM clips WHERE frames > 0 ORDER BY id")
        return [Kept(clip, None) for (clip,) in rows]
    rows = connection.execute(
        "SELECT id, version, signature, signatures.checksum FROM clips "
        "LEFT JOIN signatures ON clip = id WHERE frames > 0 ORDER BY id"
    )
    return [
        Kept(clip, signature if version == VERSION and _is_usable(signature, crc) else None)
        for clip, version, signature, crc in rows
    ]


def _is_usable(signature: bytes, crc: int) -> bool:
    return is_sound(VERSION, signature, crc) and len(signature) in (0, BYTES)


def is_sound(version: int, data: object, crc: int) -> bool:
    """Say whether a row of the index has its checksum."""
    return isinstance(data, bytes) and checksum(version, data) == crc


def features(connection: Connection, clip: int) -> bytes | None:
    """Give the features of a clip; None if there are none of this version or they are damaged."""
    if version_of(connection) < SEARCH:
        return None
    row = connection.execute(
        "SELECT rows, checksum FROM features WHERE clip = ?", [clip]
    ).fetchone()
    return row[0] if row and is_sound(VERSION, *row) else None


def size_of(connection: Connection) -> tuple[int, int]:
    """Give how many clips the index has, and the bytes of their signatures and features."""
    if version_of(connection) < SEARCH:
        return 0, 0
    count, signed = connection.execute(
        "SELECT count(*), coalesce(sum(length(signature)), 0) FROM signatures "
        "WHERE length(signature)"
    ).fetchone()
    rows = connection.execute("SELECT coalesce(sum(length(rows)), 0) FROM features").fetchone()[0]
    return count, signed + rows


def damaged(connection: Connection) -> Iterator[tuple[int, str]]:
    """Give the ids of clips of which the index is damaged, and what is."""
    if version_of(connection) < SEARCH:
        return
    for clip, version, signature, crc, rows, of_rows in connection.execute(
        "SELECT signatures.clip, version, signature, signatures.checksum, rows, features.checksum "
        "FROM signatures LEFT JOIN features ON features.clip = signatures.clip"
    ):
        if not is_sound(version, signature, crc):
            yield clip, "the signature for search is damaged; library reindex makes it anew"
        elif signature and not is_sound(version, rows, of_rows):
            yield clip, "the features for search are damaged; library reindex makes them anew"
