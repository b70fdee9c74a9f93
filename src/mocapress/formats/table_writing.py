"""Clips written as plain tables: CSV, and what Parquet and NumPy's files share with it."""

import csv
import io
from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import UnsupportedError
from mocapress.formats.number_formats import SHORTEST, printed
from mocapress.motion import Clip, Stream

Values = NDArray[np.float64]


class Counted(NamedTuple):
    """What stands before the numbers of a row."""

    frame: NDArray[np.int64]
    """From the number of the first frame on."""
    time: Values | None
    """Seconds since the first frame; None where the frame time is not known."""


def counted(clip: Clip, stream: Stream) -> Counted:
    """Count the rows of a stream; of one that is faster than the first, its samples."""
    alike = stream.frames == clip.frames
    first = int(clip.metadata.get("first_frame", "1")) if alike else 1
    rows = np.arange(stream.frames, dtype=np.int64)
    if not stream.frame_time:
        return Counted(rows + first, None)
    time = Fraction(stream.frame_time)
    times: Values = rows.astype(np.float64) * float(time.numerator) / float(time.denominator)
    return Counted(rows + first, times)


def files(suffix: str, clip: Clip, of_stream: Callable[[Stream], bytes]) -> dict[str, bytes]:
    """Give a file for each stream: ``.csv`` for the first, ``.analog.csv`` and so on beside it."""
    main = next(iter(clip.streams))
    return {
        suffix if name == main else f".{name}{suffix}": of_stream(stream)
        for name, stream in clip.streams.items()
    }


def with_frames(clip: Clip) -> Clip:
    """Refuse a clip without frames.

    Raises
    ------
    UnsupportedError
        When there are none.

    """
    if not clip.frames:
        raise UnsupportedError("no frames to be written")
    return clip


def write_csv(clip: Clip) -> dict[str, bytes]:
    """Print streams as CSV: a line of names, then rows of frame, time and values.

    Numbers are printed as their source printed them, or with the digits that give the same double
    again; what is missing is blank.
    """

    def of_stream(stream: Stream) -> bytes:
        count = counted(clip, stream)
        names = ["frame", *([] if count.time is None else ["time"])]
        cells = [[str(frame).encode() for frame in count.frame.tolist()]]
        if count.time is not None:
            cells.append(printed(count.time, SHORTEST))
        for column, numbers in zip(stream.columns, stream.values.T, strict=True):
            names.append(column.name)
            cells.append(blank(printed(numbers, column.decimal or SHORTEST), numbers))
        head = io.StringIO()
        csv.writer(head, lineterminator="\n").writerow(names)
        rows = b"".join(b",".join(row) + b"\n" for row in zip(*cells, strict=True))
        return head.getvalue().encode() + rows

    return files(".csv", clip, of_stream)


def blank(cells: list[bytes], numbers: Values) -> list[bytes]:
    """Give cells of which those that are missing are blank."""
    for row in np.flatnonzero(np.isnan(numbers)).tolist():
        cells[row] = b""
    return cells
