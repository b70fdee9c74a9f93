"""C3D: the numbers of a file as streams, and all else of it as a layout, byte for byte.

core/formats/c3d.cpp finds how the frames are laid out; docs/format/c3d.md says what is stored.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError, FormatError
from mocapress.formats.c3d_parameters import Parameters, described
from mocapress.formats.c3d_writing import fit, write
from mocapress.formats.contract import Format, Split
from mocapress.formats.layout import NO_ROWS
from mocapress.formats.problems import EXTRA_ROWS, MISSING_ROWS, Problem
from mocapress.motion import Clip, Skeleton, Stream
from mocapress.motion.columns import numbered_columns
from mocapress.motion.frame_time import FrameTime
from mocapress.motion.markers import ANALOG, CAMERAS, POINTS, RESIDUALS, ROTATIONS, WHOLE_WORD
from mocapress.records import Reader, Writer

_INTEL, _DEC, _MIPS = 84, 85, 86
_PROCESSORS = (_INTEL, _DEC, _MIPS)
_BLOCK = 512
_IN_POINT, _IN_ROTATION = 4, 17
_ROTATION_KINDS = tuple(f"m{i}" for i in range(_IN_ROTATION))
_MOST_NUMBERS = 2**32


Values = NDArray[np.float64]
Words = NDArray[np.unsignedinteger[Any]]
"""Bits of numbers."""


class Shape(NamedTuple):
    """How the numbers of a file are laid out."""

    processor: int
    floats: bool
    points: int
    """Per frame, of four numbers each: x, y, z and the fourth word."""
    channels: int
    """Of analog data."""
    samples: int
    """Of each analog channel in a frame."""
    frames: int
    rotations: int
    """Per record, of 17 numbers each."""
    turns: int
    """Records of rotations."""

    @property
    def numbers(self) -> int:
        """Give the numbers of a frame."""
        return _IN_POINT * self.points + self.channels * self.samples

    @property
    def size(self) -> int:
        """Give the bytes of a number."""
        return 4 if self.floats else 2

    def words(self, data: bytes, begin: int, count: int) -> Words:
        """Give the numbers of a part of the file, as their bits in the order of this machine."""
        if not self.floats:
            kind = ">u2" if self.processor == _MIPS else "<u2"
            return np.frombuffer(data, kind, count, begin).astype(np.uint16, copy=False)
        if self.processor == _DEC:
            halves = np.frombuffer(data, "<u2", 2 * count, begin).reshape(-1, 2).astype(np.uint32)
            return np.asarray(halves[:, 0] << 16 | halves[:, 1], np.uint32)
        kind = ">u4" if self.processor == _MIPS else "<u4"
        return np.frombuffer(data, kind, count, begin).astype(np.uint32, copy=False)

    def values(self, words: Words) -> Values:
        """Give the numbers of words."""
        if not self.floats:
            return words.view(np.int16).astype(np.float64)
        with np.errstate(invalid="ignore"):
            numbers = words.view(np.float32).astype(np.float64)
        return numbers / 4 if self.processor == _DEC else numbers

    def bits(self, values: Values) -> Words:
        """Give the words of numbers, as far as there are such."""
        with np.errstate(invalid="ignore", over="ignore"):
            if not self.floats:
                inside = np.where(np.abs(values) <= 2**15, values, 0)
                return inside.astype(np.int64).astype(np.uint16)
            scaled = values * 4 if self.processor == _DEC else values
            return scaled.astype(np.float32).view(np.uint32)

    def printed(self, words: Words) -> bytes:
        """Give the bytes of words."""
        if not self.floats:
            return words.astype(">u2" if self.processor == _MIPS else "<u2").tobytes()
        if self.processor == _DEC:
            return np.stack([words >> 16, words & 0xFFFF], axis=-1).astype("<u2").tobytes()
        return words.astype(">u4" if self.processor == _MIPS else "<u4").tobytes()


@dataclass(frozen=True, slots=True, eq=False)
class C3dLayout:
    """A C3D file without its numbers."""

    shape: Shape
    head: bytes
    """Header and parameters: all up to the first frame."""
    between: bytes
    """What stands between the frames and the rotations."""
    tail: bytes
    gap: int
    """The word of each coordinate of a point that is missing."""
    differing: NDArray[np.int64]
    """Which words, of frames and rotations as they follow each other, the streams do not give."""
    words: NDArray[np.uint32]
    """These words."""
    format: str = "c3d"

    def join(self, streams: Sequence[Values], most_bytes: int = 2**62) -> bytes:
        """Give the file's bytes from the streams that ``split`` made, each (F, C).

        Raises
        ------
        CorruptError
            When they are not of this file, or more than ``most_bytes`` would come out.

        """
        shape = self.shape
        sizes = shape.frames * shape.numbers + shape.turns * shape.rotations * _IN_ROTATION
        if sizes * shape.size + len(self.head) + len(self.between) + len(self.tail) > most_bytes:
            raise CorruptError("the layout makes a longer file than announced")
        named = _named(shape, streams)
        words = np.concatenate(
            [
                _frame_words(shape, named, self.gap).ravel(),
                shape.bits(named.get(ROTATIONS, np.empty(0)).ravel()),
            ]
        )
        words[self.differing] = self.words.astype(words.dtype)
        first = shape.frames * shape.numbers
        return b"".join(
            [
                self.head,
                shape.printed(words[:first]),
                self.between,
                shape.printed(words[first:]),
                self.tail,
            ]
        )

    def record(self) -> bytes:
        """Give the layout as it is stored."""
        writer = Writer()
        shape = self.shape
        writer.integer(2 * _PROCESSORS.index(shape.processor) + shape.floats)
        for number in shape[2:]:
            writer.integer(number)
        writer.integer(self.gap)
        for part in (self.head, self.between, self.tail):
            writer.bytes(part)
        writer.integer(len(self.differing))
        for step, word in zip(
            np.diff(self.differing, prepend=0).tolist(), self.words.tolist(), strict=True
        ):
            writer.integer(step)
            writer.integer(word)
        return bytes(writer.data)


def read_layout(data: bytes) -> C3dLayout:
    """Read what ``C3dLayout.record`` gave.

    Raises
    ------
    CorruptError
        When it is not such a record.

    """
    reader = Reader(data, "C3D layout")
    kind = reader.integer(2 * len(_PROCESSORS) - 1)
    told = [reader.integer(_MOST_NUMBERS) for _ in range(6)]
    shape = Shape(_PROCESSORS[kind // 2], bool(kind % 2), *told)
    gap = reader.integer(2 ** (8 * shape.size) - 1)
    head, between, tail = reader.bytes(), reader.bytes(), reader.bytes()
    count = reader.count(2)
    all_words = shape.frames * shape.numbers + shape.turns * shape.rotations * _IN_ROTATION
    places = np.zeros(count, np.int64)
    words = np.zeros(count, np.uint32)
    place = 0
    for i in range(count):
        place += reader.integer(all_words)
        places[i], words[i] = place, reader.integer(2 ** (8 * shape.size) - 1)
    reader.end()
    if count and place >= all_words:
        raise reader.fail("a number outside the frames")
    return C3dLayout(shape, head, between, tail, gap, places, words)


def split(data: bytes, _skeleton: Skeleton | None, file: str | None) -> Split:
    """Take a file apart.

    Raises
    ------
    FormatError
        When no way to lay out its frames fits the file.

    """
    processor, floats, announced, points, analog, samples, frames, turned, _ = _core.c3d_layout(
        data
    )
    begin, count, numbers = frames
    turned_at, turns, in_turn = turned
    if not count and not turns:
        raise FormatError(
            "the frames cannot be found",
            file=file,
            expected="frames that fill the file",
            found=f"{announced} frames announced of {points} points and {analog} analog numbers",
        )
    shape = Shape(
        processor, floats, points, analog // samples, samples, count, in_turn // _IN_ROTATION, turns
    )
    end = begin + count * numbers * shape.size if count else turned_at
    words = shape.words(data, begin, count * numbers).reshape(count, numbers)
    turn_words = shape.words(data, turned_at, turns * in_turn)
    behind = turned_at + turns * in_turn * shape.size if turns else end
    streams, gap = _streams(shape, words, turn_words)
    named = {name: values for name, values in streams.items() if values.size}
    again = np.concatenate(
        [_frame_words(shape, named, gap).ravel(), shape.bits(streams[ROTATIONS].ravel())]
    )
    all_words = np.concatenate([words.ravel(), turn_words])
    differing = np.flatnonzero(again != all_words)
    layout = C3dLayout(
        shape,
        data[: begin if count else turned_at],
        data[end:turned_at] if turns else b"",
        data[behind:],
        gap,
        differing,
        all_words[differing].astype(np.uint32),
    )
    told = Parameters.of(data)
    clip = Clip(_timed(shape, named, told), None, Path(file).stem if file else "")
    problems = _problems(announced, count or turns, data, begin)
    return Split(clip, NO_ROWS, tuple(problems), layout)


def _problems(announced: int, found: int, data: bytes, begin: int) -> list[Problem]:
    """Say where there are fewer frames than announced, or more."""
    if found < announced:
        what = "the file ends before its last frame"
        return [Problem.of(MISSING_ROWS, what, None, len(data), f"{announced} frames", str(found))]
    # Counts of 16 bits overflow in long files, which other parameters then say.
    if announced < found < 2**16 - 1:
        what = "more frames than the header announces"
        return [Problem.of(EXTRA_ROWS, what, None, begin, f"{announced} frames", str(found))]
    return []


def _streams(shape: Shape, words: Words, turned: Words) -> tuple[dict[str, Values], int]:
    """Give the numbers of all streams, and the word that stands for gaps."""
    count, points = shape.frames, shape.points
    of_points = words[:, : _IN_POINT * points].reshape(count, points, _IN_POINT)
    places = shape.values(np.ascontiguousarray(of_points[:, :, :3])).reshape(count, points, 3)
    gap = _gap(shape, places)
    places[(of_points[:, :, :3] == gap).all(axis=2)] = np.nan
    fourth = shape.values(np.ascontiguousarray(of_points[:, :, 3])).reshape(count, points)
    whole = (np.floor(fourth) == fourth) & (np.abs(fourth) < 2**15)
    cameras = np.where(whole, np.floor(np.where(whole, fourth, 0) / 256), float(WHOLE_WORD))
    residuals = np.where(whole, fourth - 256 * cameras, fourth)
    analog = shape.values(np.ascontiguousarray(words[:, _IN_POINT * points :]))
    return {
        POINTS: places.reshape(count, 3 * points),
        RESIDUALS: residuals,
        CAMERAS: cameras,
        ANALOG: analog.reshape(count * shape.samples, shape.channels),
        ROTATIONS: shape.values(turned).reshape(shape.turns, shape.rotations * _IN_ROTATION),
    }, gap


def _gap(shape: Shape, places: Values) -> int:
    """Give the word that missing points have: that of 0 or of NaN, whichever more of them have."""
    if not shape.floats:
        return 0
    empty = int((places == 0).all(axis=2).sum())
    undefined = int(np.isnan(places).all(axis=2).sum())
    return int(np.float32(np.nan).view(np.uint32)) if undefined > empty else 0


def _frame_words(shape: Shape, named: dict[str, Values], gap: int) -> Words:
    """Give the words of the frames, (F, numbers)."""
    count, points = shape.frames, shape.points
    words = np.empty((count, shape.numbers), np.uint32 if shape.floats else np.uint16)
    if points:
        of_points = words[:, : _IN_POINT * points].reshape(count, points, _IN_POINT)
        places = named[POINTS].reshape(count, points, 3)
        coordinates = shape.bits(places)
        coordinates[np.isnan(places).all(axis=2)] = gap
        of_points[:, :, :3] = coordinates
        residuals, cameras = named[RESIDUALS], named[CAMERAS]
        fourth = np.where(cameras == WHOLE_WORD, residuals, 256 * cameras + residuals)
        of_points[:, :, 3] = shape.bits(fourth)
        words[:, : _IN_POINT * points] = of_points.reshape(count, -1)
    if shape.channels:
        words[:, _IN_POINT * points :] = shape.bits(named[ANALOG]).reshape(count, -1)
    return words


def _named(shape: Shape, streams: Sequence[Values]) -> dict[str, Values]:
    """Give streams their names; each must have the size that the layout says."""
    expected = {name: size for name, size in _sizes(shape).items() if size[0] * size[1]}
    if [values.shape for values in streams] != list(expected.values()):
        raise CorruptError("the streams do not fit the layout")
    return dict(zip(expected, streams, strict=True))


def _sizes(shape: Shape) -> dict[str, tuple[int, int]]:
    return {
        POINTS: (shape.frames, 3 * shape.points),
        RESIDUALS: (shape.frames, shape.points),
        CAMERAS: (shape.frames, shape.points),
        ANALOG: (shape.frames * shape.samples, shape.channels),
        ROTATIONS: (shape.turns, shape.rotations * _IN_ROTATION),
    }


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
        and (head[at + 1] == 0x50 or head[at + 3] in _PROCESSORS)
    )


FORMAT = Format(
    id="c3d",
    name="C3D",
    suffixes=(".c3d",),
    recognises=_recognised,
    split=split,
    fit=fit,
    write=write,
    read_layout=read_layout,
    describe=lambda layout, clip, _: described(layout.head, clip),
)
