"""Lists of numbers, one for each column, in which equal neighbours stand together.

Each run is a value and the number of consecutive columns that have it; runs cover all columns.
"""

from collections.abc import Sequence
from itertools import groupby

from mocapress.records import Reader, Writer


def write_runs(writer: Writer, values: Sequence[int]) -> None:
    """Append such a list."""
    for value, run in groupby(values):
        writer.integer(value)
        writer.integer(sum(1 for _ in run))


def read_runs(reader: Reader, count: int, most: int) -> list[int]:
    """Take the list of so many columns, of values up to ``most``."""
    values: list[int] = []
    while len(values) < count:
        value, run = reader.integer(most), reader.integer(count - len(values))
        if run == 0:
            raise reader.fail("an empty run")
        values += [value] * run
    return values
