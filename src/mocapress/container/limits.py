"""What a reader refuses, because no writer makes it: docs/format.md, section "Limits".

Nothing is allocated because a file announces it, before these hold.
"""

from mocapress.errors import CorruptError

STREAMS = 2**8
PARAMETERS = 2**6
JOINTS = 2**16
ENDS = 2**17
"""End sites of a skeleton."""
COLUMNS = 2**18
"""Of all streams together; also channels of a skeleton."""
FACTS = 2**12
"""About a skeleton, or notes."""
PROBLEMS = 1000
UNPACKED = 2**24
"""Bytes of a head, or of notes."""


def most_values(length: int) -> int:
    """Give how many numbers a file of so many bytes may hold."""
    return 2**22 + 2**12 * length


def most_original(length: int) -> int:
    """Give how large a file may be that is packed in one of so many bytes."""
    return 2**24 + 2**14 * length


def most_layout(size: int, packed: int) -> int:
    """Give how large the layout of a file of so many bytes may be, packed in so many."""
    return min(2 * size + 2**20, 2**24 + 2**8 * packed)


def most_companions(length: int) -> int:
    """Give how large all companions in a file of so many bytes may be together."""
    return 2**24 + 2**8 * length


def most_printed(size: int, values: int) -> int:
    """Give how large a file may become when so many decoded numbers are printed in its layout."""
    return size + 32 * values + 2**16


def most_json(packed: int) -> int:
    """Give how large a DiffMA JSON may be that is packed in so many bytes."""
    return 2**24 + 2**5 * packed


def most_json_parts(length: int) -> int:
    """Give how many numbers, texts and lists may be in a DiffMA JSON of so many bytes.

    Each becomes an object of 50 to 100 bytes in memory. Documents of short clips have one in 6
    bytes, but only one in 16 where there are more than a million.
    """
    return 2**20 + length // 16


def check_values(values: int, length: int) -> None:
    """See that a file of so many bytes may hold so many numbers.

    Raises
    ------
    CorruptError
        When it may not.

    """
    if values > most_values(length):
        raise CorruptError(
            "too many numbers announced",
            expected=f"at most {most_values(length)} in {length} bytes",
            found=str(values),
        )
