"""DiffMA JSON: writing and reading documents (docs/guide/diffma_json.md)."""

import base64
import binascii
import json
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import copysign, inf
from typing import TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.diffma import json_types
from mocapress.codecs.diffma.coding import Coding, Plan, Record
from mocapress.codecs.diffma.json_types import fail
from mocapress.codecs.diffma.skeleton_json import ColumnPlace, read_skeleton, write_skeleton
from mocapress.motion import Skeleton

T = TypeVar("T")
_ALPHABET, _OPCODE = 1, 2  # core/diffma/codec.hpp, Fault


@dataclass(frozen=True, slots=True)
class Level:
    """A level of detail: the same clip with a coarser bound."""

    bound: float
    records: tuple[Record, ...]


@dataclass(frozen=True, slots=True)
class Document:
    """What a DiffMA JSON holds."""

    names: tuple[str, ...]
    coding: Coding
    plans: tuple[Plan, ...]
    records: tuple[Record, ...]
    frames: int
    levels: tuple[Level, ...] = ()
    skeleton: Skeleton | None = None
    places: tuple[ColumnPlace, ...] = ()
    """With a skeleton: joint and kind of each channel."""
    frame_time: Decimal | None = None
    layout: bytes = b""

    def decode(self, bound: float | None = None) -> NDArray[np.float64]:
        """Give the values, (F, C) float64.

        ``bound`` takes the coarsest level of detail whose bound is not above it, if there is one.

        Raises
        ------
        FormatError
            When a value is too large for a double.

        """
        level = max(
            (level for level in self.levels if bound is not None and level.bound <= bound),
            key=lambda level: level.bound,
            default=None,
        )
        if level is None:
            place, plans, records = "$.records", self.plans, self.records
        else:
            place = f"$.levels[{self.levels.index(level)}].records"
            plans, records = (Plan(level.bound),) * len(self.names), level.records
        with np.errstate(over="ignore", invalid="ignore"):
            channels = self.coding.decode(records, plans, self.frames)
        for c in np.flatnonzero(~np.isfinite(channels).all(axis=1)).tolist():
            frame = int(np.flatnonzero(~np.isfinite(channels[c]))[0])
            found = f"{channels[c, frame]} in frame {frame}"
            fail(f"{place}.b[{c}]", "finite values", found)
        return np.ascontiguousarray(channels.T)

    def to_json(self) -> bytes:
        """Give the document as JSON text, UTF-8."""
        root = json_types.Root(list(self.names), _write_records(self.records), self._params())
        root.levels = [
            json_types.Level(_number(level.bound), _write_records(level.records))
            for level in self.levels
        ]
        if self.skeleton is not None:
            root.skeleton = write_skeleton(self.skeleton, self.places)
        if self.frame_time is not None:
            root.frame_time = float(self.frame_time)
        if self.layout:
            root.layout = base64.b64encode(self.layout).decode()
        return msgspec.json.encode(root)

    def _params(self) -> json_types.Params:
        bounds = [_number(plan.bound) for plan in self.plans]
        orders: list[float] = [plan.order for plan in self.plans]
        limits = [_limit(plan.max_error) for plan in self.plans]
        published = len(set(bounds)) <= 1 and not any(orders)
        params = json_types.Params(
            kind="DiffMA" if published else "DiffMAx",
            bits=self.coding.bits,
            window=self.coding.window,
            bound=_shared(bounds, 1),
            tolerance=_limit(self.coding.tolerance),
            round_offset=_number(self.coding.round_offset),
            encoding=_encoding(self.coding.bits),
        )
        if any(orders):
            params.order = _shared(orders, 0)
        if any(limit is not None for limit in limits):
            params.max_error = _shared(limits, None)
        return params


_MOST_CHANNELS = 2**18
"""As in the head of a ``.mcz``."""


