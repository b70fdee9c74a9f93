"""Float32 numbers that were printed as decimals.

Many programs hold float32, and print them with more digits than these have: 984.672546 is the
float32 984.67254638671875 with six decimals. As decimals they would cost the bits of all digits.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.formats.number_formats import printed
from mocapress.motion.number_format import NumberFormat, NumberKind

Values = NDArray[np.float64]

_GAIN = 0.5
"""Bits of a number that have to be saved."""
_TOGETHER = 2**20
"""Numbers that are looked at together, about."""
_WHOLE = 1e7
_DECIMAL = (NumberKind.FIXED, NumberKind.GENERAL)


def coarser_floats(numbers: Values, formats: Sequence[NumberFormat]) -> list[int]:
    """Give the columns, of (F, C), that float32 would be coarser in than how they are printed."""
    digits = np.array([f.digits if f.kind in _DECIMAL else -1 for f in formats])
    significant = np.array([f.kind == NumberKind.GENERAL for f in formats], bool)
    found: list[int] = []
    for some in _slices(*numbers.shape):
        coarser = _coarser(numbers[:, some], digits[some], significant[some])
        found += (some.start + np.flatnonzero(coarser)).tolist()
    return found


def _coarser(
    numbers: Values, digits: NDArray[np.int64], significant: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Tell whether steps between float32 numbers are wider than those of the decimals, (C,)."""
    size = np.abs(numbers)
    usual = np.isfinite(size) & (size != 0)
    size[~usual] = 1
    exponent = np.floor(np.log2(np.maximum(size, 2.0**-126)))
    decimals = np.where(significant, digits - 1 - np.floor(np.log10(size)), digits)
    gain = np.where(usual, exponent - 23 + decimals * np.log2(10), 0)
    mean = gain.sum(axis=0) / np.maximum(usual.sum(axis=0), 1)
    fits = size.max(axis=0, initial=0) <= np.finfo(np.float32).max
    return np.asarray((mean > _GAIN) & fits & (digits >= 0))


def as_floats(numbers: Values, number_format: NumberFormat) -> Values:
    """Give the float32 that were printed, (N,); the numbers as they are where that is not so."""
    with np.errstate(over="ignore", invalid="ignore"):
        floats = numbers.astype(np.float32).astype(np.float64)
    moved = (floats != numbers) & ~np.isnan(numbers)
    same = printed(floats[moved], number_format) == printed(numbers[moved], number_format)
    return floats if same else numbers


def rounded_floats(numbers: Values) -> NDArray[np.bool_]:
    """Tell of columns, of (F, C), whether they may be what ``as_floats`` made of others, (C,)."""
    found = np.empty(numbers.shape[1], np.bool_)
    for some in _slices(*numbers.shape):
        own = numbers[:, some]
        with np.errstate(over="ignore", invalid="ignore"):
            floats = (own == own.astype(np.float32)) | np.isnan(own)
            # These are printed as they are.
            whole = (own == np.rint(own)) & (np.abs(own) < _WHOLE)
        found[some] = floats.all(axis=0) & ~whole.all(axis=0)
    return found


def as_printed(numbers: Values, number_format: NumberFormat) -> Values:
    """Give the numbers that stand in the file for those that ``as_floats`` gave, (N,)."""
    if number_format.kind not in _DECIMAL:
        return numbers
    return np.array(printed(numbers, number_format), np.bytes_).astype(np.float64)


def _slices(frames: int, columns: int) -> Iterator[slice]:
    """Give runs of columns that hold few enough numbers to be looked at together."""
    width = max(_TOGETHER // max(frames, 1), 1)
    return (slice(first, first + width) for first in range(0, columns, width))
