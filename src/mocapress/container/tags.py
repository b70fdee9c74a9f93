"""What a ``.mcz`` file begins with, and the tags of its sections."""

from enum import IntEnum

MAGIC = b"\x89MCZ"
VERSION = 1


class Tag(IntEnum):
    """The sections that this version knows."""

    HEAD = 0x01
    FILE = 0x02
    CHUNK = 0x03
    END = 0x04
    NOTES = 0x81
    COMPANION = 0x82
