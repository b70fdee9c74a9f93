"""AMC: the motion of an Acclaim skeleton, one line per bone and frame."""

import re
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats.asf import asf_words, format_asf
from mocapress.formats.contract import Format, Split, split_of
from mocapress.formats.joint_names import decoded, words
from mocapress.formats.layout import Slot, build, print_clip
from mocapress.formats.number_formats import stated, to_state
from mocapress.formats.problems import Problem
from mocapress.formats.rows import (
    Body,
    Reading,
    RowShape,
    bytes_after_end,
    is_padding,
    read_all,
    read_rows,
    unreadable,
)
from mocapress.motion import Clip, Skeleton
from mocapress.motion.clip import FrameTime, short_decimal
from mocapress.motion.columns import bone_columns
from mocapress.motion.convert import to_amc_clip

# A line that holds a frame's number and nothing else.
_COUNTER = re.compile(rb"^[ \t]*-?\d+[ \t]*\r?$", re.MULTILINE)
_RATE = re.compile(rb"^[ \t]*:samples-per-second[ \t]+(\S+)", re.MULTILINE | re.IGNORECASE)
_MOST_LATER_BONES = 256
_TOKEN = re.compile(rb"\S+")
_KEYWORD = re.compile(rb"^\s*:(fully-specified|degrees|radians)\b", re.MULTILINE | re.IGNORECASE)


def split(data: bytes, skeleton: Skeleton | None = None, file: str | None = None) -> Split:
    """Take an AMC apart."""
    body, shape, problems = read_body(data, file)
    clip = clip_of(body.values, shape, data[: int(body.offsets[0])], skeleton)
    layout = build("amc", data, body, partial(slots_of_row, shape=shape))
    return split_of(clip, layout, problems, file)


def fit(clip: Clip) -> Clip:
    """Give the clip as an AMC has it; one without a skeleton is taken to be from an AMC."""
    return to_amc_clip(clip) if clip.skeleton else clip


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip, and its skeleton as the ASF beside it."""
    if not clip.values.size:
        raise UnsupportedError("an AMC needs frames", expected="1 frame of 1 channel at least")
    radians = any(column.unit == "rad" for column in clip.columns)
    header = format_header(clip.frame_time, "rad" if radians else "deg") + b"\n"
    literals = [b""]
    bones = _bone_words(clip)
    for i, column in enumerate(clip.columns):
        fresh = i == 0 or column.joint != clip.columns[i - 1].joint
        literals.append(f"\n{bones[column.joint]} ".encode() if fresh else b" ")
    literals.append(b"\n")
    files = {".amc": print_clip(clip, header, literals, counter=True)}
    return files | ({".asf": format_asf(clip.skeleton)} if clip.skeleton else {})


def _bone_words(clip: Clip) -> dict[int, str]:
    """Give the word of each joint, as the ASF of its skeleton has it."""
    if clip.skeleton is not None:
        return dict(enumerate(asf_words(clip.skeleton)))
    names = {column.joint: column.name.rpartition(".")[0] for column in clip.columns}
    return dict(zip(names, words(list(names.values()), frozenset()), strict=True))


def read_body(data: bytes, file: str | None = None) -> tuple[Body, RowShape, list[Problem]]:
    """Read the frames.

    A bone that a frame leaves out keeps its values of the frame before.

    Raises
    ------
    FormatError
        When not even one frame can be read.

    """
    first = _COUNTER.search(data)
    if first is None:
        raise FormatError("no frame", file=file, expected="a line with a frame's number")
    shape = _row_shape(data, first.start(), file)
    reading = _read_all(data, first.start(), shape)
    stop = reading.stops[0] if reading.stops else reading.end
    if stop is not None and _is_other_bone(data, stop, shape):
        shape = _with_later_bones(data, first.start(), shape)
        reading = _read_all(data, first.start(), shape)
    cut = reading.end is not None and not is_padding(data[int(reading.end.offsets[-1]) :])
    problems = []
    if reading.stops or cut:
        problems.append(unreadable(data, reading, lambda stop: _expected(stop, shape), cut=cut))
    if reading.body is None:
        raise problems[0].error(file) if problems else FormatError("no frame", file=file)
    if reading.end is not None and not cut:
        problems.append(bytes_after_end(data, reading.body))
    return reading.body, shape, problems


def _read_all(data: bytes, begin: int, shape: RowShape) -> Reading:
    return read_all(
        data,
        begin,
        shape,
        lambda at: _next_counter(data, at),
        lambda at, before: _partial_rows(data, at, shape, before),
    )


def _is_other_bone(data: bytes, stop: Body, shape: RowShape) -> bool:
    word = _TOKEN.match(data, min(stop.error_offset, len(data)))
    return word is not None and stop.stop != "number" and word.group() not in shape.words


def _with_later_bones(data: bytes, begin: int, shape: RowShape) -> RowShape:
    """Give the shape with all bones that any frame has, each behind the one it follows there."""
    bones = list(zip(shape.words, shape.counts, strict=True))
    known, place = set(shape.words), 0
    for line in re.compile(rb"[^\n]+").finditer(data, begin):
        words = line.group().split()
        if len(words) < 2 or words[0].startswith((b"#", b"\0", b"\x1a")):
            place = 0 if words else place
        elif words[0] in known:
            place = next((i for i, bone in enumerate(bones) if bone[0] == words[0]), place) + 1
        elif len(known) < len(shape.words) + _MOST_LATER_BONES:
            bones.insert(place, (words[0], len(words) - 1))
            known.add(words[0])
            place += 1
    return RowShape(True, tuple(word for word, _ in bones), tuple(count for _, count in bones))


def _next_counter(data: bytes, begin: int) -> int:
    """Give where the next frame begins, behind the one at an offset."""
    counter = _COUNTER.match(data, begin)
    following = _COUNTER.search(data, counter.end() if counter else begin)
    return following.start() if following else len(data)


def clip_of(
    body_values: NDArray[np.float64],
    shape: RowShape,
    header: bytes,
    skeleton: Skeleton | None,
    name: str = "",
) -> Clip:
    """Make the clip; angles are in the unit that the header names, else the skeleton's."""
    names = [decoded(word) for word in shape.words]
    if skeleton is not None:
        root = skeleton.joints[0].name
        is_root = [word.lower() == b"root" for word in shape.words]
        names = [root if here else name for here, name in zip(is_root, names, strict=True)]
    bones = list(zip(names, shape.counts, strict=True))
    radians = re.search(rb"^\s*:radians", header, re.MULTILINE | re.IGNORECASE)
    degrees = re.search(rb"^\s*:degrees", header, re.MULTILINE | re.IGNORECASE)
    angle_unit = "rad" if radians else "deg" if degrees else None
    columns = bone_columns(skeleton, bones, angle_unit)
    return Clip.of(body_values, columns, frame_time_of(header), skeleton, name)


