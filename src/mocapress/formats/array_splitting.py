"""Files of NumPy's arrays as streams: each array of numbers is one, its first axis the frames.

An ``.npz`` is a zip archive of ``.npy`` files. Only arrays that it holds uncompressed, as
``np.savez`` writes them, have their numbers in the file's own bytes.
"""

import io
import struct
import tokenize
import warnings
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError
from mocapress.formats.array_layout import KINDS, Array, ArrayLayout
from mocapress.formats.contract import Split
from mocapress.formats.layout import NO_ROWS
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.columns import distinct, named_columns, numbered_columns
from mocapress.motion.frame_time import FrameTime, of_rate

MAGIC = b"\x93NUMPY"
_RATES = ("mocap_framerate", "mocap_frame_rate", "framerate", "frame_rate", "fps")
"""Arrays of one number that say the rate; those of AMASS come first."""
_LEAST_NUMBERS, _LEAST_OF_OTHERS = 64, 4096
"""Smaller arrays are no motion, and stay as they are: all, and those of other frames than the
largest."""
_LOCAL = struct.Struct("<26xHH")
"""Of the header before a file in a zip archive: lengths of its name and of what else it says."""
_MOST_COLUMNS = 2**16
_MOST_STREAMS = 2**7


# The header is a Python literal; these come of others.
_NO_HEADER = (
    *(ValueError, SyntaxError, tokenize.TokenError, TypeError, AttributeError),
    *(LookupError, RecursionError, MemoryError),
)


class _Found(NamedTuple):
    """An array where it stands in the file."""

    name: str
    begin: int
    kind: np.dtype[np.generic]
    by_columns: bool
    shape: tuple[int, ...]

    @property
    def numbers(self) -> int:
        return int(np.prod(self.shape, dtype=object))

    @property
    def end(self) -> int:
        return self.begin + self.numbers * self.kind.itemsize

    def read(self, data: bytes) -> NDArray[np.generic]:
        """Give its numbers or texts in a row."""
        return np.frombuffer(data, self.kind, self.numbers, self.begin)


def split_npy(data: bytes, _skeleton: Skeleton | None, file: str | None) -> Split:
    """Take a file of one array apart.

    Raises
    ------
    FormatError
        When it is no array of numbers in frames.

    """
    found = _array_at(data, "array", 0, len(data))
    return _split(data, "npy", [found] if found else [], file)


def split_npz(data: bytes, _skeleton: Skeleton | None, file: str | None) -> Split:
    """Take a file of arrays apart.

    Raises
    ------
    FormatError
        When it is no zip archive, or none of its arrays holds numbers in frames.

    """
    try:
        return _split(data, "npz", [*_in_archive(data)], file)
    except (zipfile.BadZipFile, struct.error, NotImplementedError, UnicodeError) as error:
        raise FormatError(
            f"a damaged archive: {error}", file=file, expected="a zip archive of arrays"
        ) from error


def _in_archive(data: bytes) -> Iterator[_Found]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for info in archive.infolist():
            name, at = info.filename, info.header_offset
            if info.compress_type != zipfile.ZIP_STORED or info.flag_bits & 1 or at < 0:
                continue
            if data[at : at + 4] != b"PK\x03\x04":
                raise zipfile.BadZipFile(f"no file at {at}")
            begin = at + 30 + sum(_LOCAL.unpack_from(data, at))
            found = _array_at(data, name.removesuffix(".npy"), begin, begin + info.file_size)
            if found:
                yield found


def _array_at(data: bytes, name: str, begin: int, end: int) -> _Found | None:
    """Read the header of the array in a part of the file; None where it holds no such array."""
    head = io.BytesIO(data[begin : min(begin + 2**16, end)])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote
            version = np.lib.format.read_magic(head)
            read = (
                np.lib.format.read_array_header_1_0
                if version == (1, 0)
                else np.lib.format.read_array_header_2_0
            )
            shape, by_columns, kind = read(head)
    except _NO_HEADER:
        return None
    found = _Found(name, begin + head.tell(), kind, by_columns and len(shape) > 1, shape)
    fits = not kind.hasobject and min(shape, default=0) >= 0 and found.end <= min(end, len(data))
    return found if fits else None


