"""The keys of DiffMA JSON as types, which msgspec checks; ``schema.json`` is made of them.

What types cannot say (lengths that must agree, tables that fit their opcodes) is checked in
``document.py``.
"""

import json
import re
from typing import Annotated, Any, Literal, NoReturn, get_args

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from mocapress.codecs.diffma.coding import MOST_BITS, MOST_ORDER, MOST_WINDOW
from mocapress.errors import FormatError

_LONGEST = 40
_ALPHABET = "^[0-9A-Za-z!#$%&()*+;<=>?@^_`{|}~-]*$"

# JSON has one kind of number: 6.0 is an integer, so that integers are floats that have no rest.
Positive = Annotated[float, Meta(gt=0)]
Limit = Annotated[float, Meta(ge=0)] | None
Order = Annotated[float, Meta(ge=0, le=MOST_ORDER, multiple_of=1)]
Index = Annotated[float, Meta(ge=-1, multiple_of=1)]
Opcodes = Annotated[str, Meta(extra_json_schema={"pattern": _ALPHABET})]
Vector = tuple[float, float, float]
Kind = Literal["tx", "ty", "tz", "rx", "ry", "rz", "l"]
Rotation = Literal["moving", "fixed"]
AngleUnit = Literal["deg", "rad"]
AxisOrder = Literal["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"]
Class = Literal["DiffMA", "DiffMAx"]
Encoding = Literal["base85", "base85x2"]

# By the last key of the path: msgspec's message does not list what is allowed.
_CHOICES: dict[str, Any] = {
    "channels": Kind,
    "rotation": Rotation,
    "angleUnit": AngleUnit,
    "axisOrder": AxisOrder,
    "class": Class,
    "encoding": Encoding,
}
_KEY = re.compile(r"\.(\w+)|\[(\d+)\]")
_NAMES = {"float": "number", "str": "string", "|": "or"}


class Records(Struct):
    """The coded channels, in the order of ``channels``."""

    b: Annotated[list[Opcodes], Meta(description="Opcodes of each channel.")]
    t: Annotated[list[list[float]], Meta(description="Look-up table of each channel.")]


class Params(Struct, rename="camel", kw_only=True):
    """Parameters of the codec. Encoding is base85x2 if bits is above 6."""

    kind: Class = msgspec.field(name="class", default="DiffMA")
    bits: Annotated[float, Meta(ge=1, le=MOST_BITS, multiple_of=1, description="n")]
    window: Annotated[float, Meta(ge=1, le=MOST_WINDOW, multiple_of=1, description="w")]
    bound: Annotated[
        Positive | list[Positive],
        Meta(description="β, or one for each channel (class DiffMAx)."),
    ]
    tolerance: Annotated[
        Positive | None, Meta(description="τ; null: no limit. For the encoder only.")
    ] = None
    round_offset: Annotated[
        float,
        Meta(ge=0, le=1, description="Added before a quotient is cut off. For the encoder only."),
    ] = 0.5
    encoding: Encoding = "base85"
    order: Annotated[
        Order | list[Order] | UnsetType,
        Meta(
            description="Order of the predictor, or one for each channel (class DiffMAx); without "
            "it 0, as published."
        ),
    ] = UNSET
    max_error: Annotated[
        Limit | list[Limit] | UnsetType,
        Meta(
            description="Largest error of any sample, or one for each channel; null: no limit. "
            "For the encoder only."
        ),
    ] = UNSET


class Level(Struct):
    """A level of detail: the same clip with a coarser bound and order 0."""

    bound: Positive
    records: Records


class Joint(Struct, rename="camel", omit_defaults=True):
    """A joint of the skeleton."""

    name: str
    parent: Annotated[
        Index,
        Meta(description="Index of the parent, -1 for the root; smaller than the joint's own."),
    ]
    offset: Vector
    channels: tuple[Kind, ...] = ()
    axis: Vector | UnsetType = UNSET
    axis_order: AxisOrder = "xyz"
    ends: tuple[Vector, ...] = ()


class Skeleton(Struct, rename="camel", kw_only=True):
    """What a player needs to move a figure."""

    rotation: Rotation
    angle_unit: AngleUnit = "deg"
    length_unit: float | None = None
    joints: list[Joint]
    columns: Annotated[
        list[tuple[Index, str]],
        Meta(description="Of each channel: index of its joint (-1: none) and kind."),
    ]


class Root(Struct, rename="camel", omit_defaults=True):
    """Motion as opcodes and look-up tables (Nagao 2021), with the optional keys of mocapress."""

    channels: Annotated[list[str], Meta(description="Name of each channel.")]
    records: Records
    params: Params
    levels: list[Level] = msgspec.field(default_factory=list)
    skeleton: Skeleton | UnsetType = UNSET
    frame_time: Annotated[float, Meta(ge=0, description="Seconds.")] | UnsetType = UNSET
    layout: (
        Annotated[
            str,
            Meta(
                description="Base64; opaque to players: what mocapress needs to write the AMC or "
                "BVH again."
            ),
        ]
        | UnsetType
    ) = UNSET


def read(data: bytes) -> Root:
    """Read JSON whose keys have the right types.

    Raises
    ------
    FormatError
        With the JSON path, what was expected and what was found.

    """
    data = data.removeprefix(b"\xef\xbb\xbf")  # editors on Windows put a byte order mark there
    try:
        return msgspec.json.decode(data, type=Root)
    except RecursionError:
        raise FormatError("$", expected="JSON", found="nesting too deep to be read") from None
    except msgspec.ValidationError as error:
        _explain(data, str(error))
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise FormatError("$", expected="JSON", found=str(error)) from None


def fail(path: str, expected: str, found: str) -> NoReturn:
    """Say what should stand at a path."""
    raise FormatError(path, expected=expected, found=found)


def described(value: Any) -> str:
    """Say what stands at a path, briefly."""
    if isinstance(value, list):
        return f"an array of {len(value)}"
    if isinstance(value, dict):
        return "an object"
    text = json.dumps(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def _explain(data: bytes, message: str) -> NoReturn:
    what, _, place = message.partition(" - at `")
    path = place.removesuffix("`") or "$"
    missing = re.fullmatch(r"Object missing required field `(\w+)`", what)
    if missing:
        fail(f"{path}.{missing[1]}", "a value", "nothing")
    if what == "Number out of range":
        fail(path, "a finite number", "a number out of range")
    try:
        found = described(_value_at(msgspec.json.decode(data), path))
    except (msgspec.DecodeError, RecursionError):  # what is broken lies behind this place
        found = what.partition(", got ")[2] or "another value"
    if what.startswith("Invalid enum value"):
        key = _KEY.findall(re.sub(r"(\[\d+\])+$", "", path))[-1][0]
        fail(path, " or ".join(f'"{word}"' for word in get_args(_CHOICES[key])), found)
    expected = what.removeprefix("Expected ").partition(", got ")[0]
    words = expected.replace("`", "").split()
    fail(path, " ".join(_NAMES.get(word, word) for word in words), found)


def _value_at(value: Any, path: str) -> Any:
    for key, index in _KEY.findall(path):
        value = value[key] if key else value[int(index)]
    return value
