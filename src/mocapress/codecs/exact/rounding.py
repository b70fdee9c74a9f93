"""Finding the decimals that were stored as float32."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

_SAMPLE = 64
_MOST_DIGITS = 7
"""A float32 keeps no more of them."""
_MOST_DECIMALS = 9
_MOST_POWER = 22
"""Up to it a power of ten is a float64."""
_ROUNDED = 15 / 16
"""The least share of numbers that have to be decimals."""


@dataclass(frozen=True, slots=True)
class Rounding:
    """To so many decimals, or to so many significant digits."""

    digits: int
    significant: bool

    def _decimals(self, values: Values) -> NDArray[np.int64]:
        if not self.significant:
            return np.full(values.shape, self.digits)
        with np.errstate(divide="ignore"):
            exponents = np.floor(np.log10(np.abs(values)))
        exponents[~np.isfinite(exponents)] = 0
        decimals: Values = np.clip(self.digits - 1 - exponents, -_MOST_POWER, _MOST_POWER)
        return decimals.astype(np.int64)

    def of(self, values: Values) -> Values:
        """Give numbers rounded; finite ones must be float32."""
        decimals = self._decimals(values)
        with np.errstate(invalid="ignore"):
            up, down = 10.0 ** np.maximum(decimals, 0), 10.0 ** np.maximum(-decimals, 0)
            return np.copysign(np.rint(values * up / down) / up * down, values)

    def steps(self, values: Values) -> Values:
        """Give the distances between rounded numbers near some."""
        steps: Values = 10.0 ** -self._decimals(values).astype(np.float64)
        return steps

    def keeps(self, values: Values) -> bool:
        """Tell whether nearly all numbers come back as float32 from what they are rounded to."""
        same = self.of(values).astype(np.float32) == values
        return bool(same.mean() >= _ROUNDED)


def find_rounding(distinct: Values) -> Rounding | None:
    """Find the coarsest rounding that keeps float32 numbers, (N,), N > 0; None if there is none."""
    sample = distinct[:: len(distinct) // _SAMPLE + 1]
    found = []
    for significant, most in ((False, _MOST_DECIMALS), (True, _MOST_DIGITS)):
        tried = (Rounding(digits, significant) for digits in range(1, most + 1))
        kept = (one for one in tried if one.keeps(sample) and one.keeps(distinct))
        found += [one for one in [next(kept, None)] if one is not None]
    return max(found, key=lambda one: float(np.log(one.steps(sample)).sum()), default=None)
