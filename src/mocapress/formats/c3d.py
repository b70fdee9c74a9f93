"""C3D: the numbers of a file as streams, and all else of it as a layout, byte for byte.

core/formats/c3d.cpp finds how the frames are laid out. Files are worked on some frames at a time.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from mocapress import _core
from mocapress.errors import FormatError
from mocapress.formats.c3d_layout import (
    IN_POINT,
    IN_ROTATION,
    PROCESSORS,
    C3dLayout,
    Shape,
    Values,
    Words,
    frame_words,
    read_layout,
    sizes_of,
)
from mocapress.formats.c3d_parameters import Parameters, described
from mocapress.formats.c3d_writing import fit, write
from mocapress.formats.contract import Format, LongSplit, Split
from mocapress.formats.layout import NO_ROWS
from mocapress.formats.problems import EXTRA_ROWS, MISSING_ROWS, Problem
from mocapress.motion import Clip, Skeleton, Stream
from mocapress.motion.columns import numbered_columns
from mocapress.motion.frame_time import FrameTime
from mocapress.motion.markers import ANALOG, CAMERAS, POINTS, RESIDUALS, ROTATIONS, WHOLE_WORD
from mocapress.records import Held, Ranges

_BLOCK = 512
_MOST_ANNOUNCED = 2**16 - 1
"""Frames; a header that announces them may mean more."""
_HEAD = 2**20
"""Bytes that tell how the frames are laid out."""
_SAMPLED = 64
"""Blocks of frames that tell which word stands for gaps."""
_ROTATION_KINDS = tuple(f"m{i}" for i in range(IN_ROTATION))


def split(data: bytes, _skeleton: Skeleton | None, file: str | None) -> Split:
    """Take a file apart.

    Raises
    ------
    FormatError
        When no way to lay out its frames fits the file.

    """
    streams: dict[str, Values] = {}
    read: dict[str, int] = {}

    def take(shape: Shape, named: dict[str, Values]) -> None:
        for name, values in named.items():
            if name not in streams:
                streams[name] = np.empty(sizes_of(shape)[name])
            first = read.get(name, 0)
            read[name] = first + len(values)
            streams[name][first : read[name]] = values

    layout, problems = _find_layout(Held(data), file, take)
    named = {name: streams[name] for name in sizes_of(layout.shape)}
    clip = _clip(layout, named, file)
    return Split(clip, NO_ROWS, problems, layout)


def split_long(file: Ranges, name: str | None) -> LongSplit:
    """Take a file apart, some frames at a time; see ``split``."""
    return _long(file, name, *_find_layout(file, name, lambda _, __: None))


def outline(file: Ranges, name: str | None) -> LongSplit:
    """Tell what the header and the parameters say of a file; see ``split``."""
    return _long(file, name, *_find_frames(file, name))


def _long(
    file: Ranges, name: str | None, layout: C3dLayout, problems: tuple[Problem, ...]
) -> LongSplit:
    shape = layout.shape
    sizes = sizes_of(shape)
    empty = {name: np.empty((0, columns)) for name, (_, columns) in sizes.items()}
    frames = tuple(count for count, _ in sizes.values())

    def parts() -> Iterator[dict[str, Values]]:
        for words in _frames(file, layout):
            yield _streams(shape, words, layout.gap)
        for words in _turns(file, layout):
            yield {ROTATIONS: shape.values(words)}

    return LongSplit(_clip(layout, empty, name), frames, problems, layout, parts)


def _clip(layout: C3dLayout, named: dict[str, Values], file: str | None) -> Clip:
    timed = _timed(layout.shape, named, Parameters.of(layout.head))
    return Clip(timed, None, Path(file).stem if file else "")


def _find_frames(file: Ranges, name: str | None) -> tuple[C3dLayout, tuple[Problem, ...]]:
    """Find where the frames of a file are: its layout, but for the words that differ."""
    processor, floats, announced, points, analog, samples, frames, stated, turned, _ = (
        _core.c3d_layout(file.read(0, min(_HEAD, file.size)), file.size)
    )
    begin, count, numbers = frames
    turned_at, turns, in_turn = turned
    if announced == _MOST_ANNOUNCED < count and not stated:
        size = numbers * (4 if floats else 2)
        count -= _padding(file, begin + count * size, size)
    if not count and not turns:
        raise FormatError(
            "the frames cannot be found",
            file=name,
            expected="frames that fill the file",
            found=f"{announced} frames announced of {points} points and {analog} analog numbers",
        )
    shape = Shape(
        processor, floats, points, analog // samples, samples, count, in_turn // IN_ROTATION, turns
    )
    end = begin + count * numbers * shape.size if count else turned_at
    behind = turned_at + turns * in_turn * shape.size if turns else end
    layout = C3dLayout(
        shape,
        file.read(0, begin if count else turned_at),
        file.read(end, turned_at) if turns else b"",
        file.read(behind, file.size),
        0,
        np.empty(0, np.int64),
        np.empty(0, np.uint32),
    )
    return layout, tuple(_problems(announced, count or turns, file.size, begin))


def _padding(file: Ranges, end: int, size: int) -> int:
    """Count frames of zeros before an end that only fill the file's last block."""
    last = file.read(max(end - _BLOCK, 0), end)
    return (len(last) - len(last.rstrip(b"\0"))) // size


