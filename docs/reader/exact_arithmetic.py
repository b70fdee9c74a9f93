"""Functions of additions, multiplications and divisions alone, the same on every machine."""

import math

from lines import bits64, of_bits64

LN2 = 0.6931471805599453
DEGREE = 0.017453292519943295
EIGHTHS = (
    *(0.0, 0.12435499454676144, 0.24497866312686414, 0.3587706702705722, 0.4636476090008061),
    *(0.5585993153435624, 0.6435011087932844, 0.7188299996216245, 0.7853981633974483),
)

Vector = tuple[float, float, float]


def natural_log(number: float) -> float:
    """Give about ln of a normal, positive number."""
    bits = bits64(number)
    x = of_bits64(bits % 2**52 | 1023 << 52) - 1
    series = x * (1.441949 + x * (-0.7091 + x * (0.415023 + x * (-0.192401 + x * 0.044529))))
    return (float((bits >> 52) - 1023) + series) * LN2


def natural_exp(number: float) -> float:
    """Give about e to the power of a number within 700."""
    power = number * (1 / LN2) + 1100
    whole = int(power)
    x = power - whole
    series = 1 + x * (0.692996 + x * (0.241566 + x * (0.051752 + x * 0.013686)))
    return series * 2.0 ** (whole - 1100)


def sine_cosine(angle: float) -> tuple[float, float]:
    """Give sine and cosine of radians; of 0 where they are beyond 10^6."""
    if not abs(angle) <= 1e6:  # pragma: no cover - no clip was found that has such angles
        angle = 0.0
    turns = angle * (1 / 1.5707963267948966)
    quarter = int(turns + (-0.5 if turns < 0 else 0.5))
    x = (angle - quarter * 1.5707963267948966) - quarter * 6.123233995736766e-17
    q = x * x
    sine = cosine = 1.0
    for n in (156, 110, 72, 42, 20, 6):
        sine = 1 - q * (1 / n) * sine
    for n in (182, 132, 90, 56, 30, 12, 2):
        cosine = 1 - q * (1 / n) * cosine
    sine = x * sine
    return ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[quarter & 3]


def sine_cosine_of_degrees(angle: float) -> tuple[float, float]:
    """Give sine and cosine of degrees."""
    return sine_cosine(angle * DEGREE)


def arc_tangent(y: float, x: float) -> float:
    """Give the angle of (x, y) in radians."""
    up, along = abs(y), abs(x)
    low, high = min(up, along), max(up, along)
    if not high > 0:  # pragma: no cover - the same
        return 0.0
    ratio = low / high
    eighth = int(ratio * 8 + 0.5)
    t = (ratio - eighth / 8) / (1 + ratio * (eighth / 8))
    q = t * t
    series = 1 / 13
    for n in (11, 9, 7, 5, 3):
        series = 1 / n - q * series
    angle = EIGHTHS[eighth] + t * (1 - q * series)
    if up > along:
        angle = 3.141592653589793 / 2 - angle
    if x < 0:
        angle = 3.141592653589793 - angle
    return -angle if y < 0 else angle


def arc_sine(sine: float) -> float:
    """Give the angle of a sine, cut to 1, in radians."""
    cut = 1.0 if sine > 1 else -1.0 if sine < -1 else sine
    return arc_tangent(cut, math.sqrt((1 - cut) * (1 + cut)))


def dot(a: Vector, b: Vector) -> float:
    """Give a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Give a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def added(a: Vector, times: float, b: Vector) -> Vector:
    """Give a + times b."""
    return (a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2])


def scaled(a: Vector, by: float) -> Vector:
    """Give a times a number."""
    return (a[0] * by, a[1] * by, a[2] * by)


def combined(columns: tuple[Vector, Vector, Vector], a: Vector) -> Vector:
    """Give the product of a matrix, told by its columns, and a vector."""
    x, y, z = columns
    return added(added(scaled(x, a[0]), a[1], y), a[2], z)
