"""Texts in UTF-16, which are read as UTF-8 and stored as what they are."""

import codecs
from typing import NamedTuple

from mocapress import _core
from mocapress.errors import CorruptError

MARKS = {"utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE}
"""By encoding, the byte order mark with which such a file begins."""


class FileText(NamedTuple):
    """A file's bytes as they are read."""

    data: bytes
    """The file's own, or UTF-8 of a file in UTF-16."""
    encoding: str = ""
    """One of ``MARKS``, or empty."""

    @classmethod
    def of(cls, data: bytes) -> "FileText":
        """Read a file in UTF-16 as UTF-8; any other as it is."""
        text = _core.from_utf16(data)
        if text is None:
            return cls(data)
        return cls(text, next(name for name, mark in MARKS.items() if data.startswith(mark)))

    def offset(self, offset: int | None) -> int | None:
        """Give the byte offset in the file of one in ``data``."""
        if not self.encoding or offset is None:
            return offset
        before = self.data[:offset].decode("utf-8", "ignore")
        return len(MARKS[self.encoding]) + len(before.encode(self.encoding))


def encoded(data: bytes, encoding: str) -> bytes:
    """Give a file's bytes from those that were read.

    Raises
    ------
    CorruptError
        When they are not UTF-8.

    """
    return MARKS.get(encoding, b"") + recoded(data, encoding)


def recoded(data: bytes, encoding: str) -> bytes:
    """Give a part of a file, without the mark at its beginning, from what was read.

    Raises
    ------
    CorruptError
        When it is not UTF-8.

    """
    if not encoding:
        return data
    try:
        return data.decode("utf-8").encode(encoding)
    except UnicodeDecodeError:
        raise CorruptError("the layout makes no text") from None


def head_as_utf8(head: bytes) -> bytes:
    """Give the beginning of a file as UTF-8 where it is UTF-16."""
    return head.decode("utf-16", "ignore").encode() if head[:2] in MARKS.values() else head
