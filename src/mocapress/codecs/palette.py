"""Lists of numbers, one for each of some columns, of which few differ: a palette and runs.

How many differ, and these; then, where it is more than one, the runs of equal neighbours, an
integer each: index in the palette + how many differ x length. The last run's length is 0, for "all
that are left".
"""

from collections.abc import Hashable, Sequence
from itertools import groupby
from typing import TypeVar

from mocapress.records import Reader, Writer

T = TypeVar("T", bound=Hashable)


def write_palette(writer: Writer, values: Sequence[int]) -> None:
    """Append a list of unsigned integers."""
    palette, indices = indexed(values)
    writer.integer(len(palette))
    for value in palette:
        writer.integer(value)
    write_indices(writer, indices, len(palette))


def read_palette(reader: Reader, count: int, most: int) -> list[int]:
    """Take a list of so many integers of at most ``most``."""
    palette = [reader.integer(most) for _ in range(reader.integer(min(count, reader.left)))]
    return [palette[index] for index in read_indices(reader, count, len(palette))]


def indexed(values: Sequence[T]) -> tuple[list[T], list[int]]:
    """Give the different values in order of appearance, and of each value its index among them."""
    places: dict[T, int] = {}
    indices = [places.setdefault(value, len(places)) for value in values]
    return list(places), indices


def write_indices(writer: Writer, indices: Sequence[int], size: int) -> None:
    """Append the runs of indices into a palette of so many values."""
    if size < 2:
        return
    runs = [(index, sum(1 for _ in run)) for index, run in groupby(indices)]
    for index, length in runs[:-1]:
        writer.integer(index + size * length)
    writer.integer(runs[-1][0])


def read_indices(reader: Reader, count: int, size: int) -> list[int]:
    """Take the runs of so many indices into a palette of ``size`` values.

    Raises
    ------
    CorruptError
        When the runs are not so many, or there is no palette.

    """
    if size < 2:
        if count and not size:
            raise reader.fail("an empty palette")
        return [0] * count
    indices: list[int] = []
    while len(indices) < count:
        length, index = divmod(reader.integer(size * count - 1), size)
        left = count - len(indices)
        if length >= left:
            raise reader.fail(f"a run of {length} where {left} are left")
        indices += [index] * (length or left)
    return indices
