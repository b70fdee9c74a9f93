"""Number formats as bytes, and numbers printed in them."""

from collections.abc import Sequence
from decimal import Decimal
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import UnsupportedError
from mocapress.motion.number_format import NumberFormat, NumberKind
from mocapress.records import Reader

SHORTEST = NumberFormat(NumberKind.SHORTEST)
"""How numbers are printed that were never text."""
_FLAGS = (
    "point_zero",
    "bare_point",
    "upper",
    "plus",
    "zeros",
    "end_point",
    "java",
    "javascript",
)
_KNOWN = 2**10
"""Formats of which records are kept: a wide table asks for the same few over and over."""
_LAST_KIND = max(NumberKind)
_MOST_DIGITS = 40
_MOST_EXPONENT_DIGITS = 8
# Of a time or a rate that a header states: digits, and digits before or behind the point.
_STATED_DIGITS, _STATED_SIZE = 100, 18


def packed(formats: Sequence[NumberFormat]) -> NDArray[np.uint8]:
    """Give formats as the compiled core and files have them: (C, 4) uint8."""
    records = bytearray().join(map(record_of, formats))
    return np.frombuffer(records, np.uint8).reshape(len(formats), 4)


@lru_cache(_KNOWN)
def record_of(f: NumberFormat) -> bytes:
    """Give a format as a record (docs/format/layout.md, section "Number formats")."""
    flags = sum(getattr(f, name) << bit for bit, name in enumerate(_FLAGS))
    return bytes((f.kind, f.digits, f.exponent_digits, flags))


def unpacked(rows: NDArray[np.uint8]) -> tuple[NumberFormat, ...]:
    """Give the formats that ``packed`` packs."""
    return tuple(_format(*row) for row in rows.tolist())


@lru_cache(_KNOWN)
def _format(kind: int, digits: int, exponent_digits: int, flags: int) -> NumberFormat:
    own = (bool(flags >> bit & 1) for bit in range(len(_FLAGS)))
    return NumberFormat(NumberKind(kind), digits, exponent_digits, *own)


def read_format(reader: Reader) -> NumberFormat:
    """Take a format."""
    kind, digits, exponent_digits, flags = reader.raw(4)
    if (
        kind > _LAST_KIND
        or digits > _MOST_DIGITS
        or exponent_digits > _MOST_EXPONENT_DIGITS
        or flags & 192 == 192  # Java and JavaScript
        or (kind == NumberKind.GENERAL and not 1 <= digits <= 17)
    ):
        raise reader.fail("no such number format")
    return _format(kind, digits, exponent_digits, flags)


def printed(
    values: NDArray[np.float64] | Sequence[float], number_format: NumberFormat
) -> list[bytes]:
    """Print values, (N,), in a format."""
    column = np.array(values, np.float64).reshape(-1, 1)
    text: bytes = _core.print_rows(
        column,
        np.empty(0, np.int64),
        np.zeros(len(values), np.int32),
        [(False, [b"", b"\n"], [0], [0], 0)],
        packed((number_format,)),
        np.empty(0, np.uint64),
        np.empty(0, np.uint32),
        [],
        [],
        2**62,
    )
    return text.split(b"\n")[:-1]


def to_state(number: Decimal) -> str:
    """Print a time or a rate for a header.

    Raises
    ------
    UnsupportedError
        When it is absurd, so that it would not be read again.

    """
    if not _is_usual(number):
        raise UnsupportedError(
            "frame time", expected=f"1e-{_STATED_SIZE} to 1e{_STATED_SIZE}", found=f"{number:.6g}"
        )
    return f"{number:f}"


def _is_usual(number: Decimal) -> bool:
    # Whatever is done with others would take time and memory without end.
    usual = number.is_finite() and abs(number.adjusted()) < _STATED_SIZE
    return usual and len(number.as_tuple().digits) <= _STATED_DIGITS and number >= 0
