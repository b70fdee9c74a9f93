"""Elementary functions and vectors of ``exact`` (docs/format/exact_functions.md)."""

import math
from collections.abc import Iterable
from functools import reduce
from operator import add

from lines import bits64, of_bits64

Vector = tuple[float, ...]
"""Of three components."""
Matrix = tuple[Vector, ...]
"""Of three columns."""

DEGREE = 0.017453292519943295
PI = 3.141592653589793
QUARTER = 1.5707963267948966
LN2 = 0.6931471805599453
# The arcs whose tangents are 0, 1/8 ... 8/8.
ARCS = (
    *(0.0, 0.12435499454676144, 0.24497866312686414, 0.3587706702705722, 0.4636476090008061),
    *(0.5585993153435624, 0.6435011087932844, 0.7188299996216245, 0.7853981633974483),
)
UNIT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def cut(x: float, least: float, most: float) -> float:
    """Give ``x`` within bounds; NaN gives the lower one."""
    return most if x > most else x if x > least else least


def total(terms: Iterable[float]) -> float:
    """Add one by one from 0 on; ``sum`` corrects its rounding in later versions of Python."""
    return reduce(add, terms, 0.0)


def ln(x: float) -> float:
    """Elementary functions: the logarithm."""
    return ((bits64(x) >> 12) - (1023 << 40)) * (LN2 / 2**40)


def exp(x: float) -> float:
    """Elementary functions: the power of e."""
    return of_bits64(int(x * (2**52 / LN2) + 1023.0 * 2**52))


def sine_cosine(alpha: float) -> tuple[float, float]:
    """Elementary functions: sine and cosine."""
    alpha = alpha if abs(alpha) <= 1e6 else 0.0
    quarters = rounded_away(alpha * (1 / QUARTER))
    x = (alpha - quarters * QUARTER) - quarters * 6.123233995736766e-17
    y = x * x
    s = c = 1.0
    for n in (156, 110, 72, 42, 20, 6):
        s = 1 - (y * (1 / n)) * s
    for n in (182, 132, 90, 56, 30, 12, 2):
        c = 1 - (y * (1 / n)) * c
    s = x * s
    return ((s, c), (c, -s), (-s, -c), (-c, s))[quarters % 4]


def rounded_away(x: float) -> int:
    """Give the nearest whole number; of two, the one that is farther from 0."""
    return int(x - 0.5 if x < 0 else x + 0.5)


def atan2(y: float, x: float) -> float:
    """Elementary functions: the arc of a direction."""
    low, high = sorted((abs(y), abs(x)))
    r = low / high if high > 0 else 0.0
    k = int(r * 8 + 0.5)
    t = (r - k / 8) / (1 + r * (k / 8))
    w = t * t
    s = 1 / 13
    for n in (11, 9, 7, 5, 3):
        s = 1 / n - w * s
    angle = ARCS[k] + t * (1 - w * s)
    if abs(y) > abs(x):
        angle = PI / 2 - angle
    if x < 0:
        angle = PI - angle
    return -angle if y < 0 else angle


def asin(x: float) -> float:
    """Elementary functions: the arc of a sine."""
    c = cut(x, -1.0, 1.0)
    return atan2(c, math.sqrt((1 - c) * (1 + c)))


def dot(a: Vector, b: Vector) -> float:
    """Vectors: a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vectors: a × b."""
    return tuple(a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3))


def plus(*terms: Vector) -> Vector:
    """Add vectors, from left to right."""
    first, *others = terms
    for other in others:
        first = tuple(a + b for a, b in zip(first, other, strict=True))
    return first


def times(a: Vector, s: float) -> Vector:
    """Multiply a vector by a number."""
    return tuple(component * s for component in a)


def applied(m: Matrix, a: Vector) -> Vector:
    """Vectors: M a."""
    return plus(*map(times, m, a))


def product(m: Matrix, n: Matrix) -> Matrix:
    """Vectors: a product of matrices."""
    return tuple(applied(m, column) for column in n)


def transposed(m: Matrix) -> Matrix:
    """Make the rows columns."""
    return tuple(zip(*m, strict=True))


def turned(a: Vector, axis: int, sine: float, cosine: float) -> Vector:
    """Vectors: a turn about an axis."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    changed = {j: a[j] * cosine - a[k] * sine, k: a[j] * sine + a[k] * cosine}
    return tuple(changed.get(i, a[i]) for i in range(3))


def rotation(x: float, y: float, z: float) -> Matrix:
    """Vectors: R(x, y, z), the angles in degrees."""
    (sx, cx), (sy, cy), (sz, cz) = (sine_cosine(angle * DEGREE) for angle in (x, y, z))
    return (
        (cz * cy, sz * cy, -sy),
        (cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx),
        (cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx),
    )
