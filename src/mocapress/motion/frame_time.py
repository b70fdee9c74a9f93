"""Frame times, exactly as files state them."""

from decimal import Decimal, localcontext
from fractions import Fraction

from mocapress.errors import ParameterError

FrameTime = Decimal | Fraction | None
"""Seconds per frame, exactly; None where the source does not say."""


def of_rate(fps: float) -> Fraction:
    """Give the frame time of a rate in frames per second, which counts as the decimal it prints as.

    Raises
    ------
    ParameterError
        When it is no number above 0.

    """
    if not 0 < fps < float("inf"):
        raise ParameterError("fps", expected="a number above 0", found=str(fps))
    return 1 / Fraction(str(fps))


def decimal_seconds(frame_time: Decimal | Fraction) -> Decimal:
    """Give a frame time as a decimal: exactly where it is one, else the nearest short one."""
    return frame_time if isinstance(frame_time, Decimal) else short_decimal(frame_time)


def short_decimal(value: Fraction) -> Decimal:
    """Give the decimal of fewest digits that differs by less than one part in 10**18.

    So that a frame time of up to 17 digits comes back from the rate, and the rate from it. A
    decimal of up to 20 digits stays as it is: it may have been made here before.
    """
    with localcontext() as context:
        context.prec = 20
        exact = Decimal(value.numerator) / Decimal(value.denominator)
        if Fraction(exact) == value:
            return exact.normalize()
        for context.prec in range(1, 21):
            short = Decimal(value.numerator) / Decimal(value.denominator)
            if abs(Fraction(short) - value) * 10**18 < abs(value):
                break
    return short
