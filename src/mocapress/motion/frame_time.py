"""Frame times, exactly as files state them."""

from decimal import Decimal, InvalidOperation, localcontext
from fractions import Fraction

from mocapress.errors import ParameterError

FrameTime = Decimal | Fraction | None
"""Seconds per frame, exactly; None where the source does not say."""

_RATE_DIGITS, _LONGEST_RATE = 9, 100
"""Digits of a rate before or behind its point; characters."""


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


def rate_of(text: str) -> Fraction | None:
    """Give the rate that a file states, in frames per second; None where it is no usual number."""
    try:
        number = Decimal(text)
    except InvalidOperation:
        return None
    # As a fraction, 1e-999999999 would take time without end.
    usual = number.is_finite() and number > 0 and abs(number.adjusted()) < _RATE_DIGITS
    return Fraction(number) if usual and len(text) < _LONGEST_RATE else None


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