def frame_time_of(header: bytes) -> Fraction | None:
    """Give the seconds per frame that a header states, if it does and they are a time."""
    found = _RATE.search(header)
    if found is None:
        return None
    rate = stated(found[1])
    return 1 / Fraction(rate) if rate else None


def format_header(frame_time: FrameTime, angle_unit: str) -> bytes:
    """Print what stands before the frames."""
    lines = [":FULLY-SPECIFIED", ":RADIANS" if angle_unit == "rad" else ":DEGREES"]
    if frame_time:
        lines.append(f":SAMPLES-PER-SECOND {to_state(short_decimal(1 / Fraction(frame_time)))}")
    return "\n".join(lines).encode()


def slots_of_row(text: bytes, shape: RowShape) -> list[Slot]:
    """Find the numbers in a row's bytes."""
    lines = _lines(text)
    first = _first_columns(shape)
    regular = tuple(tokens[0].group() for tokens in lines[1:]) == shape.words
    found: list[Slot] = [(-1, *lines[0][0].span())]
    column = 0
    for tokens in lines[1:]:
        if not regular:
            column = first[tokens[0].group()]
        found += [(column + k, *token.span()) for k, token in enumerate(tokens[1:])]
        column += len(tokens) - 1
    return found


def _first_columns(shape: RowShape) -> dict[bytes, int]:
    starts = np.cumsum((0, *shape.counts)).tolist()
    return dict(zip(shape.words, starts, strict=False))


def _lines(text: bytes, begin: int = 0) -> list[list[re.Match[bytes]]]:
    lines: list[list[re.Match[bytes]]] = []
    for line in re.compile(rb"[^\n]+").finditer(text, begin):
        tokens = list(_TOKEN.finditer(text, *line.span()))
        if tokens and tokens[0].group()[:1] not in b"#\0\x1a":
            lines.append(tokens)
    return lines


def _row_text(data: bytes, begin: int) -> bytes:
    counter = _COUNTER.search(data, begin)
    following = _COUNTER.search(data, counter.end()) if counter else None
    return data[begin : following.start() if following else len(data)]


def _row_shape(data: bytes, begin: int, file: str | None) -> RowShape:
    lines = _lines(_row_text(data, begin))[1:]
    words = tuple(tokens[0].group() for tokens in lines)
    counts = tuple(len(tokens) - 1 for tokens in lines)
    if not sum(counts):
        raise FormatError(
            "the first frame cannot be read",
            file=file,
            line=data.count(b"\n", 0, begin) + 1,
            expected="lines with a bone and its numbers",
        )
    return RowShape(True, words, counts)


def _partial_rows(data: bytes, begin: int, shape: RowShape, before: Body | None) -> Body | None:
    """Read rows that leave out bones or have them in another order, where it is that."""
    lines = _lines(_row_text(data, begin))[1:]
    words = tuple(tokens[0].group() for tokens in lines)
    counts = dict(zip(shape.words, shape.counts, strict=True))
    repeated = len(set(words)) < len(words) or len(counts) < len(shape.words)
    if words == shape.words or repeated or not set(words) <= set(counts):
        return None
    part = read_rows(data, begin, RowShape(True, words, tuple(counts[word] for word in words)))
    if not len(part.values):
        return None
    first = _first_columns(shape)
    columns = np.concatenate(
        [np.arange(first[word], first[word] + counts[word]) for word in words] or [np.arange(0)]
    )
    # A bone that was never seen before stands at 0.
    held = before.values[-1] if before else np.zeros(shape.columns)
    values = np.tile(held, (len(part.values), 1))
    values[:, columns] = part.values
    statistics = np.zeros((shape.columns, 8), np.uint8)
    statistics[:, 0] = 255
    statistics[columns] = part.statistics
    return Body(
        values,
        part.counters,
        part.offsets,
        statistics,
        part.stop,
        part.error_offset,
        part.error_item,
    )


def _expected(body: Body, shape: RowShape) -> str:
    if body.stop == "frame number":
        return "the next frame's number, or the end of the file"
    if body.stop in ("line end", "number"):
        bone = decoded(shape.words[body.error_item])
        return f"{shape.counts[body.error_item]} numbers for bone {bone}"
    return f"bone {decoded(shape.words[body.error_item])}"


FORMAT = Format(
    id="amc",
    name="AMC",
    suffixes=(".amc",),
    recognises=lambda head: bool(_KEYWORD.search(head)),
    split=split,
    fit=fit,
    write=write,
    timed=False,
    companion="asf",
)
