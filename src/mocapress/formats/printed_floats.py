"""Float32 numbers that were printed as decimals.

Many programs hold float32, and print them with more digits than these have: 984.672546 is the
float32 984.67254638671875 with six decimals. As decimals they would cost the bits of all digits.
"""

import numpy as np
from numpy.typing import NDArray

from mocapress.formats.number_formats import printed
from mocapress.motion.number_format import NumberFormat, NumberKind

Values = NDArray[np.float64]

_GAIN = 0.5
"""Bits of a number that have to be saved."""
_DECIMAL = (NumberKind.FIXED, NumberKind.GENERAL)


def as_floats(numbers: Values, number_format: NumberFormat) -> Values:
    """Give the float32 that were printed, (N,); the numbers as they are where that is not so."""
    if number_format.kind not in _DECIMAL or not _is_coarser(numbers, number_format):
        return numbers
    with np.errstate(over="ignore", invalid="ignore"):
        floats = numbers.astype(np.float32).astype(np.float64)
    moved = (floats != numbers) & ~np.isnan(numbers)
    same = printed(floats[moved], number_format) == printed(numbers[moved], number_format)
    return floats if same else numbers


def as_printed(numbers: Values, number_format: NumberFormat) -> Values:
    """Give the numbers that stand in the file, of any that ``as_floats`` gave, (N,)."""
    if number_format.kind not in _DECIMAL:
        return numbers
    with np.errstate(over="ignore", invalid="ignore"):
        floats = numbers.astype(np.float32).astype(np.float64)
    if not np.array_equal(floats, numbers, equal_nan=True):
        return numbers
    return np.array(printed(numbers, number_format), np.bytes_).astype(np.float64)


def _is_coarser(numbers: Values, number_format: NumberFormat) -> bool:
    """Tell whether the steps between float32 numbers are wider than those of the decimals."""
    size = np.abs(numbers[np.isfinite(numbers) & (numbers != 0)])
    if not size.size or size.max() > np.finfo(np.float32).max:
        return False
    exponent = np.floor(np.log2(np.maximum(size, 2.0**-126)))
    places = number_format.digits
    if number_format.kind == NumberKind.GENERAL:
        decimals = places - 1 - np.floor(np.log10(size))
    else:
        decimals = np.full(len(size), float(places))
    return bool(np.mean(exponent - 23 + decimals * np.log2(10)) > _GAIN)
