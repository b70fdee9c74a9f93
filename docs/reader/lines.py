"""Lines of numbers: the numbers that a column can hold, in order, each with a place."""

import math
import struct
from decimal import Decimal

FLOAT64, FLOAT32, SIGNIFICANT, DECIMALS, SHORTEST32, PRINTED32, DEGREES32 = range(7)
DEGREES = 57.29577951308232
INFINITY32 = 0x7F800000
LARGEST32 = 3.4028234663852886e38
FAR = 2**62


def bits64(number: float) -> int:
    """Give the 64 bits of a number."""
    return int(struct.unpack("<Q", struct.pack("<d", number))[0])


def of_bits64(bits: int) -> float:
    """Give the number of 64 bits."""
    return float(struct.unpack("<d", struct.pack("<Q", bits))[0])


def bits32(number: float) -> int:
    """Give the 32 bits of the nearest float32."""
    try:
        return int(struct.unpack("<I", struct.pack("<f", number))[0])
    except OverflowError:
        return INFINITY32 | (number < 0) << 31


def bits32_within(number: float) -> int:
    """Give the same, but those of infinity for all beyond the largest float32."""
    return bits32(math.copysign(math.inf, number) if abs(number) > LARGEST32 else number)


def of_bits32(bits: int) -> float:
    """Give the float32 of 32 bits."""
    return float(struct.unpack("<f", struct.pack("<I", bits))[0])


def nearest_whole(number: float) -> float:
    """Round to a whole number, ties to even (below 2^51)."""
    return (number + 1.5 * 2.0**52) - 1.5 * 2.0**52


def power_of_ten(exponent: int) -> float:
    """Give the double next to it."""
    return float(f"1e{exponent}")


def decade_of_number(magnitude: float) -> int:
    """Give the largest E from -307 to 308 of which 10^E is not above a magnitude, or -307."""
    decade = (bits64(magnitude) >> 52) - 1023
    decade = min(max(decade * 78913 >> 18, -308), 308)
    return decade + (decade < -307 or magnitude >= power_of_ten(decade + 1))


def digits32(number: float) -> str:
    """Print a float32 > 0 as %e does, with the fewest digits that name it.

    Of several, the nearest; of two as near, the one that is even.
    """
    bits = bits32(number)
    for count in range(9):
        digits, _, exponent = f"{number:.{count}e}".partition("e")
        whole, power = int(digits.replace(".", "")), int(exponent) - count
        near = [f"{whole + more}e{power}" for more in (0, 1, -1)]
        named = [text for text in near if bits32(float(text)) == bits]
        if named:
            best = min(named, key=lambda text: abs(Decimal(text) - Decimal(number)))
            return f"{float(best):.{count}e}"
    raise ValueError(number)


def rounded(number: float, kind: str, digits: int) -> float:
    """Round a float to what its column prints: ``significant``, ``decimals``, ``shortest32``."""
    if number == 0 or not math.isfinite(number):
        return number
    if kind == "significant" and 1 <= digits <= 15:
        return float(f"{number:.{digits - 1}e}")
    if kind == "decimals" and 0 <= digits <= 22 and abs(number) * 10.0**digits < 2**51:
        return float(f"{number:.{digits}f}")
    if kind == "shortest32":
        return math.copysign(float(digits32(abs(number))), number)
    return number


class Line:
    """A line of some kind and digits."""

    def __init__(self, kind: int, digits: int) -> None:
        self.kind = kind
        self.digits = digits
        self.bits = {FLOAT64: 64, FLOAT32: 32, SHORTEST32: 32}.get(kind, 0)
        self.printed = kind in (PRINTED32, DEGREES32)
        self.per_decade = 9 * 10 ** (digits - 1) if kind == SIGNIFICANT else 0
        self.scale = power_of_ten(digits) if kind == DECIMALS or self.printed else 1.0
        self.unit = DEGREES if kind == DEGREES32 else 1.0
        if self.printed:
            coarse = 2.0**-126
            while coarse * 2.0**-23 * self.unit * self.scale <= 1:
                coarse *= 2
            self.coarse_bits = bits32(coarse)
            self.coarse = self._decimal_place(coarse * self.unit)

    def _decimal_place(self, magnitude: float) -> int:
        scaled = magnitude * self.scale
        return int(nearest_whole(scaled)) if scaled < 2**51 else FAR

    def _magnitude_place(self, magnitude: float) -> int:
        if self.kind != SIGNIFICANT:
            place = self._decimal_place(magnitude)
            if self.printed and place >= self.coarse:
                bits = min(max(bits32_within(magnitude / self.unit), self.coarse_bits), INFINITY32)
                place = self.coarse + bits - self.coarse_bits
            return place
        if magnitude < 1e-307:  # pragma: no cover - in test_extremes
            return 0
        if not magnitude < 1e300:  # pragma: no cover - in test_extremes
            return self.decade(300)
        decade = decade_of_number(magnitude)
        decimals = self.digits - 1 - decade
        if decimals > 308:  # pragma: no cover - in test_extremes
            scaled = (magnitude * 1e308) * power_of_ten(decimals - 308)
        elif decimals >= 0:
            scaled = magnitude * power_of_ten(decimals)
        else:
            scaled = magnitude / power_of_ten(-decimals)
        return self.decade(decade) + int(nearest_whole(scaled)) - self.per_decade // 9

    def _magnitude_number(self, place: int) -> float:
        if self.printed and place >= self.coarse:
            bits = min(place - self.coarse + self.coarse_bits, INFINITY32)
            return nearest_whole(of_bits32(bits) * self.unit * self.scale) / self.scale
        if self.kind != SIGNIFICANT:
            return place / self.scale
        if place == 0:  # pragma: no cover - in test_extremes
            return 0.0
        decade, digits = divmod(place - 1, self.per_decade)
        return float(f"{digits + self.per_decade // 9}e{decade - 307 - self.digits + 1}")

    def near(self, number: float) -> int:
        """Give a place next to a number."""
        if self.bits:
            number += 0.0
            bits = bits64(number) if self.bits == 64 else bits32_within(number)
            top = 1 << self.bits - 1
            return bits if bits < top else top - 1 - bits
        return self._magnitude_place(number) if number > 0 else -1 - self._magnitude_place(-number)

    def number(self, place: int) -> float:
        """Give the number at a place."""
        if not self.bits:
            at = self._magnitude_number(place if place >= 0 else -1 - place)
            return at if place >= 0 else -at
        bits = place if place >= 0 else (1 << self.bits - 1) - 1 - place
        number = of_bits64(bits) if self.bits == 64 else of_bits32(bits)
        return rounded(number, "shortest32", 0) if self.kind == SHORTEST32 else number

    def step(self, number: float) -> float:
        """Give the distance of the numbers near a number."""
        size = abs(number)
        if self.bits:
            return size * (2.0**-52 if self.bits == 64 else 2.0**-23)
        if self.kind == DECIMALS:
            return 1 / self.scale
        if self.printed:
            return max(1 / self.scale, size * 2.0**-23)
        return power_of_ten(decade_of_number(size) - self.digits + 1) if size >= 1e-290 else 1e-300

    def decade(self, exponent: int) -> int:
        """Give the place where a decade of significant numbers begins."""
        return (exponent + 307) * self.per_decade + 1

    def decade_of(self, place: int) -> int:
        """Give the decade of a place > 0."""
        return (place - 1) // self.per_decade - 307
