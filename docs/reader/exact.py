"""The codec ``exact`` (docs/format/exact.md)."""

import exact_fast
from exact_header import Header, read_model
from exact_model import Part
from exact_tables import Told
from records import Record
from streams import Coded

PART = 1024


def decode(
    header: bytes,
    parameters: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
    model: bytes = b"",
) -> list[list[float]]:
    """Give the rows of chunks; there are as many columns as ``formats``."""
    record = Record(header)
    told = Header(record, len(formats))
    beside = Told(record, len(formats))
    record.end()
    level = told.level or int(parameters.get("level", "5"))
    lists = read_model(model) if told.learned else {}
    rows: list[list[float]] = []
    for frames, packed in chunks:
        payload, masks = beside.unpack(packed, frames)
        coded: list[list[float]] = [[] for _ in range(frames)]
        if told.columns and level < 6:
            coded = exact_fast.decode(payload, frames, told.columns, told.couplings, level)
        elif told.columns:
            stream = Coded(payload)
            for start in range(0, len(told.columns), PART):
                end = min(start + PART, len(told.columns))
                part = Part(stream, level, *told.part(start, end), told.skeleton == 1, lists)
                for frame in range(frames):
                    coded[frame] += part.frame(first=frame == 0)
            stream.end()
        for frame, numbers in enumerate(coded):
            rows.append(beside.restored(told.row(numbers), [mask[frame] for mask in masks]))
    return rows