def read_document(data: bytes) -> Document:
    """Read a document.

    Raises
    ------
    FormatError
        When it breaks the format: with the JSON path, what was expected and what was found.

    """
    root = json_types.read(data)
    channels = len(root.channels)
    if channels > _MOST_CHANNELS:
        fail("$.channels", f"at most {_MOST_CHANNELS} names", str(channels))
    coding, plans = _read_params(root.params, channels)
    records, frames = _read_records(root.records, "$.records", channels, coding.bits, None)
    levels = []
    for i, level in enumerate(root.levels):
        place = f"$.levels[{i}].records"
        own, _ = _read_records(level.records, place, channels, coding.bits, frames)
        levels.append(Level(level.bound, own))
    skeleton: Skeleton | None = None
    places: tuple[ColumnPlace, ...] = ()
    if root.skeleton is not msgspec.UNSET:
        skeleton, places = read_skeleton(root.skeleton, channels)
    return Document(
        tuple(root.channels),
        coding,
        plans,
        records,
        frames,
        tuple(levels),
        skeleton,
        places,
        None if root.frame_time is msgspec.UNSET else Decimal(repr(root.frame_time)),
        b"" if root.layout is msgspec.UNSET else _read_base64(root.layout),
    )


def _read_params(params: json_types.Params, channels: int) -> tuple[Coding, tuple[Plan, ...]]:
    bits = int(params.bits)
    if params.encoding != _encoding(bits):
        fail("$.params.encoding", f'"{_encoding(bits)}"', f'"{params.encoding}"')
    bounds = _per_channel(params.bound, "$.params.bound", channels)
    order = 0 if params.order is msgspec.UNSET else params.order
    orders = map(int, _per_channel(order, "$.params.order", channels))
    tolerance = inf if params.tolerance is None else params.tolerance
    coding = Coding(bits, int(params.window), tolerance, params.round_offset)
    return coding, tuple(Plan(*pair) for pair in zip(bounds, orders, strict=True))


def _per_channel(value: T | list[T], path: str, channels: int) -> list[T]:
    if not isinstance(value, list):
        return [value] * channels
    return _of_length(value, path, channels)


def _of_length(items: list[T], path: str, count: int) -> list[T]:
    if len(items) != count:
        fail(path, f"{count} items", str(len(items)))
    return items


def _read_records(
    records: json_types.Records, path: str, channels: int, bits: int, frames: int | None
) -> tuple[tuple[Record, ...], int]:
    """Read records; ``frames`` is what every channel must have, or None: what the first has."""
    found = []
    tables = _of_length(records.t, f"{path}.t", channels)
    texts = _of_length(records.b, f"{path}.b", channels)
    for i, (text, table) in enumerate(zip(texts, tables, strict=True)):
        opcodes = text.encode()
        steps, raws, fault, at = _core.diffma_scan(opcodes, bits)
        if fault:
            expected = {
                _ALPHABET: "characters of the base85 alphabet (RFC 1924)",
                _OPCODE: f"opcodes of {bits} bits",
            }.get(fault, "a second character")
            place = f"{json.dumps(text[at])} at {at}" if at < len(text) else "the end"
            fail(f"{path}.b[{i}]", expected, place)
        length = steps + 1 if len(opcodes) or len(table) else 0
        if length and len(table) != raws + 1:
            fail(f"{path}.t[{i}]", f"{raws + 1} numbers, one and one per RAW", str(len(table)))
        frames = length if frames is None else frames
        if length != frames:
            fail(f"{path}.b[{i}]", f"{frames} frames, as channel 0 has", str(length))
        found.append(Record(opcodes, np.array(table, dtype=np.float64)))
    return tuple(found), frames or 0


def _read_base64(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        fail("$.layout", "base64", json_types.described(text))


def _write_records(records: Sequence[Record]) -> json_types.Records:
    opcodes = [record.opcodes.decode() for record in records]
    return json_types.Records(
        opcodes, [list(map(_number, record.table.tolist())) for record in records]
    )


def _encoding(bits: int) -> json_types.Encoding:
    return "base85" if bits <= 6 else "base85x2"


def _shared(values: list[T], default: T) -> T | list[T]:
    """Give the one value that all have, or all of them."""
    return values if len(set(values)) > 1 else next(iter(values), default)


def _limit(value: float) -> float | None:
    return None if value == inf else _number(value)


def _number(value: float) -> float:
    """Give a whole number as an integer, which JSON writes without a point; -0.0 has no integer."""
    whole = value.is_integer() and abs(value) < 1e15 and (value or copysign(1, value) > 0)
    return int(value) if whole else value