def _find_layout(
    file: Ranges, name: str | None, take: Callable[[Shape, dict[str, Values]], None]
) -> tuple[C3dLayout, tuple[Problem, ...]]:
    """Find the layout of a file; give its streams, some frames after the other, to ``take``."""
    layout, problems = _find_frames(file, name)
    layout = replace(layout, gap=_gap(file, layout))
    shape = layout.shape
    differing, words = [], []
    place = 0

    def compare(again: Words, own: Words) -> None:
        nonlocal place
        found = np.flatnonzero(again != own)
        differing.append(found + place)
        words.append(own[found].astype(np.uint32))
        place += len(own)

    for own in _frames(file, layout):
        named = _streams(shape, own, layout.gap)
        compare(
            frame_words(shape._replace(frames=len(own)), named, layout.gap).ravel(), own.ravel()
        )
        take(shape, named)
    for own in _turns(file, layout):
        values = shape.values(own)
        compare(shape.bits(values.ravel()), own.ravel())
        take(shape, {ROTATIONS: values})
    found = replace(layout, differing=np.concatenate(differing), words=np.concatenate(words))
    return found, problems


def _frames(file: Ranges, layout: C3dLayout) -> Iterator[Words]:
    """Give the words of the frames, (n, numbers), some frames after the other."""
    shape = layout.shape
    for first, last in shape.blocks():
        yield _frame_run(file, layout, first, last)


def _frame_run(file: Ranges, layout: C3dLayout, first: int, last: int) -> Words:
    shape, begin = layout.shape, len(layout.head)
    size = shape.numbers * shape.size
    data = file.read(begin + first * size, begin + last * size)
    return shape.words(data, 0, (last - first) * shape.numbers).reshape(-1, shape.numbers)


def _turns(file: Ranges, layout: C3dLayout) -> Iterator[Words]:
    """Give the words of the rotations, (n, numbers), likewise."""
    shape = layout.shape
    numbers = shape.rotations * IN_ROTATION
    begin = file.size - len(layout.tail) - shape.turns * numbers * shape.size
    for first, last in shape.blocks_of_turns():
        size = numbers * shape.size
        data = file.read(begin + first * size, begin + last * size)
        yield shape.words(data, 0, (last - first) * numbers).reshape(-1, numbers)


def _problems(announced: int, found: int, size: int, begin: int) -> list[Problem]:
    """Say where there are fewer frames than announced, or more."""
    if found < announced:
        what = "the file ends before its last frame"
        return [Problem.of(MISSING_ROWS, what, None, size, f"{announced} frames", str(found))]
    # Counts of 16 bits overflow in long files, which other parameters then say.
    if announced < found < _MOST_ANNOUNCED:
        what = "more frames than the header announces"
        return [Problem.of(EXTRA_ROWS, what, None, begin, f"{announced} frames", str(found))]
    return []


