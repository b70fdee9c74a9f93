"""A value of JSON that knows its path, so that an error can name the place."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError

_NOTHING = object()
_LONGEST = 40


@dataclass(frozen=True, slots=True)
class JsonValue:
    """A value, and the JSON path that leads to it; ``get`` and ``items`` go further down.

    All methods raise FormatError, with the path, where the value is another than asked for.
    """

    value: Any
    path: str = "$"

    def fail(self, expected: str, found: str | None = None) -> NoReturn:
        """Say what should stand here."""
        raise FormatError(self.path, expected=expected, found=found or _described(self.value))

    @property
    def missing(self) -> bool:
        """Whether nothing stands here."""
        return self.value is _NOTHING

    def get(self, key: str) -> "JsonValue":
        """Go to a key of an object; the value may be missing."""
        if not isinstance(self.value, dict):
            self.fail("an object")
        return JsonValue(self.value.get(key, _NOTHING), f"{self.path}.{key}")

    def items(self, count: int | None = None) -> "list[JsonValue]":
        """Give the items of an array, of so many where that is said."""
        if not isinstance(self.value, list):
            self.fail("an array")
        if count is not None and len(self.value) != count:
            self.fail(f"{count} items", str(len(self.value)))
        return [JsonValue(value, f"{self.path}[{i}]") for i, value in enumerate(self.value)]

    def text(self) -> str:
        """Give a string."""
        if not isinstance(self.value, str):
            self.fail("a string")
        return self.value

    def choice(self, known: Sequence[str], default: str | None = None) -> str:
        """Give one of some strings; ``default`` where nothing stands here."""
        if self.missing and default is not None:
            return default
        if self.value not in known:
            self.fail(" or ".join(f'"{word}"' for word in known))
        return self.text()

    def number(self, least: float = -inf, most: float = inf) -> float:
        """Give a finite number."""
        if not isinstance(self.value, float) or not isfinite(self.value):
            self.fail("a finite number")
        if not least <= self.value <= most:
            self.fail(f"{least:g} to {most:g}")
        return self.value

    def positive(self) -> float:
        """Give a finite number above 0."""
        if self.number() <= 0:
            self.fail("a number above 0")
        return self.number()

    def integer(self, least: int, most: int) -> int:
        """Give a whole number."""
        if not self.number().is_integer():
            self.fail("an integer")
        return int(self.number(least, most))

    def numbers(self, count: int | None = None) -> NDArray[np.float64]:
        """Give an array of finite numbers: (count,) float64."""
        items = self.value
        # The quick way, which makes no paths.
        if isinstance(items, list) and all(type(item) is float for item in items):
            found = np.array(items, dtype=np.float64)
            if count in (None, len(items)) and np.isfinite(found).all():
                return found
        return np.array([item.number() for item in self.items(count)], dtype=np.float64)


def parse(data: bytes) -> JsonValue:
    """Read JSON; all numbers become floats.

    Raises
    ------
    FormatError
        When it is none, or nested too deeply to be read.

    """

    def refuse(constant: str) -> NoReturn:
        raise ValueError(f"{constant} is no JSON")

    try:
        return JsonValue(json.loads(data, parse_int=float, parse_constant=refuse))
    except RecursionError:
        raise FormatError("$", expected="JSON", found="nesting too deep to be read") from None
    except ValueError as error:
        raise FormatError("$", expected="JSON", found=str(error)) from None


def _described(value: Any) -> str:
    if value is _NOTHING:
        return "nothing"
    if isinstance(value, list):
        return f"an array of {len(value)}"
    if isinstance(value, dict):
        return "an object"
    text = json.dumps(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
