"""The chunks of a clip in a library, read as far as they are asked for."""

import sqlite3

from mocapress.library.database import Database

_AT_ONCE = 2**20
"""Bytes that are read at once. SQLite finds a place in a row by passing all pages before it."""


class Chunks:
    """The sections of a clip's chunks, one behind the other.

    Parameters
    ----------
    db, clip
        The library, and the clip's id.
    salvage
        Whether bytes that cannot be read are given as zeros, which no checksum is right for.

    """

    def __init__(self, db: Database, clip: int, *, salvage: bool) -> None:
        self._db, self._clip, self._salvage = db, clip, salvage
        row = db.connection.execute(
            "SELECT list, length(sections) FROM chunks WHERE clip = ?", [clip]
        ).fetchone()
        self.listed: bytes = b"\0" if row is None else row[0]
        """What stands in ``list``."""
        self.size: int = 0 if row is None else row[1]
        self._begin, self._ahead = 0, b""

    def read(self, start: int, stop: int) -> bytes:
        """Give bytes [start, stop), of which there must be as many."""
        if not self._begin <= start <= stop <= self._begin + len(self._ahead):
            try:
                self._ahead = self._read(start, min(max(stop, start + _AT_ONCE), self.size))
                self._begin = start
            except sqlite3.DatabaseError:
                return self._what_is_left(start, stop)
        return self._ahead[start - self._begin : stop - self._begin]

    def _what_is_left(self, start: int, stop: int) -> bytes:
        """Read only what is asked for, as something behind it is damaged."""
        try:
            return self._read(start, stop)
        except sqlite3.DatabaseError:
            if not self._salvage:
                raise
        return bytes(stop - start)

    def _read(self, start: int, stop: int) -> bytes:
        connection = self._db.connection
        with connection.blobopen("chunks", "sections", self._clip, readonly=True) as blob:
            blob.seek(start)
            return blob.read(stop - start)
