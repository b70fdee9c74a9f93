"""Sections with checksums, of which ``.mcz`` and ``.mcm`` files are made."""

import zlib

from mocapress.errors import CorruptError, UnsupportedError
from mocapress.records import Reader, Writer


def read_magic(reader: Reader, magic: bytes, version: int, name: str) -> None:
    """Take a file's first five bytes.

    Raises
    ------
    CorruptError
        When it is not such a file.
    UnsupportedError
        When it is of a later version.

    """
    found = bytes(reader.data[: len(magic)])
    if found != magic:
        raise CorruptError(f"not an {name} file", offset=0, expected=magic.hex(), found=found.hex())
    reader.raw(len(magic))
    number = reader.raw(1)[0]
    if number != version:
        raise UnsupportedError(
            "version of the file", offset=len(magic), expected=str(version), found=str(number)
        )


def section(number: int, content: bytes) -> bytes:
    """Make a section: number, content, checksum."""
    writer = Writer()
    writer.integer(number)
    writer.bytes(content)
    return bytes(writer.data) + zlib.crc32(writer.data).to_bytes(4, "little")


def read_section(reader: Reader, last: int) -> tuple[int, bytes]:
    """Take a section numbered 1 to ``last``: its number and its content."""
    start = reader.position
    number = reader.raw(1)[0]
    if not 1 <= number <= last:
        raise reader.fail(f"section {number} is not known")
    content = reader.bytes()
    found = zlib.crc32(reader.data[start : reader.position])
    expected = int.from_bytes(reader.raw(4), "little")
    if found != expected:
        raise CorruptError(
            f"section {number}: wrong checksum",
            offset=start,
            expected=f"{expected:08x}",
            found=f"{found:08x}",
        )
    return number, content
