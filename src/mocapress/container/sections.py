"""Sections with checksums, of which ``.mcz`` and ``.mcm`` files are made."""

import zlib
from typing import NamedTuple

from mocapress.errors import CorruptError, UnsupportedError
from mocapress.records import Reader, Writer

MAY_BE_SKIPPED = 0x80
"""The bit of a tag that lets readers pass over a section that they do not know."""
CHECKSUM = 4
LEAST = 1 + 1 + CHECKSUM
"""Bytes of an empty section."""


class Section(NamedTuple):
    """A section of a file."""

    tag: int
    begin: int
    """Byte offset of its tag."""
    end: int
    """Byte offset behind its checksum."""
    content: bytes
    sound: bool
    """Whether its checksum is right."""


def read_magic(reader: Reader, magic: bytes, version: int, other: str) -> None:
    """Take a file's first five bytes; ``other`` says what is wrong where they are no such file's.

    Raises
    ------
    CorruptError
        When it is not such a file.
    UnsupportedError
        When it is of a later version.

    """
    if bytes(reader.data[: len(magic)]) != magic:
        raise CorruptError(other)
    reader.raw(len(magic))
    number = reader.raw(1)[0]
    if number != version:
        raise UnsupportedError(
            "version of the file", offset=len(magic), expected=str(version), found=str(number)
        )


def section(tag: int, content: bytes) -> bytes:
    """Make a section: tag, length, content, checksum."""
    writer = Writer()
    writer.data.append(tag)
    writer.bytes(content)
    return bytes(writer.data) + zlib.crc32(writer.data).to_bytes(CHECKSUM, "little")


def next_section(reader: Reader, begin: int = 0) -> Section:
    """Take a section, sound or not; ``begin`` is the offset of the reader's data in the file.

    Raises
    ------
    CorruptError
        When it is cut off.

    """
    start = reader.position
    tag = reader.raw(1)[0]
    content = reader.bytes()
    checksum = zlib.crc32(reader.data[start : reader.position])
    sound = checksum == int.from_bytes(reader.raw(CHECKSUM), "little")
    return Section(tag, begin + start, begin + reader.position, content, sound)


def checked(found: Section, name: str) -> bytes:
    """Give a section's content.

    Raises
    ------
    CorruptError
        When its checksum is wrong.

    """
    if not found.sound:
        raise CorruptError(f"{name}: wrong checksum", offset=found.begin)
    return found.content


def read_section(reader: Reader, tag: int, name: str) -> bytes:
    """Take the content of a section that must be of this tag.

    Raises
    ------
    CorruptError
        When it is another, cut off, or its checksum is wrong.

    """
    found = next_section(reader)
    if found.tag != tag:
        raise CorruptError(
            f"{name}: another section stands here",
            offset=found.begin,
            expected=f"{tag:02x}",
            found=f"{found.tag:02x}",
        )
    return checked(found, name)
