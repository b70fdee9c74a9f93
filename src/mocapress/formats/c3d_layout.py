"""A C3D file without its numbers: what it keeps besides the streams, and the way back to bytes.

docs/format/c3d.md says what is stored.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError
from mocapress.formats.contract import StoredLayout
from mocapress.formats.rows import RowsOf
from mocapress.motion.markers import ANALOG, CAMERAS, POINTS, RESIDUALS, ROTATIONS, WHOLE_WORD
from mocapress.records import Reader, Writer

_INTEL, _DEC, _MIPS = 84, 85, 86
PROCESSORS = (_INTEL, _DEC, _MIPS)
IN_POINT, IN_ROTATION = 4, 17
_MOST_NUMBERS = 2**32
_BLOCK_NUMBERS = 2**17

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
        return IN_POINT * self.points + self.channels * self.samples

    @property
    def size(self) -> int:
        """Give the bytes of a number."""
        return 4 if self.floats else 2

    def blocks(self) -> Iterator[tuple[int, int]]:
        """Give runs of frames to work on at a time: the first, and one behind the last."""
        return _runs(self.frames, self.numbers)

    def blocks_of_turns(self) -> Iterator[tuple[int, int]]:
        """Give runs of records of rotations."""
        return _runs(self.turns, self.rotations * IN_ROTATION)

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
                return np.rint(inside).astype(np.int64).astype(np.uint16)
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
class C3dLayout(StoredLayout):
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

    @property
    def sizes(self) -> list[tuple[int, int]]:
        """Give frames and columns of each stream."""
        return list(sizes_of(self.shape).values())

    def pieces(self, rows: RowsOf, most_bytes: int = 2**62) -> Iterator[bytes]:
        """Print the file; see ``StoredLayout``."""
        shape = self.shape
        sizes = shape.frames * shape.numbers + shape.turns * shape.rotations * IN_ROTATION
        if sizes * shape.size + len(self.head) + len(self.between) + len(self.tail) > most_bytes:
            raise CorruptError("the layout makes a longer file than announced")
        places = {name: place for place, name in enumerate(sizes_of(shape))}
        yield self.head
        for first, last in shape.blocks():
            run = shape._replace(frames=last - first, turns=0)
            named = {
                name: rows(places[name], *(shape.samples * n for n in (first, last)))
                if name == ANALOG
                else rows(places[name], first, last)
                for name in sizes_of(run)
            }
            words = frame_words(run, named, self.gap).ravel()
            yield shape.printed(self._corrected(words, first * shape.numbers))
        yield self.between
        begin = shape.frames * shape.numbers
        for first, last in shape.blocks_of_turns():
            words = shape.bits(rows(places[ROTATIONS], first, last).ravel())
            yield shape.printed(
                self._corrected(words, begin + first * shape.rotations * IN_ROTATION)
            )
        yield self.tail

    def _corrected(self, words: Words, begin: int) -> Words:
        """Put in the words that the streams do not give, where the first of these stands."""
        low, high = np.searchsorted(self.differing, [begin, begin + len(words)])
        words[self.differing[low:high] - begin] = self.words[low:high].astype(words.dtype)
        return words

    def record(self) -> bytes:
        """Give the layout as it is stored."""
        writer = Writer()
        shape = self.shape
        writer.integer(2 * PROCESSORS.index(shape.processor) + shape.floats)
        for number in shape[2:]:
            writer.integer(number)
        writer.integer(self.gap)
        for part in (self.head, self.between, self.tail):
            writer.bytes(part)
        writer.integer(len(self.differing))
        steps = np.diff(self.differing, prepend=0)
        pairs = np.stack([steps, self.words], axis=1).astype(np.uint64).ravel()
        writer.data += _core.write_integers(pairs)
        return bytes(writer.data)


def read_layout(data: bytes) -> C3dLayout:
    """Read what ``C3dLayout.record`` gave.

    Raises
    ------
    CorruptError
        When it is not such a record.

    """
    reader = Reader(data, "C3D layout")
    kind = reader.integer(2 * len(PROCESSORS) - 1)
    told = [reader.integer(_MOST_NUMBERS) for _ in range(6)]
    shape = Shape(PROCESSORS[kind // 2], bool(kind % 2), *told)
    gap = reader.integer(2 ** (8 * shape.size) - 1)
    head, between, tail = reader.bytes(), reader.bytes(), reader.bytes()
    count = reader.count(2)
    all_words = shape.frames * shape.numbers + shape.turns * shape.rotations * IN_ROTATION
    try:
        numbers, end = _core.read_integers(data, reader.position, 2 * count)
    except ValueError as error:
        raise reader.fail(str(error)) from error
    reader.raw(end - reader.position)
    reader.end()
    places, words = np.cumsum(numbers[::2], dtype=np.uint64), numbers[1::2]
    wrapped = (places[1:] < places[:-1]).any()
    if count and (wrapped or int(places[-1]) >= all_words or words.max() >= 2 ** (8 * shape.size)):
        raise reader.fail("a number outside the frames")
    differing = places.astype(np.int64)
    return C3dLayout(shape, head, between, tail, gap, differing, words.astype(np.uint32))


def frame_words(shape: Shape, named: dict[str, Values], gap: int) -> Words:
    """Give the words of the frames, (F, numbers)."""
    count, points = shape.frames, shape.points
    words = np.empty((count, shape.numbers), np.uint32 if shape.floats else np.uint16)
    if points:
        of_points = words[:, : IN_POINT * points].reshape(count, points, IN_POINT)
        places = named[POINTS].reshape(count, points, 3)
        coordinates = shape.bits(places)
        coordinates[np.isnan(places).all(axis=2)] = gap
        of_points[:, :, :3] = coordinates
        residuals, cameras = named[RESIDUALS], named[CAMERAS]
        fourth = np.where(cameras == WHOLE_WORD, residuals, 256 * cameras + residuals)
        of_points[:, :, 3] = shape.bits(fourth)
        words[:, : IN_POINT * points] = of_points.reshape(count, -1)
    if shape.channels:
        words[:, IN_POINT * points :] = shape.bits(named[ANALOG]).reshape(count, -1)
    return words


def sizes_of(shape: Shape) -> dict[str, tuple[int, int]]:
    """Give frames and columns of the streams that a file has."""
    sizes = {
        POINTS: (shape.frames, 3 * shape.points),
        RESIDUALS: (shape.frames, shape.points),
        CAMERAS: (shape.frames, shape.points),
        ANALOG: (shape.frames * shape.samples, shape.channels),
        ROTATIONS: (shape.turns, shape.rotations * IN_ROTATION),
    }
    return {name: size for name, size in sizes.items() if size[0] * size[1]}


def _runs(count: int, numbers: int) -> Iterator[tuple[int, int]]:
    step = max(_BLOCK_NUMBERS // max(numbers, 1), 1)
    return ((first, min(first + step, count)) for first in range(0, count, step))