def _streams(shape: Shape, words: Words, gap: int) -> dict[str, Values]:
    """Give the numbers of frames, by stream."""
    count, points = len(words), shape.points
    named = {}
    if points:
        of_points = words[:, : IN_POINT * points].reshape(count, points, IN_POINT)
        places = _places(shape, words)
        places[(of_points[:, :, :3] == gap).all(axis=2)] = np.nan
        fourth = shape.values(np.ascontiguousarray(of_points[:, :, 3])).reshape(count, points)
        whole = (np.floor(fourth) == fourth) & (np.abs(fourth) < 2**15)
        cameras = np.where(whole, np.floor(np.where(whole, fourth, 0) / 256), float(WHOLE_WORD))
        named = {
            POINTS: places.reshape(count, 3 * points),
            RESIDUALS: np.where(whole, fourth - 256 * cameras, fourth),
            CAMERAS: cameras,
        }
    if shape.channels:
        analog = shape.values(np.ascontiguousarray(words[:, IN_POINT * points :]))
        named[ANALOG] = analog.reshape(count * shape.samples, shape.channels)
    return named


def _places(shape: Shape, words: Words) -> Values:
    """Give the coordinates of points, (n, P, 3)."""
    of_points = words[:, : IN_POINT * shape.points].reshape(-1, shape.points, IN_POINT)
    return shape.values(np.ascontiguousarray(of_points[:, :, :3]))


def _gap(file: Ranges, layout: C3dLayout) -> int:
    """Give the word that missing points have: that of 0 or of NaN, whichever more of them have."""
    shape = layout.shape
    if not shape.floats or not shape.points or not shape.frames:
        return 0
    empty = undefined = 0
    blocks = list(shape.blocks())
    for first, last in blocks[:: -(-len(blocks) // _SAMPLED)]:
        places = _places(shape, _frame_run(file, layout, first, last))
        empty += int((places == 0).all(axis=2).sum())
        undefined += int(np.isnan(places).all(axis=2).sum())
    return int(np.float32(np.nan).view(np.uint32)) if undefined > empty else 0


def _timed(shape: Shape, named: dict[str, Values], told: Parameters) -> dict[str, Stream]:
    """Give the streams their columns and frame times."""
    time = told.frame_time
    kinds = {
        POINTS: ("x", "y", "z"),
        RESIDUALS: ("residual",),
        CAMERAS: ("cameras",),
        ANALOG: ("analog",),
        ROTATIONS: _ROTATION_KINDS,
    }
    # A file of rotations alone has no frames of points to count them by.
    turns = max(shape.turns // shape.frames, 1) if shape.frames else 1
    steps = {ANALOG: shape.samples, ROTATIONS: turns}
    times: dict[str, FrameTime] = {
        name: time / step if time else None for name, step in steps.items()
    }
    return {
        name: Stream(values, numbered_columns(values.shape[1], kinds[name]), times.get(name, time))
        for name, values in named.items()
    }


def _recognised(head: bytes) -> bool:
    """Tell a C3D by its second byte, and by parameters where the first says they are."""
    at = (head[0] - 1) * _BLOCK if head[:1] else 0
    return (
        len(head) >= _BLOCK
        and head[1] == 0x50
        and 0 < at <= len(head) - 4
        and (head[at + 1] == 0x50 or head[at + 3] in PROCESSORS)
    )


FORMAT = Format(
    id="c3d",
    name="C3D",
    suffixes=(".c3d",),
    recognises=_recognised,
    split=split,
    split_long=split_long,
    outline=outline,
    fit=fit,
    write=write,
    read_layout=read_layout,
    describe=lambda layout, clip, _: described(layout.head, clip),
)
