"""Numbers as text (docs/format/layout.md, "Number formats")."""

import math
from decimal import Decimal

from lines import bits32, digits32, of_bits32

GENERAL, FIXED, TRIMMED, SCIENTIFIC, SHORTEST, SHORTEST32 = range(6)
POINT_ZERO, BARE_POINT, UPPER, PLUS, ZEROS, END_POINT, JAVA, JAVASCRIPT = (1 << k for k in range(8))
BLANK_SIGN = 128


def padded(number: float, told: bytes, width: int) -> str:
    """Print a number as it stands in its place of a row."""
    text = printed(number, told)
    if width == BLANK_SIGN:
        return text if text[0] in "+-" else " " + text
    if width > BLANK_SIGN:
        return text.ljust(width - BLANK_SIGN)
    return text.zfill(width) if told[3] & ZEROS else text.rjust(width)


def printed(number: float, told: bytes) -> str:
    """Print a number in a format of four bytes."""
    kind, digits, exponent_digits, flags = told
    plus = "+" if flags & PLUS else ""
    sign, size = "-" if math.copysign(1.0, number) < 0 else plus, abs(number)
    if kind == SHORTEST32 and size <= math.inf:  # pragma: no cover - in test_reader
        size = of_bits32(bits32(size))
    if not size < math.inf:  # pragma: no cover - in test_reader
        return sign + ("inf" if size == math.inf else "nan")
    if kind in (FIXED, TRIMMED):
        text = fixed(size, kind, digits, flags)
    elif size == 0 and kind != SCIENTIFIC:
        text = "0" + whole_end(flags)
    else:
        text = laid_out(*significant(size, kind, digits), kind, digits, flags)
    mantissa, mark, exponent = text.partition("e")
    if mark:
        size_of_exponent = str(abs(int(exponent))).rjust(exponent_digits, "0")
        shown = "-" if exponent[0] == "-" else "" if flags & JAVA else "+"
        text = f"{mantissa}{'E' if flags & UPPER else 'e'}{shown}{size_of_exponent}"
    return sign + text


def fixed(size: float, kind: int, decimals: int, flags: int) -> str:
    """Print decimals."""
    scaled = size * 10.0**decimals if decimals <= 15 else math.inf
    if scaled < 1e15:
        digits = f"{round(scaled):0{decimals + 1}d}"
        whole = len(digits) - decimals
        text = digits[:whole] + ("." + digits[whole:] if decimals else "")
    else:
        text = f"{size:.{decimals}f}"
    if flags & BARE_POINT and text.startswith("0."):
        text = text[1:]
    if kind == TRIMMED and decimals:  # pragma: no cover - in test_reader
        text = text.rstrip("0")
        if text.endswith("."):
            text = (text[:-1] or "0"[: not flags & POINT_ZERO]) + whole_end(flags)
    return text + "." * (not decimals and flags & END_POINT > 0)


def whole_end(flags: int) -> str:
    """Give what follows a whole number."""
    return ".0" if flags & POINT_ZERO else "." if flags & END_POINT else ""


def significant(size: float, kind: int, count: int) -> tuple[str, int]:
    """Give the significant digits of a number and the exponent of the first."""
    if kind == GENERAL and count <= 15 and 1e-7 <= size < 1e22:
        exponent = Decimal(size).adjusted()
        shift = count - 1 - exponent
        digits = str(round(size * 10.0**shift if shift >= 0 else size / 10.0**-shift))
        return digits[:count], exponent + len(digits) - count
    if kind == SHORTEST:
        _, found, power = Decimal(repr(size)).as_tuple()
        digits = "".join(map(str, found))
        return digits, int(power) + len(digits) - 1
    text = digits32(size) if kind == SHORTEST32 else f"{size:.{count - (kind == GENERAL)}e}"
    mantissa, _, exponent_text = text.partition("e")
    return mantissa.replace(".", ""), int(exponent_text)


def laid_out(digits: str, exponent: int, kind: int, count: int, flags: int) -> str:
    """Put the point, and an exponent where there is one."""
    least, limit = -4, count if kind == GENERAL else 16
    if flags & JAVA:
        least, limit = -3, 7
    elif flags & JAVASCRIPT:
        least, limit = -6, 21
    if kind != SCIENTIFIC:
        digits = digits.rstrip("0")
    if kind == SCIENTIFIC or not least <= exponent < limit:
        rest = digits[1:] or ("0" if flags & JAVA else "")
        return f"{digits[0]}.{rest}".rstrip(".") + f"e{exponent}"
    if exponent < 0:
        return ("." if flags & BARE_POINT else "0.") + "0" * (-exponent - 1) + digits
    whole, rest = digits[: exponent + 1].ljust(exponent + 1, "0"), digits[exponent + 1 :]
    return whole + (f".{rest}" if rest else whole_end(flags))
