"""The codec's header: parent and precision of every column, as bytes.

Two lists, parents and then precisions, each as runs: a varint value and a varint number of columns
that share it, until all columns are told. A parent is told by its distance: 0 for none, 2d for a
parent d columns before and 2d - 1 for one d columns after. A precision is 0 for float64, 1 for
float32, 2 for float32 snapped to the column's decimal grid.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby

from mocapress.errors import CorruptError

PRECISIONS = 3
_VARINT_BYTES = 5


def pack_header(parents: Sequence[int], precisions: Sequence[int]) -> bytes:
    """Make the header of columns with these parents (-1 for none) and precisions."""
    distances = [_distance(column, parent) for column, parent in enumerate(parents)]
    return _pack_runs(distances) + _pack_runs(precisions)


def unpack_header(header: bytes, columns: int) -> tuple[list[int], list[int]]:
    """Give the parents and precisions of as many columns.

    Raises
    ------
    CorruptError
        When the header is not one that ``pack_header`` makes for as many columns.

    """
    numbers = _varints(header)
    distances = _unpack_runs(numbers, columns)
    precisions = _unpack_runs(numbers, columns)
    if next(numbers, None) is not None:
        raise CorruptError("APP header is too long")
    if any(precision >= PRECISIONS for precision in precisions):
        raise CorruptError("APP header has an unknown precision")
    parents = [_parent(column, distance) for column, distance in enumerate(distances)]
    if any(not -1 <= parent < columns for parent in parents):
        raise CorruptError("APP header has a parent that is no column")
    return parents, precisions


def _distance(column: int, parent: int) -> int:
    if parent < 0:
        return 0
    return 2 * (column - parent) if parent < column else 2 * (parent - column) - 1


def _parent(column: int, distance: int) -> int:
    if distance == 0:
        return -1
    half = (distance + 1) // 2
    # A parent before the first column would read as "none".
    parent = column + half if distance % 2 else column - half
    return parent if parent >= 0 else -2


def _pack_runs(values: Sequence[int]) -> bytes:
    packed = bytearray()
    for value, run in groupby(values):
        for number in (value, sum(1 for _ in run)):
            rest = number
            while rest >= 0x80:
                packed.append(rest & 0x7F | 0x80)
                rest >>= 7
            packed.append(rest)
    return bytes(packed)


def _unpack_runs(numbers: Iterator[int], count: int) -> list[int]:
    values: list[int] = []
    while len(values) < count:
        value, run = next(numbers, 0), next(numbers, 0)
        if not 0 < run <= count - len(values):
            raise CorruptError("APP header does not describe the columns")
        values.extend([value] * run)
    return values


def _varints(data: bytes) -> Iterator[int]:
    number = shift = 0
    for byte in data:
        number |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            yield number
            number = shift = 0
        elif shift == 7 * _VARINT_BYTES:
            raise CorruptError("APP header has a number that is too long")
    if shift:
        raise CorruptError("APP header is cut off")
