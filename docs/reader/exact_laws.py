"""Laws and joints of ``exact`` (docs/format/exact_functions.md)."""

import math
from collections.abc import Callable, Sequence
from functools import partial

from exact_functions import (
    DEGREE,
    UNIT,
    Matrix,
    Vector,
    applied,
    asin,
    atan2,
    cross,
    cut,
    dot,
    plus,
    product,
    rotation,
    sine_cosine,
    times,
    total,
    turned,
)
from records import Record
from tables import numbers

UP = UNIT[1]
# Tells target 0 to 2 in degrees, from the sources and the targets before it; a joint twice.
Law = Callable[[int, list[float], list[float]], list[float]]


def make_law(kind: int) -> Law:
    """Make a law of a kind."""
    table = numbers("neck_1" if kind in (2, 7) else "spine_1")
    if kind in (3, 4):
        return partial(thumb, 1 if kind == 3 else -1)
    return Chain(table).tell if kind < 3 else Middle(table).tell


def swing(p: Vector, q: Vector, a: Vector) -> Vector:
    """Laws: swing."""
    k, z = cross(p, q), dot(p, q)
    return plus(times(a, z), cross(k, a), times(k, dot(k, a) / max(1 + z, 1e-9)))


def twist(a: Matrix, b: Matrix) -> float:
    """Laws: twist."""
    v = swing(a[1], b[1], a[0])
    return atan2(dot(v, b[2]), dot(v, b[0]))


def bends(p: Vector, q: Vector) -> Vector:
    """Laws: bends."""
    return (1 - dot(UP, p), 1 - dot(UP, q), 1 - dot(p, q))


def linear(t: Sequence[float], b: Vector) -> float:
    """Laws: linear."""
    return t[0] + t[1] * b[0] + t[2] * b[1] + t[3] * b[2]


def powered(number: float, *factors: tuple[float, int]) -> float:
    """Multiply a number by each factor, as many times as it says."""
    for factor, count in factors:
        for _ in range(count):
            number *= factor
    return number


def thumb(sign: int, target: int, sources: list[float], _known: list[float]) -> list[float]:
    """Laws: thumbs."""
    sine, cosine = sine_cosine(sources[0] * DEGREE)
    if target == 0:
        return [asin((0.5 * cosine + sine) / math.sqrt(1.34)) / DEGREE]
    return [sources[1] + sign * (45 - atan2(0.3, cosine - 0.5 * sine) / DEGREE)]


class Middle:
    """Laws: the middle of a chain."""

    def __init__(self, table: list[float]) -> None:
        self.t, self.y, self.slope = table[-12:], 0.0, -1.0

    def tell(self, _target: int, sources: list[float], _known: list[float]) -> list[float]:
        """Tell y."""
        first, t = rotation(*sources[:3]), self.t
        tau = twist(UNIT, first)
        before = moved = 0.0
        for i in range(8):
            own = rotation(sources[3], self.y, sources[4])
            y2 = applied(first, own[1])
            b, v = bends(first[1], y2), dot(UP, cross(first[1], y2))
            told = tau * linear(t, b) + v * linear(t[4:], b)
            for j in range(4):
                told += powered(t[8 + j], (tau, j), (v, 3 - j))
            off = (told - twist(UNIT, own)) / DEGREE
            if i > 0:
                self.slope = (off - before) / moved
            before, moved = off, -off / self.slope if self.slope < -0.1 else off
            self.y = cut(self.y + moved, -90.0, 90.0)
            if not abs(moved) > 1e-3:
                break
        return [self.y]


