"""The SQLite database of a library: how it is opened, read and written, and what its errors mean.

Each thread has a connection of its own, so that threads read at the same time. Writers of one
process wait for each other at a lock, those of several processes at the database.
"""

import errno
import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn
from urllib.parse import quote

from mocapress.errors import (
    BusyError,
    CorruptError,
    ParameterError,
    UnsupportedError,
)
from mocapress.library import schema
from mocapress.storage import write_whole

WAIT = 10.0
"""Seconds to wait for another process that writes, unless said otherwise."""
_LEAST_SQLITE = (3, 37, 0)
_CHECKPOINT = 2**14
"""Pages in the write-ahead log from which on they are written back."""
_inherited: list[object] = []
"""Connections of a parent process. To close them here would take its locks away."""


class Database:
    """A library's file.

    Parameters
    ----------
    path
        Of the file, which must exist.
    writable
        Whether it will be written.
    wait
        Seconds to wait for another process that writes.
    limit
        Bytes that may be restored of a clip; None for any number.

    Raises
    ------
    CorruptError
        When it is no library.
    OSError
        When it cannot be opened.

    """

    def __init__(self, path: Path, *, writable: bool, wait: float, limit: int | None) -> None:
        if sqlite3.sqlite_version_info < _LEAST_SQLITE:
            raise UnsupportedError(
                "libraries need SQLite", expected="3.37 or later", found=sqlite3.sqlite_version
            )
        self.path, self.writable, self.wait, self.limit = path, writable, wait, limit
        self.writing_lock = threading.RLock()
        self._pid = os.getpid()
        self._all: list[sqlite3.Connection] = []
        self._own = threading.local()
        self._closed = False
        with path.open("rb"):  # the system's own error where it cannot be read
            pass
        try:
            with self._told():
                schema.check(self.connection, str(path))
                if writable:
                    schema.migrate(self.connection)
        except BaseException:
            self.close()
            raise

    @property
    def connection(self) -> sqlite3.Connection:
        """The connection of this thread."""
        if self._closed:
            raise ParameterError("the library is closed", file=str(self.path))
        if self._pid != os.getpid():
            _inherited.extend([*self._all, self._own])
            self._all, self._own, self._pid = [], threading.local(), os.getpid()
            self.writing_lock = threading.RLock()
        found: sqlite3.Connection | None = getattr(self._own, "connection", None)
        if found is None:
            found = self._own.connection = self._connect()
            self._all.append(found)
        return found

    def _connect(self) -> sqlite3.Connection:
        place = quote(os.fsencode(self.path.absolute()))
        uri = f"file:{place}?{self._mode()}"
        connection = sqlite3.connect(
            uri, uri=True, timeout=self.wait, isolation_level=None, check_same_thread=False
        )
        # Names of files need not be UTF-8: they come out as they went in.
        connection.text_factory = lambda text: text.decode(errors="surrogateescape")
        for pragma in (
            "trusted_schema = OFF",
            "foreign_keys = ON",
            "cell_size_check = ON",
            "synchronous = FULL",
            f"wal_autocheckpoint = {_CHECKPOINT}",
            *([] if self.writable else ["query_only = ON"]),
        ):
            connection.execute(f"PRAGMA {pragma}")
        return connection

    def _mode(self) -> str:
        """Say how the file is to be opened.

        Readers open it for writing where they may, for only so can the last one to close it take
        the write-ahead log away. Where nothing can be written, nothing changes.
        """
        if os.access(self.path, os.W_OK) and os.access(self.path.parent, os.W_OK):
            return "mode=rw"
        if self.writable:
            raise OSError(errno.EACCES, os.strerror(errno.EACCES), str(self.path))
        log = self.path.with_name(self.path.name + "-wal")
        with suppress(OSError):
            if log.stat().st_size:
                return "mode=ro"
        return "mode=ro&immutable=1"

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """See the library as it is now until the end, whatever others write meanwhile."""
        with self._told():
            connection = self.connection
            if connection.in_transaction:
                yield connection
                return
            connection.execute("BEGIN")
            try:
                yield connection
            finally:
                _end(connection, "ROLLBACK")

    @contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """Write all that is written until the end, or nothing.

        Raises
        ------
        BusyError
            When another process writes for too long.

        """
        if not self.writable:
            raise ParameterError(
                "the library is open for reading only", file=str(self.path), expected="mode 'a'"
            )
        with self.writing_lock, self._told():
            connection = self.connection
            if connection.in_transaction:
                yield connection
                return
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.execute("COMMIT")
            finally:
                _end(connection, "ROLLBACK")

    def close(self) -> None:
        """Close all connections; the last one writes the log back and takes it away.

        What another thread is writing just now is written first.
        """
        with self.writing_lock:
            self._close()

    def _close(self) -> None:
        if self._closed:
            return
        mine = self._pid == os.getpid()
        self._closed = True
        if not mine:
            _inherited.extend([*self._all, self._own])
            return
        for connection in self._all:
            connection.close()

    @contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            if isinstance(error, sqlite3.ProgrammingError | sqlite3.InterfaceError):
                raise
            self.tell(error)

    def tell(self, error: sqlite3.Error) -> NoReturn:
        """Raise what an error of SQLite means to a user."""
        code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF
        file = str(self.path)
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise BusyError(
                "another process is writing to this library",
                file=file,
                expected=f"it to be done within {self.wait:g} s",
            ) from error
        system = _SYSTEM.get(code)
        if system is not None:
            raise OSError(system, os.strerror(system), file) from error
        if code == sqlite3.SQLITE_NOMEM:
            raise MemoryError from error
        if code == sqlite3.SQLITE_TOOBIG:
            raise UnsupportedError("too large for a library", file=file) from error
        raise CorruptError(f"the library is damaged ({error})", file=file) from error


_SYSTEM = {
    sqlite3.SQLITE_FULL: errno.ENOSPC,
    sqlite3.SQLITE_IOERR: errno.EIO,
    sqlite3.SQLITE_READONLY: errno.EACCES,
    sqlite3.SQLITE_PERM: errno.EACCES,
    sqlite3.SQLITE_CANTOPEN: errno.EACCES,
}


def create(path: Path, *, indexed: bool = True) -> None:
    """Make a library without clips.

    Parameters
    ----------
    path
        Of the file.
    indexed
        Whether clips are indexed for search when they are added, unless said otherwise then.

    Raises
    ------
    ExistsError
        When the file exists.

    """
    write_whole(path, schema.empty(indexed=indexed))


def _end(connection: sqlite3.Connection, statement: str) -> None:
    """End a transaction that is still open, without hiding why it ends."""
    if connection.in_transaction:
        with suppress(sqlite3.Error):
            connection.execute(statement)
