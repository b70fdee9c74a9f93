"""DiffMA JSON: writing and reading documents (docs/guide/diffma_json.md)."""

import base64
import binascii
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.diffma.coding import (
    MOST_BITS,
    MOST_ORDER,
    MOST_WINDOW,
    Coding,
    Plan,
    Record,
)
from mocapress.codecs.diffma.json_value import JsonValue, parse
from mocapress.codecs.diffma.skeleton_json import ColumnPlace, read_skeleton, skeleton_keys
from mocapress.motion import Skeleton

_LIST = {"separators": (",", ":")}
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
            JsonValue(None, f"{place}.b[{c}]").fail("finite values", found)
        return np.ascontiguousarray(channels.T)

    def to_json(self) -> bytes:
        """Give the document as JSON text, ASCII."""
        parts = [
            f'"channels":{json.dumps(self.names, **_LIST)}',  # type: ignore[arg-type]
            f'"records":{_records_text(self.records)}',
            f'"params":{json.dumps(self._params(), **_LIST)}',  # type: ignore[arg-type]
        ]
        if self.levels:
            levels = [
                f'{{"bound":{_number(level.bound)},"records":{_records_text(level.records)}}}'
                for level in self.levels
            ]
            parts.append(f'"levels":[{",".join(levels)}]')
        if self.skeleton is not None:
            keys = skeleton_keys(self.skeleton, self.places)
            parts.append(f'"skeleton":{json.dumps(keys, **_LIST)}')  # type: ignore[arg-type]
        if self.frame_time is not None:
            parts.append(f'"frameTime":{self.frame_time}')
        if self.layout:
            parts.append(f'"layout":"{base64.b64encode(self.layout).decode()}"')
        return f"{{{','.join(parts)}}}".encode("ascii")

    def _params(self) -> dict[str, Any]:
        bounds = [_number(plan.bound) for plan in self.plans]
        orders = [plan.order for plan in self.plans]
        limits = [_limit(plan.max_error) for plan in self.plans]
        published = len(set(bounds)) <= 1 and not any(orders)
        params: dict[str, Any] = {
            "class": "DiffMA" if published else "DiffMAx",
            "bits": self.coding.bits,
            "window": self.coding.window,
            "bound": _shared(bounds, 1),
            "tolerance": _limit(self.coding.tolerance),
            "roundOffset": _number(self.coding.round_offset),
            "encoding": _encoding(self.coding.bits),
        }
        if any(orders):
            params["order"] = _shared(orders, 0)
        if any(limit is not None for limit in limits):
            params["maxError"] = _shared(limits, None)
        return params


def read_document(data: bytes) -> Document:
    """Read a document.

    Raises
    ------
    FormatError
        When it breaks the format: with the JSON path, what was expected and what was found.

    """
    root = parse(data)
    names = tuple(item.text() for item in root.get("channels").items())
    coding, plans = _read_params(root.get("params"), len(names))
    records, frames = _read_records(root.get("records"), len(names), coding.bits, None)
    skeleton, places = read_skeleton(root.get("skeleton"), len(names))
    time, layout = root.get("frameTime"), root.get("layout")
    return Document(
        names,
        coding,
        plans,
        records,
        frames,
        _read_levels(root.get("levels"), len(names), coding.bits, frames),
        skeleton,
        places,
        None if time.missing else Decimal(repr(time.number(0))),
        b"" if layout.missing else _read_base64(layout),
    )


def _read_params(params: JsonValue, channels: int) -> tuple[Coding, tuple[Plan, ...]]:
    bits = params.get("bits").integer(1, MOST_BITS)
    params.get("encoding").choice([_encoding(bits)], None if bits > 6 else "base85")
    params.get("class").choice(["DiffMA", "DiffMAx"], "DiffMA")
    window = params.get("window").integer(1, MOST_WINDOW)
    bounds = [value.positive() for value in _per_channel(params.get("bound"), channels)]
    orders = [0] * channels
    if not params.get("order").missing:
        each = _per_channel(params.get("order"), channels)
        orders = [value.integer(0, MOST_ORDER) for value in each]
    tolerance, offset = params.get("tolerance"), params.get("roundOffset")
    coding = Coding(
        bits,
        window,
        inf if tolerance.missing or tolerance.value is None else tolerance.positive(),
        0.5 if offset.missing else offset.number(0, 1),
    )
    return coding, tuple(Plan(*pair) for pair in zip(bounds, orders, strict=True))


def _per_channel(value: JsonValue, channels: int) -> list[JsonValue]:
    return value.items(channels) if isinstance(value.value, list) else [value] * channels


def _read_records(
    records: JsonValue, channels: int, bits: int, frames: int | None
) -> tuple[tuple[Record, ...], int]:
    """Read records; ``frames`` is what every channel must have, or None: what the first has."""
    found = []
    tables = records.get("t").items(channels)
    for text, table in zip(records.get("b").items(channels), tables, strict=True):
        opcodes, numbers = text.text().encode("utf-8", "surrogatepass"), table.numbers()
        steps, raws, fault, at = _core.diffma_scan(opcodes, bits)
        if fault:
            expected = {
                _ALPHABET: "characters of the base85 alphabet (RFC 1924)",
                _OPCODE: f"opcodes of {bits} bits",
            }.get(fault, "a second character")
            place = f"{json.dumps(text.text()[at])} at {at}" if at < len(text.text()) else "the end"
            text.fail(expected, place)
        length = steps + 1 if len(opcodes) or len(numbers) else 0
        if length and len(numbers) != raws + 1:
            table.fail(f"{raws + 1} numbers, one and one per RAW", str(len(numbers)))
        frames = length if frames is None else frames
        if length != frames:
            text.fail(f"{frames} frames, as channel 0 has", str(length))
        found.append(Record(opcodes, numbers))
    return tuple(found), frames or 0


def _read_levels(levels: JsonValue, channels: int, bits: int, frames: int) -> tuple[Level, ...]:
    if levels.missing:
        return ()
    return tuple(
        Level(
            level.get("bound").positive(),
            _read_records(level.get("records"), channels, bits, frames)[0],
        )
        for level in levels.items()
    )


def _read_base64(value: JsonValue) -> bytes:
    try:
        return base64.b64decode(value.text(), validate=True)
    except (binascii.Error, ValueError):
        value.fail("base64")


def _records_text(records: Sequence[Record]) -> str:
    opcodes = ",".join(f'"{record.opcodes.decode()}"' for record in records)
    tables = ",".join(f"[{_numbers_text(record.table)}]" for record in records)
    return f'{{"b":[{opcodes}],"t":[{tables}]}}'


def _numbers_text(numbers: NDArray[np.float64]) -> str:
    return re.sub(r"\.0(?=,|$)", "", ",".join(map(repr, numbers.tolist())))


def _encoding(bits: int) -> str:
    return "base85" if bits <= 6 else "base85x2"


def _shared(values: list[Any], default: Any) -> Any:
    """Give the one value that all have, or all of them."""
    return values if len(set(values)) > 1 else next(iter(values), default)


def _limit(value: float) -> int | float | None:
    return None if value == inf else _number(value)


def _number(value: float) -> int | float:
    return int(value) if value.is_integer() and abs(value) < 1e15 else value