class Chain:
    """Laws: chains."""

    def __init__(self, table: list[float]) -> None:
        self.branches = [table[i : i + 70] for i in range(0, len(table) - 34, 70)]
        self.t = table[-34:-12]
        self.branch, self.beta, self.told_x = 0, (0.0, 0.0), 0.0
        self.axis: Vector = UP

    def tell(self, target: int, sources: list[float], known: list[float]) -> list[float]:
        """Tell y, x, z."""
        if target == 0:
            return [self._y(rotation(*sources[:3]), rotation(*sources[3:]))]
        sine_y, cosine_y = sine_cosine(known[0] * DEGREE)
        if target == 1:
            self.told_x = asin(self.axis[2] / cosine_y) / DEGREE
            return [self.told_x]
        x = known[1]
        if not abs(self.told_x - x) < 1e-3:
            found = [self._last_axis(branch) for branch in range(len(self.branches))]
            far = [abs(asin(axis[2] / cosine_y) / DEGREE - x) for axis, _ in found]
            self.branch = far.index(min(far))
            self.axis, self.beta = found[self.branch]
        sine_x, cosine_x = sine_cosine(x * DEGREE)
        z = atan2(self.axis[1], self.axis[0]) - atan2(cosine_x, sine_y * sine_x)
        return [z / DEGREE]

    def _y(self, first: Matrix, own: Matrix) -> float:
        self.second = product(first, own)
        self.y1, self.y2 = first[1], self.second[1]
        self.axis, self.beta = self._last_axis(self.branch)
        b, t = bends(self.y1, self.y2), self.t
        d = twist(UNIT, first), twist(first, self.second), dot(UP, cross(self.y1, self.y2))
        tau = d[0] * linear(t, b) + d[1] * linear(t[4:], b) + d[2] * linear(t[8:], b)
        powers = [(i, j, 3 - i - j) for i in range(4) for j in range(4 - i)]
        for number, counts in zip(t[12:], powers, strict=True):
            tau += powered(number, *zip(d, counts, strict=True))
        v, w = (swing(UP, self.axis, a)[2] for a in (UNIT[0], UNIT[2]))
        sine, cosine = sine_cosine(tau)
        return asin(-(cosine * v - sine * w)) / DEGREE

    def _last_axis(self, branch: int) -> tuple[Vector, tuple[float, float]]:
        y1, y2 = self.y1, self.y2
        beta = self.beta if min(self.beta) >= 0 else (1 - dot(UP, y2), 1 - dot(y1, y2))
        for _ in range(12):
            terms = polynomial_terms(1 - dot(UP, y1), *beta)
            told = iter(self.branches[branch])
            g, h = (by_fours([next(told) * term for term in terms]) for _ in range(2))
            w = plus(y1, times(UP, h))
            along = dot(y2, w)
            q = along * along - dot(w, w) + g * g
            v = plus(times(y2, along + math.sqrt(max(q, 0.0))), times(w, -1.0))
            length = max(math.sqrt(dot(v, v)), 1e-30)
            y3 = tuple(component / length for component in v)
            old, beta = beta, (1 - dot(UP, y3), 1 - dot(y1, y3))
            if max(abs(beta[0] - old[0]), abs(beta[1] - old[1])) < 1e-6:
                break
        return tuple(dot(column, y3) for column in self.second), beta


def by_fours(terms: list[float]) -> float:
    """Last axis: a sum of four sums."""
    sums = [total(terms[k::4]) for k in range(4)]
    return (sums[0] + sums[1]) + (sums[2] + sums[3])


def polynomial_terms(*variables: float) -> list[float]:
    """Last axis: the 35 terms."""
    degree = [(1.0, 2)]  # and which variable was the last factor
    terms = [1.0]
    for _ in range(4):
        degree = [
            (term * variable, i)
            for i, variable in enumerate(variables)
            for term, last in degree
            if last >= i
        ]
        terms += [term for term, _ in degree]
    return terms


class Joint:
    """Joints: of three turns, one or two tell another one."""

    def __init__(self, record: Record) -> None:
        """Take the parameters from the header."""
        rest, given = divmod(record.integer(), 32)
        rest, quarter_bits = divmod(rest, 11)
        shape, second = divmod(rest, 2)
        unit = 2.0 ** (-4 * quarter_bits)
        told = [record.signed() * unit if given >> i & 1 else 0.0 for i in range(5)]
        *self.axes, self.target, source, one_of_u, one_of_v = (shape // 3**i % 3 for i in range(7))
        self.sources = [source, 3 - source - self.target][: 1 + second]
        u, v, self.c = told[:2], told[2:4], told[4]
        u.insert(one_of_u, 1.0)
        v.insert(one_of_v, 1.0)
        self.u, self.v, self.loose = tuple(u), tuple(v), 1.0

    def tell(self, _target: int, sources: list[float], _known: list[float]) -> list[float]:
        """Tell both solutions, if there are any; ``loose`` is how loose they are."""
        turns = dict(zip(self.sources, sources, strict=True))
        a, b, axis = self.u, self.v, self.axes[self.target]
        for turn in range(self.target):
            a = turned(a, self.axes[turn], *sine_cosine(-turns.get(turn, 0.0) * DEGREE))
        for turn in range(2, self.target, -1):
            b = turned(b, self.axes[turn], *sine_cosine(turns.get(turn, 0.0) * DEGREE))
        j, k = (axis + 1) % 3, (axis + 2) % 3
        x, y = a[j] * b[j] + a[k] * b[k], a[k] * b[j] - a[j] * b[k]
        s = math.sqrt(x * x + y * y)
        if not s > 1e-12:
            self.loose = 1001.0
            return []
        z = cut((self.c - a[axis] * b[axis]) / s, -1.0, 1.0)
        r = math.sqrt((1 - z) * (1 + z))
        middle, away = atan2(y, x) / DEGREE, atan2(r, z) / DEGREE
        length = math.sqrt(dot(self.u, self.u) * dot(self.v, self.v))
        self.loose = 1 + length / max(s * r, length / 1000)
        return [middle - away, middle + away]
