"""What the parameters of a C3D file say of its streams: names, units, scales, events."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from typing import NamedTuple, Self

import numpy as np

from mocapress import _core
from mocapress.motion import Clip, Stream
from mocapress.motion.columns import distinct
from mocapress.motion.markers import ANALOG, CAMERAS, POINTS, RESIDUALS

_DEC, _MIPS = 85, 86
_NAMES = {84: "Intel", _DEC: "DEC", _MIPS: "MIPS"}
_TEXT, _BYTE, _INTEGER, _REAL = -1, 1, 2, 4
_MAKERS = (
    ("MANUFACTURER", "COMPANY"),
    ("MANUFACTURER", "SOFTWARE"),
    ("SOURCE", "SYSTEM"),
    ("SOURCE", "SOFTWARE"),
)
_PLATES = ("TYPE", "CORNERS", "ORIGIN", "CHANNEL", "CAL_MATRIX", "ZERO")


Listed = tuple[int, bool, bytes, int, bytes, int, int]
"""Group, whether it is one, name, type, dimensions, begin and size of the data."""


class Parameter(NamedTuple):
    """One parameter."""

    type: int
    dimensions: tuple[int, ...]
    """The first runs fastest."""
    data: bytes


class Parameters:
    """The parameters of a file, by group and name in capitals; numbers of the header, too."""

    def __init__(self, data: bytes, processor: int, floats: bool, listed: Sequence[Listed]) -> None:
        self.processor, self.floats = processor, floats
        self._header = data[:512]
        self.groups: dict[str, dict[str, Parameter]] = {}
        names: dict[int, str] = {}
        for group, is_group, name, *_ in listed:
            if is_group:
                names.setdefault(group, _text(name).upper())
        for group, is_group, name, kind, dimensions, begin, size in listed:
            if not is_group:
                own = self.groups.setdefault(names.get(group, str(group)), {})
                parameter = Parameter(kind, tuple(dimensions), data[begin : begin + size])
                own.setdefault(_text(name).upper(), parameter)

    @classmethod
    def of(cls, data: bytes) -> Self:
        """Read the parameters of a file, or of what stands before its frames."""
        processor, floats, *_, listed = _core.c3d_layout(data, len(data))
        return cls(data, processor, floats, listed)

    def numbers(self, group: str, name: str) -> list[float]:
        """Give the numbers of a parameter; nothing where there is none."""
        found = self.groups.get(group, {}).get(name)
        if found is None or found.type not in (_BYTE, _INTEGER, _REAL):
            return []
        return [float(x) for x in _numbers(found.data, found.type, self.processor)]

    def number(self, group: str, name: str, usual: float) -> float:
        """Give the first number of a parameter, or the usual one."""
        found = self.numbers(group, name)
        return found[0] if found and isfinite(found[0]) else usual

    def texts(self, group: str, name: str) -> list[str]:
        """Give the texts of a parameter and of those that continue it: LABELS, LABELS2 ..."""
        return [text for own in self._continued(group, name) for text in _texts(own)]

    def _continued(self, group: str, name: str) -> Iterator[Parameter]:
        own = self.groups.get(group, {})
        for place in range(1, 256):
            found = own.get(name if place == 1 else f"{name}{place}")
            if found is None or found.type != _TEXT:
                return
            yield found

    def of_header(self, offset: int, kind: int) -> float:
        """Give a number of the header."""
        return float(_numbers(self._header[offset : offset + kind], kind, self.processor)[0])

    @property
    def frame_time(self) -> Fraction | None:
        """Seconds per frame, of the rate that the parameters or else the header state."""
        for rate in (self.number("POINT", "RATE", 0), self.of_header(20, _REAL)):
            if isfinite(rate) and 0 < rate < 1e9:
                return 1 / Fraction(Decimal(str(np.float32(rate))))
        return None

    @property
    def point_scale(self) -> float:
        """What whole numbers of coordinates and residuals are multiplied by."""
        return abs(self.number("POINT", "SCALE", self.of_header(12, _REAL))) or 1.0

    @property
    def first_frame(self) -> int:
        """The number of the first frame, mostly 1."""
        field = self.numbers("TRIAL", "ACTUAL_START_FIELD")
        if len(field) > 1:
            return int(field[0]) % 2**16 + int(field[1]) % 2**16 * 2**16
        return int(self.of_header(6, _INTEGER)) % 2**16


def described(head: bytes, clip: Clip) -> Clip:
    """Give a clip whose streams have the names, units and scales of the file's parameters.

    Coordinates and analog values of files of whole numbers are multiplied by their scales, so that
    they are in their units; residuals and cameras stay as they are, ``point_scale`` in the metadata
    makes lengths of residuals. Points that are missing are NaN.

    Parameters
    ----------
    head
        What stands in the file before its frames.
    clip
        The streams as the file stores them.

    """
    told = Parameters.of(head)
    streams = {name: _described(name, stream, told) for name, stream in clip.streams.items()}
    return replace(clip, streams=streams, metadata={**clip.metadata, **_facts(told)})


def _described(name: str, stream: Stream, told: Parameters) -> Stream:
    unit = "".join(told.texts("POINT", "UNITS")[:1])
    labels = told.texts("POINT", "LABELS")
    if name == POINTS:
        values = stream.values if told.floats else stream.values * told.point_scale
        return _named(replace(stream, values=values), labels, [unit])
    if name == RESIDUALS:
        # -1 says that the point is not valid.
        return _named(replace(stream, values=stream.values), labels, [""])
    if name == CAMERAS:
        return _named(stream, labels, [""])
    if name == ANALOG:
        factors, offsets = _analog_scales(told, stream.channels)
        values = (stream.values - offsets) * factors
        units = told.texts("ANALOG", "UNITS")
        return _named(replace(stream, values=values), told.texts("ANALOG", "LABELS"), units)
    return _named(stream, told.texts("ROTATION", "LABELS"), [""])


def _analog_scales(told: Parameters, channels: int) -> tuple[np.ndarray, np.ndarray]:
    """Give the factor and the offset of each analog channel."""
    factors, offsets = np.ones(channels), np.zeros(channels)
    own = told.numbers("ANALOG", "SCALE")[:channels]
    factors[: len(own)] = own
    zeros = told.numbers("ANALOG", "OFFSET")[:channels]
    if "".join(told.texts("ANALOG", "FORMAT")).upper().startswith("UNSIGNED"):
        zeros = [zero % 2**16 for zero in zeros]
    offsets[: len(zeros)] = zeros
    return factors * told.number("ANALOG", "GEN_SCALE", 1.0), offsets


def _named(stream: Stream, labels: Sequence[str], units: Sequence[str]) -> Stream:
    """Give the columns the names of their groups, and units; a name that is there again, ``#2``."""
    columns = []
    groups = dict.fromkeys(column.name.partition(".")[0] for column in stream.columns)
    told = dict(zip(groups, labels, strict=False))
    names = distinct(told.get(group) or f"*{group}" for group in groups)
    for column in stream.columns:
        group, _, kind = column.name.partition(".")
        place = int(group) - 1
        unit = units[place] if place < len(units) else units[-1] if len(units) == 1 else ""
        alone = kind in ("residual", "cameras", "analog")
        name = names[place] if alone else f"{names[place]}.{kind}"
        columns.append(replace(column, name=name, joint=place, unit=unit))
    return replace(stream, columns=tuple(columns))


