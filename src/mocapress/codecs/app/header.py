"""The codec's header: parent and precision of every column, as bytes.

Two lists, parents and then precisions, each as runs: a value and how many columns share it, until
all columns are told. A parent is told by its distance: 0 for none, 2d for a parent d columns before
and 2d - 1 for one d columns after. A precision is 0 for float64, 1 for float32, 2 for float32
snapped to the column's decimal grid.
"""

from collections.abc import Sequence

from mocapress.records import Reader, Writer

PRECISIONS = 3


def pack_header(parents: Sequence[int], precisions: Sequence[int]) -> bytes:
    """Make the header of columns with these parents (-1 for none) and precisions."""
    writer = Writer()
    write_parents(writer, parents)
    writer.runs(precisions)
    return bytes(writer.data)


def write_parents(writer: Writer, parents: Sequence[int]) -> None:
    """Append the parent of each column."""
    writer.runs([_distance(column, parent) for column, parent in enumerate(parents)])


def read_parents(reader: Reader, columns: int) -> list[int]:
    """Take the parents of so many columns off.

    Raises
    ------
    CorruptError
        When they are no columns.

    """
    distances = reader.runs(columns, 2 * columns).tolist()
    parents = [_parent(column, distance) for column, distance in enumerate(distances)]
    if any(not -1 <= parent < columns for parent in parents):
        raise reader.fail("a parent that is no column")
    return parents


def unpack_header(header: bytes, columns: int) -> tuple[list[int], list[int]]:
    """Give the parents and precisions of as many columns.

    Raises
    ------
    CorruptError
        When the header is not one that ``pack_header`` makes for as many columns.

    """
    reader = Reader(header, "APP header")
    parents = read_parents(reader, columns)
    precisions = reader.runs(columns, PRECISIONS - 1).tolist()
    reader.end()
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
