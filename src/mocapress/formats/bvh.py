"""BVH: a skeleton and its motion in one file, one line per frame."""

import re
from functools import partial
from itertools import islice

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats.bvh_hierarchy import Hierarchy, format_hierarchy, parse_hierarchy
from mocapress.formats.contract import Format, Split, split_of
from mocapress.formats.layout import Slot, build, print_clip
from mocapress.formats.problems import EXTRA_ROWS, MISSING_ROWS, Problem
from mocapress.formats.rows import (
    Body,
    Reading,
    RowShape,
    after_rows,
    bytes_after_end,
    is_padding,
    line_of,
    read_all,
    read_rows,
    unreadable,
)
from mocapress.motion import Clip, Skeleton
from mocapress.motion.clip import decimal_seconds
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.convert import to_bvh_clip

_TOKEN = re.compile(rb"\S+")


def split(data: bytes, _skeleton: Skeleton | None = None, file: str | None = None) -> Split:
    """Take a BVH apart; it has its skeleton in itself."""
    body, hierarchy, lines, problems = read_body(data, file)
    columns = skeleton_columns(hierarchy.skeleton)
    clip = Clip.of(body.values, columns, hierarchy.frame_time, hierarchy.skeleton)
    slots, texts = partial(slots_of_row, lines=lines), partial(texts_of_row, lines=lines)
    return split_of(clip, build("bvh", data, body, slots, texts), problems, file)


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip."""
    if clip.skeleton is None:
        raise UnsupportedError("a BVH file needs a skeleton")
    if clip.frame_time is None:
        raise UnsupportedError("a BVH file needs a frame time")
    header = format_hierarchy(clip.skeleton, clip.frames, decimal_seconds(clip.frame_time))
    literals = [b"", *[b" "] * (clip.channels - 1), b"\n"]
    return {".bvh": print_clip(clip, header, literals, counter=False)}


def read_body(data: bytes, file: str | None = None) -> tuple[Body, Hierarchy, int, list[Problem]]:
    """Read the frames, however many there are, and say how many lines each takes.

    Raises
    ------
    FormatError
        When the hierarchy cannot be read.

    """
    hierarchy = parse_hierarchy(data, file)
    channels = sum(len(joint.channels) for joint in hierarchy.skeleton.joints)
    if channels == 0:
        raise FormatError("no channels", file=file, expected="a joint with CHANNELS")
    shape = _row_shape(data, hierarchy, channels)
    reading = read_all(data, hierarchy.rows_begin, shape, lambda at: _next_line(data, at))
    body = reading.body or read_rows(data, hierarchy.rows_begin, shape, 0)
    lines = len(shape.counts)
    expected = f"{channels} numbers on {'a line' if lines == 1 else f'{lines} lines'}"
    return body, hierarchy, lines, _problems(data, reading, body, hierarchy.frames, expected)


def _row_shape(data: bytes, hierarchy: Hierarchy, channels: int) -> RowShape:
    """Say how many numbers stand on a line: all of a frame, unless all frames wrap alike."""
    one = RowShape(False, (b"",), (channels,))
    begin = hierarchy.rows_begin
    if len(read_rows(data, begin, one, 1).values):
        return one
    counts: list[int] = []
    for line in re.compile(rb"[^\n]+").finditer(data, begin):
        words = line.group().split()
        if words and not words[0].startswith(b"#"):
            counts.append(len(words))
        if sum(counts) >= channels:
            break
    if sum(counts) != channels or len(counts) < 2:
        return one
    wrapped = RowShape(False, (b"",) * len(counts), tuple(counts))
    needed = min(max(hierarchy.frames, 1), 2)
    return wrapped if len(read_rows(data, begin, wrapped, needed).values) == needed else one


def _next_line(data: bytes, begin: int) -> int:
    end = data.find(b"\n", begin)
    return len(data) if end < 0 else end + 1


def _problems(
    data: bytes, reading: Reading, body: Body, declared: int, expected_row: str
) -> list[Problem]:
    found, rest = len(body.values), after_rows(data, body)
    problems = []
    # Where as many frames as declared were read, what is no row is none that is missing.
    more = found > declared and rest[:1] in b"+-.0123456789"
    cut = bool(rest) and not is_padding(rest) and (found < declared or more)
    if reading.stops or cut:
        problems.append(unreadable(data, reading, lambda _: expected_row, cut=cut))
    if found + cut < declared:
        expected = f"{declared} frames, as declared"
        problems.append(
            Problem.of(MISSING_ROWS, "frames are missing", expected=expected, found=str(found))
        )
    if found > declared:
        offset = int(body.offsets[declared])
        line, expected = line_of(data, offset), f"{declared} frames"
        what = "more frames than declared"
        problems.append(Problem.of(EXTRA_ROWS, what, line, offset, expected, str(found)))
    if rest and not cut:
        problems.append(bytes_after_end(data, body))
    return problems


def slots_of_row(text: bytes, lines: int = 1) -> list[Slot]:
    """Find the numbers in the bytes of a row of so many lines."""
    tokens = _TOKEN.finditer(text, 0, _end_of_numbers(text, lines))
    return [(column, *token.span()) for column, token in enumerate(tokens)]


def texts_of_row(text: bytes, lines: int = 1) -> list[bytes]:
    """Give the numbers in the bytes of a row of so many lines as they are written."""
    return text[: _end_of_numbers(text, lines)].split()


def _end_of_numbers(text: bytes, lines: int) -> int:
    if text.lstrip()[:1] == b"#":
        return len(text)
    ends = [found.start() for found in islice(re.finditer(rb"\n", text), lines)]
    return ends[-1] if len(ends) == lines else len(text)


FORMAT = Format(
    id="bvh",
    name="BVH",
    suffixes=(".bvh",),
    recognises=lambda head: head[:9].upper() == b"HIERARCHY",
    split=split,
    fit=to_bvh_clip,
    write=write,
)
