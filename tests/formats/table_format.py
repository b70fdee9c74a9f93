"""A format as another package would bring it: the height of a point, one number a line.

    TABLE 50
    1.25
    1.5

The first line says how many numbers there are in a second.
"""

import re
from dataclasses import replace
from fractions import Fraction

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats.contract import Format, Split, split_of
from mocapress.formats.layout import build, print_clip
from mocapress.formats.problems import UNREADABLE_ROWS, Problem
from mocapress.formats.rows import read_rows
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.columns import skeleton_columns

_HEADER = re.compile(rb"TABLE (\d+)\n")
_POINT = Skeleton((Joint("point", -1, channels=("ty",)),))


def split(data: bytes, _skeleton: Skeleton | None, file: str | None) -> Split:
    header = _HEADER.match(data)
    if header is None:
        raise FormatError("no table", file=file, line=1, expected="TABLE and a rate")
    body = read_rows(data, header.end(), 1)
    problems = []
    if data[int(body.offsets[-1]) :].strip():
        problems.append(Problem.of(UNREADABLE_ROWS, "not a number"))
    clip = Clip.of(body.values, skeleton_columns(_POINT), 1 / Fraction(int(header[1])), _POINT)
    layout = build("table", data, body, lambda row: [(0, 0, len(row.rstrip()))])
    return split_of(clip, layout, problems, file)


def fit(clip: Clip) -> Clip:
    heights = [i for i, column in enumerate(clip.columns) if column.kind == "ty"]
    if not heights:
        raise UnsupportedError("a table needs a height")
    values = clip.values[:, heights[:1]]
    (column,) = skeleton_columns(_POINT)
    column = replace(column, decimal=clip.columns[heights[0]].decimal)
    return Clip.of(values, (column,), clip.frame_time, _POINT, clip.name)


def write(clip: Clip) -> dict[str, bytes]:
    if clip.frame_time is None:
        raise UnsupportedError("a table needs a frame time")
    header = f"TABLE {round(1 / clip.frame_time)}\n".encode()
    return {".tbl": print_clip(clip, header, [b"", b"\n"], counter=False)}


FORMAT = Format(
    id="table",
    name="table",
    suffixes=(".tbl",),
    recognises=lambda head: bool(_HEADER.match(head)),
    split=split,
    fit=fit,
    write=write,
)
