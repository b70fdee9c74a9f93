"""Clips written as C3D: float32 numbers, Intel, version 1.0 of the parameters."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import UnsupportedError
from mocapress.formats.table_writing import with_frames
from mocapress.motion import Clip, Stream
from mocapress.motion.markers import (
    ANALOG,
    CAMERAS,
    POINTS,
    RESIDUALS,
    WHOLE_WORD,
    joints_as_points,
)

T = TypeVar("T")
_OF_PLATES = (
    ("TYPE", "<i2", 1),
    ("CORNERS", "<f4", 3),
    ("ORIGIN", "<f4", 3),
    ("CHANNEL", "<i2", 1),
    ("CAL_MATRIX", "<f4", 6),
)
"""Parameters of force plates: name, type of the numbers, and how many stand in a column."""
_BLOCK = 512
_INTEL = 84
_LISTED = 255
"""Texts in one parameter; others follow in one with a number behind its name."""
_MOST_SHORT = 2**16 - 1


def fit(clip: Clip) -> Clip:
    """Give a clip of points, and analog data at a multiple of their rate.

    A clip of a skeleton becomes points: the positions of its joints, in its units.

    Raises
    ------
    UnsupportedError
        When there are neither points nor joints, or analog data at another rate.

    """
    streams = clip.streams
    if POINTS not in streams and clip.skeleton is not None and clip.frames:
        stream = joints_as_points(clip)
        return with_frames(replace(clip, streams={POINTS: stream}, skeleton=None))
    kept = {name: streams[name] for name in (POINTS, RESIDUALS, CAMERAS, ANALOG) if name in streams}
    if POINTS not in kept and ANALOG not in kept:
        raise UnsupportedError("a C3D needs points or analog data")
    first = next(iter(kept.values()))
    if ANALOG in kept and (not first.frames or kept[ANALOG].frames % first.frames):
        raise UnsupportedError(
            "analog data at a rate that is no multiple of the points'",
            expected=f"a multiple of {first.frames} samples",
            found=str(kept[ANALOG].frames),
        )
    return with_frames(replace(clip, streams=kept, skeleton=None))


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip that was made to fit."""
    points, analog = clip.streams.get(POINTS), clip.streams.get(ANALOG)
    frames = clip.frames
    samples = max(analog.frames // frames, 1) if analog and frames else 1
    words = _frames(clip, points, analog, samples)
    rate = 0.0 if clip.frame_time is None else float(1 / Fraction(clip.frame_time))
    first = int(clip.metadata.get("first_frame", "1"))
    last = first + frames - 1
    short_first, short_last = (first, last) if last <= _MOST_SHORT else (1, min(frames, 65535))
    section = _parameters(clip, points, analog, rate, samples, first)
    start = 2 + len(section) // _BLOCK
    section = _parameters(clip, points, analog, rate, samples, first, start)
    header = bytearray(_BLOCK)
    header[:2] = b"\x02\x50"
    count = points.channels // 3 if points else 0
    channels = analog.channels if analog else 0
    header[2:24] = (
        np.array([count, channels * samples, short_first, short_last, 0], "<u2").tobytes()
        + np.float32(-_point_scale(clip)).tobytes()
        + np.array([start, samples], "<u2").tobytes()
        + np.float32(rate).tobytes()
    )
    data = words.astype("<f4").tobytes()
    padding = b"\0" * (-len(data) % _BLOCK)
    return {".c3d": bytes(header) + section + data + padding}


def _point_scale(clip: Clip) -> float:
    """Give what residuals are multiplied by to be lengths."""
    return abs(float(clip.metadata.get("point_scale", "1"))) or 1.0


def _frames(clip: Clip, points: Stream | None, analog: Stream | None, samples: int) -> np.ndarray:
    """Give the numbers of all frames, (F, N)."""
    parts = []
    if points is not None:
        places = points.values.reshape(clip.frames, -1, 3)
        missing = np.asarray(np.isnan(places).any(axis=2))
        fourth = np.zeros(missing.shape)
        residuals, cameras = clip.streams.get(RESIDUALS), clip.streams.get(CAMERAS)
        if residuals is not None and cameras is not None:
            word = 256 * cameras.values + residuals.values
            fourth = np.where(cameras.values == WHOLE_WORD, residuals.values, word)
        fourth = np.where(missing, -1, fourth)
        filled = np.where(missing[:, :, None], 0, places)
        numbers = np.concatenate([filled, fourth[:, :, None]], axis=2)
        parts.append(numbers.reshape(clip.frames, -1))
    if analog is not None:
        parts.append(analog.values.reshape(clip.frames, samples * analog.channels))
    return np.concatenate(parts, axis=1)


def _parameters(
    clip: Clip,
    points: Stream | None,
    analog: Stream | None,
    rate: float,
    samples: int,
    first: int,
    start: int = 0,
) -> bytes:
    """Give the parameter section, in whole blocks."""
    section = _Section()
    labels = [column.name.removesuffix(".x") for column in points.columns[::3]] if points else []
    section.group("POINT")
    section.integers("USED", [len(labels)])
    section.reals("SCALE", [-_point_scale(clip)])
    section.reals("RATE", [rate])
    section.integers("DATA_START", [start])
    section.integers("FRAMES", [min(clip.frames, _MOST_SHORT)])
    if clip.frames > _MOST_SHORT:
        section.reals("LONG_FRAMES", [float(clip.frames)])
    section.texts("LABELS", labels)
    section.texts("UNITS", [points.columns[0].unit] if points and points.columns else [])
    channels = analog.columns if analog else ()
    section.group("ANALOG")
    section.integers("USED", [len(channels)])
    section.reals("GEN_SCALE", [1.0])
    section.reals("SCALE", [1.0] * len(channels))
    section.integers("OFFSET", [0] * len(channels))
    section.reals("RATE", [rate * samples])
    section.texts("LABELS", [column.name for column in channels])
    section.texts("UNITS", [column.unit for column in channels])
    section.group("TRIAL")
    for name, number in (("START", first), ("END", first + clip.frames - 1)):
        section.integers(f"ACTUAL_{name}_FIELD", [number % 2**16, number // 2**16])
    _write_plates(section, clip)
    events = json.loads(clip.metadata.get("events", "[]"))[:_LISTED]
    if events:
        section.group("EVENT")
        section.integers("USED", [len(events)])
        section.texts("LABELS", [event.get("label", "") for event in events])
        section.texts("CONTEXTS", [event.get("context", "") for event in events])
        times = [(event["seconds"] // 60, event["seconds"] % 60) for event in events]
        section.reals("TIMES", [part for time in times for part in time], rows=2)
    return section.printed()


def _write_plates(section: "_Section", clip: Clip) -> None:
    """Append the parameters of force plates, whose samples are analog data."""
    told = json.loads(clip.metadata.get("force_plates", "{}")) if ANALOG in clip.streams else {}
    count = len(told.get("type", []))
    section.group("FORCE_PLATFORM")
    section.integers("USED", [count])
    # Numbers of a plate stand together: corners of three each, columns of a matrix of six.
    for name, kind, rows in _OF_PLATES:
        numbers = told.get(name.lower(), [])
        each = len(numbers) // count if count else 0
        if each and each % rows == 0 and max(each // rows, count) <= _LISTED:
            shape = [rows, each // rows, count] if rows > 1 else [each, count]
            section.array(name, shape, np.array(numbers[: each * count], kind))
    if told.get("zero"):
        section.integers("ZERO", [int(number) for number in told["zero"]])


class _Section:
    """Parameters, one behind the other."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._group = 0

    def group(self, name: str) -> None:
        """Begin a group."""
        self._group += 1
        self._record(name, -self._group, b"\0")

    def integers(self, name: str, numbers: Sequence[int]) -> None:
        """Append whole numbers of 16 bits."""
        for part, own in _parts(name, numbers):
            self.array(part, [len(own)], np.array(own, "<u2"))

    def reals(self, name: str, numbers: Sequence[float], rows: int = 1) -> None:
        """Append floats; in columns of so many where there are several rows."""
        for part, own in _parts(name, numbers, rows):
            shape = [len(own)] if rows == 1 else [rows, len(own) // rows]
            self.array(part, shape, np.array(own, "<f4"))

    def texts(self, name: str, texts: Sequence[str]) -> None:
        """Append texts."""
        for part, own in _parts(name, texts):
            encoded = [text.encode()[:_LISTED] for text in own]
            width = max(map(len, encoded), default=0)
            data = b"".join(text.ljust(width) for text in encoded)
            self._parameter(part, -1, [width, len(own)], data)

    def array(self, name: str, shape: Sequence[int], numbers: NDArray[Any]) -> None:
        """Append numbers, of which the first dimension runs fastest."""
        self._parameter(name, numbers.itemsize, shape, numbers.tobytes())

    def _parameter(self, name: str, kind: int, shape: Sequence[int], data: bytes) -> None:
        self._record(name, self._group, bytes([kind % 256, len(shape), *shape]) + data + b"\0")

    def _record(self, name: str, number: int, content: bytes) -> None:
        self._data += bytes([len(name), number % 256]) + name.encode()
        self._data += (len(content) + 2).to_bytes(2, "little") + content

    def printed(self) -> bytes:
        """Give the section."""
        size = 4 + len(self._data) + 2
        blocks = -(-size // _BLOCK)
        head = bytes([1, 0x50, min(blocks, 255), _INTEL])
        return (head + bytes(self._data)).ljust(blocks * _BLOCK, b"\0")


def _parts(name: str, items: Sequence[T], rows: int = 1) -> Iterable[tuple[str, Sequence[T]]]:
    """Cut a list into parts that fit into a parameter, and name them: LABELS, LABELS2 ..."""
    size = _LISTED * rows
    for place in range(max(-(-len(items) // size), 1)):
        suffix = str(place + 1) if place else ""
        yield name + suffix, items[place * size : (place + 1) * size]