def _facts(told: Parameters) -> dict[str, str]:
    """Give what else the parameters say, as texts; lists as JSON."""
    makers = [text for place in _MAKERS for text in told.texts(*place)]
    facts = {
        "encoding": f"{_NAMES[told.processor]}, {'floats' if told.floats else 'whole numbers'}",
        "first_frame": str(told.first_frame),
        "point_scale": repr(told.point_scale),
    }
    if makers:
        facts["vendor"] = ", ".join(dict.fromkeys(filter(None, makers)))
    events = _events(told)
    if events:
        facts["events"] = json.dumps(events)
    plates = {
        name.lower(): told.numbers("FORCE_PLATFORM", name)
        for name in _PLATES
        if told.numbers("FORCE_PLATFORM", name)
    }
    if told.number("FORCE_PLATFORM", "USED", 0) > 0 and plates:
        facts["force_plates"] = json.dumps(plates)
    return facts


def _events(told: Parameters) -> list[dict[str, str | float]]:
    """Give the events in the order of the file: label, context, and seconds."""
    times = told.numbers("EVENT", "TIMES")
    count = int(told.number("EVENT", "USED", 0))
    labels, contexts = told.texts("EVENT", "LABELS"), told.texts("EVENT", "CONTEXTS")
    found = []
    for i in range(min(count, len(times) // 2)):
        # Minutes and seconds.
        seconds = 60 * times[2 * i] + times[2 * i + 1]
        if isfinite(seconds):
            event: dict[str, str | float] = {"seconds": seconds}
            event |= {"label": labels[i]} if i < len(labels) else {}
            event |= {"context": contexts[i]} if i < len(contexts) else {}
            found.append(event)
    return found


def _numbers(data: bytes, kind: int, processor: int) -> np.ndarray:
    """Give the numbers of a parameter's data."""
    if kind == _BYTE:
        return np.frombuffer(data, np.uint8)
    data = data[: len(data) // kind * kind]
    order = ">" if processor == _MIPS else "<"
    if kind == _INTEGER:
        return np.frombuffer(data, f"{order}i2")
    if processor != _DEC:
        return np.frombuffer(data, f"{order}f4").astype(np.float64)
    halves = np.frombuffer(data, "<u2").reshape(-1, 2).astype(np.uint32)
    return (halves[:, 0] << 16 | halves[:, 1]).view(np.float32).astype(np.float64) / 4


def _texts(parameter: Parameter) -> list[str]:
    width = parameter.dimensions[0] if parameter.dimensions else len(parameter.data)
    if width == 0:
        return []
    return [_text(parameter.data[i : i + width]) for i in range(0, len(parameter.data), width)]


def _text(data: bytes) -> str:
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return re.sub(r"[\0-\x1f]+", " ", text).strip()
