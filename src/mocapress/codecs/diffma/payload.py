"""The codec's header and payloads in a ``.mcz`` (docs/format.md).

A payload is text, packed: a line of opcodes for each channel, then a line of each look-up table.
"""

import lzma
import struct
from collections.abc import Sequence
from itertools import groupby
from math import inf

import numpy as np

from mocapress.codecs.diffma.coding import MOST_ORDER, Plan, Record
from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer

# What a sample can cost: NEG and two characters, and a number as text with what parts it.
_MOST_BYTES = 32
_FILTERS = [
    {
        "id": lzma.FILTER_LZMA2,
        "preset": 9 | lzma.PRESET_EXTREME,
        "dict_size": 1 << 20,
        "lc": 4,
        "lp": 0,
        "pb": 0,
    }
]


def pack_header(plans: Sequence[Plan]) -> bytes:
    """Make the header: bound and order of all channels, in runs of equal neighbours."""
    writer = Writer()
    for (bound, order), group in groupby((plan.bound, plan.order) for plan in plans):
        writer.data += struct.pack("<d", bound)
        writer.integer(order)
        writer.integer(len(list(group)))
    return bytes(writer.data)


def unpack_header(header: bytes, channels: int) -> list[Plan]:
    """Read a header of ``channels`` channels.

    Raises
    ------
    CorruptError
        When it is malformed.

    """
    reader = Reader(header, "DiffMA header")
    plans: list[Plan] = []
    while len(plans) < channels:
        (bound,) = struct.unpack("<d", reader.raw(8))
        order, count = reader.integer(MOST_ORDER), reader.integer(channels - len(plans))
        if not 0 < bound < inf or not count:
            raise reader.fail("no bound above 0, or of no channels")
        plans += [Plan(bound, order)] * count
    reader.end()
    return plans


def pack_payload(records: Sequence[Record]) -> bytes:
    """Make the payload of a chunk."""
    tables = [" ".join(map(number_text, record.table.tolist())).encode() for record in records]
    text = b"\n".join([*(record.opcodes for record in records), *tables])
    return lzma.compress(text, lzma.FORMAT_RAW, filters=_FILTERS)


def unpack_payload(payload: bytes, channels: int, frames: int) -> list[Record]:
    """Read the payload of this many channels and frames; its opcodes are not checked.

    Raises
    ------
    CorruptError
        When it is malformed.

    """
    most = _MOST_BYTES * channels * frames
    decoder = lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=_FILTERS)
    try:
        text = decoder.decompress(payload, max_length=most + 1)
    except lzma.LZMAError as error:
        raise CorruptError(f"DiffMA payload: cannot be unpacked ({error})") from error
    if len(text) > most or not decoder.eof or decoder.unused_data:
        raise CorruptError("DiffMA payload: cut off or too long")
    lines = text.split(b"\n") if channels else []
    if len(lines) != 2 * channels:
        raise CorruptError(
            "DiffMA payload: lines", expected=str(2 * channels), found=str(len(lines))
        )
    try:
        tables = [np.array(line.split(b" "), dtype=np.float64) for line in lines[channels:]]
    except ValueError as error:
        raise CorruptError(f"DiffMA payload: {error}") from error
    return [Record(*pair) for pair in zip(lines, tables, strict=False)]


def number_text(value: float) -> str:
    """Give the shortest decimal of the same value, whole numbers without a point."""
    text = repr(value)
    return text.removesuffix(".0")
