"""How a source printed the numbers of a column."""

from dataclasses import dataclass
from enum import IntEnum


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