def _split(data: bytes, kind: str, found: list[_Found], file: str | None) -> Split:
    found = sorted(found, key=lambda array: array.begin)
    moving = [array for array in _apart(found) if _is_motion(array, data)]
    if not moving or len(moving) > _MOST_STREAMS:
        raise FormatError(
            "no numbers in frames that can be read here",
            file=file,
            expected=f"up to {_MOST_STREAMS} arrays of numbers that float64 holds, as np.save and "
            "np.savez store them (np.savez_compressed packs them)",
            found=", ".join(f"{a.name} {a.kind} {a.shape}" for a in found[:3]) or "none",
        )
    frames = max(moving, key=lambda array: array.numbers).shape[0]
    moving = [a for a in moving if a.shape[0] == frames or a.numbers >= _LEAST_OF_OTHERS]
    largest = sorted(moving, key=lambda array: -array.numbers)
    arrays = tuple(_told(array, largest.index(array)) for array in moving)
    places = [0, *(place for array in moving for place in (array.begin, array.end)), len(data)]
    between = tuple(data[a:b] for a, b in zip(places[::2], places[1::2], strict=True))
    read = {array.name: array for array in found}
    streams = {}
    for array in largest:
        told = arrays[moving.index(array)]
        time = _frame_time(read, array.name, data) if told.rows == frames else None
        values = told.values(data[array.begin : array.end])
        streams[array.name] = Stream(values, _columns(read, array.name, told.columns, data), time)
    layout = ArrayLayout(kind, arrays, between)
    clip = Clip(streams, None, Path(file).stem if file else "")
    return Split(clip, NO_ROWS, (), layout)


def _apart(found: list[_Found]) -> Iterator[_Found]:
    """Leave out arrays that overlap one before, as a forged archive may say."""
    end = 0
    for array in found:
        if array.begin >= end:
            end = array.end
            yield array


def _is_motion(array: _Found, data: bytes) -> bool:
    """Tell whether an array holds numbers in frames, and its bytes come back from float64."""
    if array.kind.str not in KINDS or array.numbers < _LEAST_NUMBERS or array.shape[0] < 2:
        return False
    if array.numbers // array.shape[0] > _MOST_COLUMNS:
        return False
    told, own = _told(array, 0), data[array.begin : array.end]
    return told.printed(told.values(own)) == own


def _told(array: _Found, stream: int) -> Array:
    rows = array.shape[0]
    return Array(
        KINDS.index(array.kind.str),
        array.by_columns and array.numbers > rows,
        rows,
        array.numbers // rows,
        stream,
    )


def _frame_time(read: dict[str, _Found], name: str, data: bytes) -> FrameTime:
    """Give the frame time that an array of one number says; None where there is none."""
    for rate in (f"{name}_rate", *_RATES):
        array = read.get(rate)
        if array is None or array.numbers != 1 or array.kind.kind not in "fiu":
            continue
        value = float(array.read(data)[0])
        if np.isfinite(value) and value > 0:
            return of_rate(value)
    return None


def _columns(read: dict[str, _Found], name: str, count: int, data: bytes) -> tuple[Column, ...]:
    """Name the columns as arrays of texts say, as ``mp.write`` adds them, or by numbers."""
    names, units = (
        array.read(data).tolist() if array and array.kind.kind == "U" else []
        for array in (read.get(f"{name}_names"), read.get(f"{name}_units"))
    )
    if len(names) != count:
        return numbered_columns(count, (name,))
    columns = named_columns(distinct(names))
    if len(units) != count:
        return columns
    return tuple(replace(column, unit=unit) for column, unit in zip(columns, units, strict=True))
