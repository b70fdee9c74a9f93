"""Lists of few different numbers come back, take few bytes, and lies about them are found out."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapress.codecs.palette import read_palette, write_palette
from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer


def packed(values: list[int]) -> bytes:
    writer = Writer()
    write_palette(writer, values)
    return bytes(writer.data)


@given(st.lists(st.sampled_from([0, 3, 200, 2**40]) | st.integers(0, 2**60)))
def test_they_come_back(values: list[int]) -> None:
    reader = Reader(packed(values), "list")
    assert read_palette(reader, len(values), 2**60) == values
    reader.end()


@pytest.mark.parametrize(
    ("values", "data"),
    [
        ([], b"\x00"),
        ([7] * 1000, b"\x01\x07"),
        ([7, 7, 9, 7], b"\x02\x07\x09\x04\x03\x00"),
    ],
)
def test_they_take_few_bytes(values: list[int], data: bytes) -> None:
    assert packed(values) == data


@pytest.mark.parametrize(
    "data",
    [
        b"\x00",  # nothing to choose from
        b"\x05\x01\x02\x03\x04\x05",  # more than there are entries
        b"\x02\x07\x09\x08",  # four and more of them
        b"\x02\x07\x09\x02",  # cut off
        b"\x01\x63",  # more than may stand there
    ],
)
def test_lies_are_found_out(data: bytes) -> None:
    with pytest.raises(CorruptError):
        read_palette(Reader(data, "list"), 4, 50)
