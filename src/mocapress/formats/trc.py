"""TRC: marker trajectories as a table, of Motion Analysis and those who came after."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats.contract import Format, Near, Split
from mocapress.formats.number_formats import SHORTEST, printed
from mocapress.formats.problems import EXTRA_ROWS, MISSING_ROWS, Problem
from mocapress.formats.table_layout import SERIES, TableLayout, read_layout
from mocapress.formats.table_names import header_lines
from mocapress.formats.table_writing import blank, counted, with_frames
from mocapress.formats.tables import TABLE, full_values, stream_of
from mocapress.formats.tables import split as split_table
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.columns import distinct
from mocapress.motion.frame_time import rate_of, short_decimal
from mocapress.motion.markers import POINTS

Values = NDArray[np.float64]

_BEFORE = 2
"""Columns before the markers: the frame's number and the time."""
_WORDS = ("x", "y", "z")


def split(data: bytes, skeleton: Skeleton | None, file: str | None) -> Split:
    """Take a file apart.

    Raises
    ------
    FormatError
        When there are no rows of numbers in it.

    """
    parts = split_table(data, skeleton, file, kind="trc")
    layout = parts.stored
    assert isinstance(layout, TableLayout)
    facts = _facts(layout)
    clip = parts.clip
    rate = rate_of(facts.get("DataRate", "").replace(",", "."))
    stream = clip.streams[TABLE]
    if rate is not None:
        stream = replace(stream, frame_time=1 / rate)
    clip = replace(clip, streams={POINTS: stream})
    return parts._replace(clip=clip, problems=(*parts.problems, *_problems(layout, facts)))


def _facts(layout: TableLayout) -> dict[str, str]:
    """Give what the header says: names in one line, values in the next."""
    lines = header_lines(layout)
    for names, values in pairwise(lines):
        if names[0] == "DataRate":
            return {name: value for name, value in zip(names, values, strict=False) if name}
    return {}


def _problems(layout: TableLayout, facts: dict[str, str]) -> list[Problem]:
    told = facts.get("NumFrames", "")
    if not told.isdigit() or int(told) == layout.rows:
        return []
    name = MISSING_ROWS if layout.rows < int(told) else EXTRA_ROWS
    what = "fewer rows than declared" if name == MISSING_ROWS else "more rows than declared"
    return [Problem.of(name, what, expected=told, found=str(layout.rows))]


def described(layout: Any, clip: Clip, _: Near) -> Clip:
    """Give the markers: x, y and z of each, with the names and the unit of the header."""
    stream = stream_of(clip, POINTS)
    values = full_values(layout, stream.values)
    lines = header_lines(layout)
    labels = next((line for line in reversed(lines) if line[0].startswith("Frame")), [])
    names = distinct(name for name in labels[_BEFORE:] if name)
    places = [place for place in sorted(values) if place >= _BEFORE]
    count = min(len(names) or len(places) // 3, len(places) // 3)
    if not count:
        raise FormatError("no markers in the table", expected="three columns for each")
    kept = places[: 3 * count]
    unit = _facts(layout).get("Units", "")
    columns = tuple(
        Column(
            f"{names[i // 3] if names else i // 3 + 1}.{_WORDS[i % 3]}", i // 3, _WORDS[i % 3], unit
        )
        for i in range(len(kept))
    )
    matrix = np.stack([values[place] for place in kept], axis=1)
    first = layout.columns[0].first if layout.columns[0].kind == SERIES else 1
    facts = {"first_frame": str(int(first))}
    streams = {POINTS: Stream(matrix, columns, stream.frame_time)}
    return replace(clip, streams=streams, metadata={**clip.metadata, **facts})


def fit(clip: Clip) -> Clip:
    """Give a clip of points alone.

    Raises
    ------
    UnsupportedError
        When it has none.

    """
    if POINTS not in clip.streams:
        raise UnsupportedError("a TRC needs points")
    return with_frames(replace(clip, streams={POINTS: clip.streams[POINTS]}, skeleton=None))


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip that was made to fit; missing points are blank."""
    stream = clip.streams[POINTS]
    count = counted(clip, stream)
    time = Fraction(stream.frame_time or 0)
    rate = str(short_decimal(1 / time)) if time else "0"
    labels = [column.name.rpartition(".")[0] for column in stream.columns[::3]]
    unit = stream.columns[0].unit or "mm"
    names = ("DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units")
    more = ("OrigDataRate", "OrigDataStartFrame", "OrigNumFrames")
    frames = str(stream.frames)
    lines = [
        ["PathFileType", "4", "(X/Y/Z)", f"{clip.name or 'clip'}.trc"],
        [*names, *more],
        [rate, rate, frames, str(len(labels)), unit, rate, str(count.frame[0]), frames],
        ["Frame#", "Time", *(cell for label in labels for cell in (label, "", ""))],
        ["", "", *(f"{axis}{i + 1}" for i in range(len(labels)) for axis in "XYZ")],
        [],
    ]
    head = "\n".join("\t".join(cells) for cells in lines) + "\n"
    times = np.zeros(stream.frames) if count.time is None else count.time
    cells = [[str(frame).encode() for frame in count.frame.tolist()], printed(times, SHORTEST)]
    cells += [blank(printed(numbers, SHORTEST), numbers) for numbers in stream.values.T]
    rows = b"".join(b"\t".join(row) + b"\n" for row in zip(*cells, strict=True))
    return {".trc": head.encode() + rows}


FORMAT = Format(
    id="trc",
    name="TRC",
    suffixes=(".trc",),
    recognises=lambda head: head[:12].strip(b'"').startswith(b"PathFileType"),
    split=split,
    fit=fit,
    write=write,
    read_layout=partial(read_layout, kind="trc"),
    describe=described,
)
