"""How a source printed the numbers of a column."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

_MOST_DIGITS = 17
"""So many tell any float64."""


class NumberKind(IntEnum):
    """The rule that turns a value into text; the names of C's ``printf`` stand beside each."""

    GENERAL = 0
    """``%.{digits}g``: significant digits, no trailing zeros, an exponent below 1e-4."""
    FIXED = 1
    """``%.{digits}f``: always that many decimals."""
    TRIMMED = 2
    """``%.{digits}f`` without trailing zeros, and without the point where nothing follows it."""
    SCIENTIFIC = 3
    """``%.{digits}e``."""
    SHORTEST = 4
    """Fewest digits that give the same float64, as Python's ``repr`` prints it."""
    SHORTEST32 = 5
    """Fewest digits that give the same float32, laid out like ``SHORTEST``."""


@dataclass(frozen=True, slots=True)
class NumberFormat:
    """The format of one column's numbers.

    A value of a column with ``GENERAL``, ``FIXED``, ``TRIMMED`` or ``SCIENTIFIC`` format lies on a
    decimal grid; a codec may code its index on that grid instead of the bits of the float.

    Attributes
    ----------
    kind
        The rule.
    digits
        Significant digits (``GENERAL``), decimals (the others); 0 and unused for ``SHORTEST``.
    exponent_digits
        Least number of digits of an exponent: 2 as C prints it, 3 as older Windows libraries do.
    point_zero
        Whether a whole number ends in ``.0`` (``TRIMMED``, ``SHORTEST``).
    bare_point
        Whether the zero before the point is left out: ``.5``.
    upper
        Whether the exponent is written ``E``.
    plus
        Whether a number that is not negative begins with ``+``.
    zeros
        Whether zeros pad it to its width: ``0012.5``.
    end_point
        Whether a whole number ends in a point: ``12.``.
    java
        ``SHORTEST``, an exponent below 1e-3 and from 1e7 on: ``1.0E-5``.
    javascript
        ``SHORTEST``, an exponent below 1e-6 and from 1e21 on: ``1e-7``.

    """

    kind: NumberKind
    digits: int = 0
    exponent_digits: int = 2
    point_zero: bool = False
    bare_point: bool = False
    upper: bool = False
    plus: bool = False
    zeros: bool = False
    end_point: bool = False
    java: bool = False
    javascript: bool = False

    def finer(self, more: int) -> "NumberFormat":
        """Give this format with so many more digits; the shortest where these tell any float64."""
        if more == 0 or self.kind == NumberKind.SHORTEST:
            return self
        if self.kind == NumberKind.SHORTEST32 or self.digits + more > _MOST_DIGITS:
            return NumberFormat(NumberKind.SHORTEST)
        return replace(self, digits=self.digits + more)

    def rounded(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give what values are once they are printed, but for ties."""
        match self.kind:
            case NumberKind.SHORTEST:
                return values
            case NumberKind.SHORTEST32:
                with np.errstate(over="ignore"):
                    return values.astype(np.float32).astype(np.float64)
            case NumberKind.FIXED | NumberKind.TRIMMED:
                decimals = np.full(values.shape, float(self.digits))
            case _:
                significant = self.digits + (self.kind == NumberKind.SCIENTIFIC)
                with np.errstate(divide="ignore", invalid="ignore"):
                    decimals = significant - 1 - np.floor(np.log10(np.abs(values)))
        # Beyond this a float64 has no such digits, or the number is 0 or none.
        known = np.isfinite(values) & (np.abs(decimals) < 300)
        scale = 10.0 ** np.where(known, decimals, 0)
        with np.errstate(over="ignore"):
            grid = np.rint(values * scale)
            return np.where(known & np.isfinite(grid), grid / scale, values)

    def __str__(self) -> str:
        """Say in words how the numbers look, without the finer points."""
        return _WORDS[self.kind].format(self.digits)


_WORDS = {
    NumberKind.GENERAL: "{} significant digits",
    NumberKind.FIXED: "{} decimals",
    NumberKind.TRIMMED: "up to {} decimals",
    NumberKind.SCIENTIFIC: "{} decimals and an exponent",
    NumberKind.SHORTEST: "shortest float64",
    NumberKind.SHORTEST32: "shortest float32",
}
