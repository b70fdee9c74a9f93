"""The solver's laws of ``exact``: angles as closed functions of angles of the joints before."""

import math

from exact_arithmetic import (
    DEGREE,
    Vector,
    added,
    arc_sine,
    arc_tangent,
    combined,
    cross,
    dot,
    scaled,
    sine_cosine,
    sine_cosine_of_degrees,
)
from tables import numbers

SPINE, NECK, THUMB, OTHER_THUMB, _, SPINE_MIDDLE, NECK_MIDDLE = range(1, 8)
TERMS = 35
TWIST, MIDDLE = 22, 12

Frame = tuple[Vector, Vector, Vector]
X: Vector = (1.0, 0.0, 0.0)
UP: Vector = (0.0, 1.0, 0.0)
Z: Vector = (0.0, 0.0, 1.0)


def rotation(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Frame:
    """Give the columns of Rz Ry Rx, of sines and cosines."""
    (sx, cx), (sy, cy), (sz, cz) = x, y, z
    return (
        (cz * cy, sz * cy, -sy),
        (cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx),
        (cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx),
    )


def rotation_of(angles: list[float]) -> Frame:
    """Give the rotation of angles x, y, z in degrees."""
    x, y, z = (sine_cosine_of_degrees(angle) for angle in angles)
    return rotation(x, y, z)


def swung(start: Vector, end: Vector, a: Vector) -> Vector:
    """Turn ``a`` the shortest way from one unit vector to another."""
    axis, cosine = cross(start, end), dot(start, end)
    moved = added(scaled(a, cosine), 1, cross(axis, a))
    return added(moved, dot(axis, a) / max(1 + cosine, 1e-9), axis)


def twist(a: Frame, b: Frame) -> float:
    """Give the turn about y that is left of the way from a to b."""
    x = swung(a[1], b[1], a[0])
    return arc_tangent(dot(x, b[2]), dot(x, b[0]))


def terms(bends: Vector) -> list[float]:
    """Give 1, a, b, c, aa, ab, ..., cccc."""
    made, degree = [1.0], [[bends[0]], [bends[1]], [bends[2]]]
    for _ in range(4):
        made += degree[0] + degree[1] + degree[2]
        degree = [[term * bends[v] for group in degree[v:] for term in group] for v in range(3)]
    return made


def linear(table: list[float], bends: Vector) -> float:
    """Give a polynomial of degree 1."""
    return table[0] + table[1] * bends[0] + table[2] * bends[1] + table[3] * bends[2]


def power(factor: float, *times: float) -> float:
    """Multiply from left to right."""
    for other in times:
        factor *= other
    return factor


class Law:
    """A law of some kind, which remembers its branch."""

    def __init__(self, kind: int) -> None:
        self.kind = kind
        self.first = 0.0
        self.bends = (0.0, 0.0)
        if kind in (SPINE, NECK, SPINE_MIDDLE, NECK_MIDDLE):
            table = numbers("spine_1" if kind in (SPINE, SPINE_MIDDLE) else "neck_1")
            self.middle = table[-MIDDLE:]
            self.twist = table[-MIDDLE - TWIST : -MIDDLE]
            rest = table[: -MIDDLE - TWIST]
            self.branches = [
                (rest[i : i + TERMS], rest[i + TERMS : i + 2 * TERMS])
                for i in range(0, len(rest), 2 * TERMS)
            ]
            self.branch = self.branches[0]

    def begin(self, sources: list[float]) -> None:
        """Take the angles of the sources, in degrees."""
        if self.kind in (SPINE, NECK):
            self._begin_chain(sources)
        elif self.kind in (SPINE_MIDDLE, NECK_MIDDLE):
            self._begin_middle(sources)
        else:
            sine, cosine = sine_cosine_of_degrees(sources[0])
            n = (0.3, 0.5 * cosine + sine, cosine - 0.5 * sine)
            self.first = arc_sine(n[1] / math.sqrt(1.34)) / DEGREE
            away = 45 - arc_tangent(n[0], n[2]) / DEGREE
            self.turn = sources[1] + (away if self.kind == THUMB else -away)

    def target(self, target: int, known: list[float]) -> float:
        """Give a target in degrees; those before it are known."""
        if target == 0:
            return self.first
        if self.kind in (THUMB, OTHER_THUMB):
            return self.turn
        sine_y, cosine_y = sine_cosine_of_degrees(known[0])
        second = arc_sine(self.axis[2] / cosine_y) / DEGREE
        if target == 1:
            return second
        if not abs(second - known[1]) < 1e-3:
            self._choose_branch(known[1], cosine_y)
        sine_x, cosine_x = sine_cosine_of_degrees(known[1])
        turned = arc_tangent(self.axis[1], self.axis[0]) - arc_tangent(cosine_x, sine_y * sine_x)
        return turned / DEGREE

    def _begin_chain(self, sources: list[float]) -> None:
        first = rotation_of(sources[:3])
        local = rotation_of(sources[3:])
        x, y, z = (combined(first, axis) for axis in local)
        self.second, self.y1 = (x, y, z), first[1]
        self.axis, self.bends = self._last_axis(self.branch, self.bends)
        bends = (1 - dot(UP, self.y1), 1 - dot(UP, y), 1 - dot(self.y1, y))
        odd = (twist((X, UP, Z), first), twist(first, self.second), dot(UP, cross(self.y1, y)))
        turn = 0.0
        for i, factor in enumerate(odd):
            turn += factor * linear(self.twist[4 * i :], bends)
        cubic = iter(self.twist[12:])
        for i in range(4):
            for j in range(4 - i):
                turn += power(next(cubic), *[odd[0]] * i, *[odd[1]] * j, *[odd[2]] * (3 - i - j))
        x, z = swung(UP, self.axis, X), swung(UP, self.axis, Z)
        sine, cosine = sine_cosine(turn)
        self.first = arc_sine(-(cosine * x[2] - sine * z[2])) / DEGREE

    def _begin_middle(self, sources: list[float]) -> None:
        first = rotation_of(sources[:3])
        turn = twist((X, UP, Z), first)
        bend = 1 - dot(UP, first[1])
        x, z = (sine_cosine_of_degrees(angle) for angle in sources[3:])
        off = moved = 0.0
        for step in range(8):
            local = rotation(x, sine_cosine_of_degrees(self.first), z)
            y2 = combined(first, local[1])
            bends = (bend, 1 - dot(UP, y2), 1 - dot(first[1], y2))
            plane = dot(UP, cross(first[1], y2))
            told = turn * linear(self.middle, bends) + plane * linear(self.middle[4:], bends)
            for i in range(4):
                told += power(self.middle[8 + i], *[turn] * i, *[plane] * (3 - i))
            last, off = off, (told - twist((X, UP, Z), local)) / DEGREE
            slope = -1.0 if step == 0 else (off - last) / moved
            moved = -off / slope if slope < -0.1 else off
            self.first = min(max(self.first + moved, -90.0), 90.0)
            if not abs(moved) > 1e-4:
                break

    def _last_axis(
        self, branch: tuple[list[float], list[float]], bends: tuple[float, float]
    ) -> tuple[Vector, tuple[float, float]]:
        """Give the last joint's y axis as the second sees it, and its bends."""
        bend, y2 = 1 - dot(UP, self.y1), self.second[1]
        y3 = y2
        if not (bends[0] >= 0 and bends[1] >= 0):  # pragma: no cover - rounding alone gets here
            bends = (1 - dot(UP, y2), 1 - dot(self.y1, y2))
        for _ in range(12):
            near = root = 0.0
            for term, g, h in zip(terms((bend, *bends)), *branch, strict=True):
                near += g * term
                root += h * term
            rest = added(self.y1, root, UP)
            along = dot(y2, rest)
            square = along * along - dot(rest, rest) + near * near
            y3 = added(scaled(y2, along + math.sqrt(max(square, 0.0))), -1, rest)
            length = max(math.sqrt(dot(y3, y3)), 1e-30)
            y3 = (y3[0] / length, y3[1] / length, y3[2] / length)
            found = (1 - dot(UP, y3), 1 - dot(self.y1, y3))
            moved = max(abs(found[0] - bends[0]), abs(found[1] - bends[1]))
            bends = found
            if moved < 1e-8:
                break
        x, y, z = self.second
        return (dot(x, y3), dot(y, y3), dot(z, y3)), bends

    def _choose_branch(self, seen: float, cosine_y: float) -> None:
        nearest, start = 1e300, self.bends
        for branch in self.branches:
            axis, bends = self._last_axis(branch, start)
            off = abs(arc_sine(axis[2] / cosine_y) / DEGREE - seen)
            if off < nearest:
                nearest = off
                self.branch, self.axis, self.bends = branch, axis, bends


class Joint:
    """One angle of a joint from its others, where the joint has fewer degrees of freedom."""

    def __init__(self, sources: int, parameters: list[int]) -> None:
        self.sources = sources
        code, bits, *multiples = parameters
        ones, shape = divmod(code, 243)
        found = [multiple / 2**bits for multiple in multiples]
        found.insert(ones % 3, 1.0)
        found.insert(3 + ones // 3, 1.0)
        self.u, self.v, self.c = found[:3], found[3:6], found[6]
        self.axes = (shape % 3, shape // 3 % 3, shape // 9 % 3)
        source, self.target = divmod(shape // 27, 3)
        self.places = (source, 3 - self.target - source)
        (u, v, w), (x, y, z) = self.u, self.v
        self.length = math.sqrt((u * u + v * v + w * w) * (x * x + y * y + z * z))

    def angles(self, sources: list[float], unknown: float) -> tuple[float, float, float]:
        """Give what the target may be, and how loose it is."""
        known = [0.0] * 3
        for place, angle in zip(self.places[: self.sources], sources, strict=True):
            known[place] = angle
        left, right = list(self.u), list(self.v)
        for i in range(self.target):
            turn_vector(left, self.axes[i], -known[i])
        for i in range(2, self.target, -1):
            turn_vector(right, self.axes[i], known[i])
        x = self.axes[self.target]
        y, z = (x + 1) % 3, (x + 2) % 3
        a = left[y] * right[y] + left[z] * right[z]
        b = left[z] * right[y] - left[y] * right[z]
        size = math.sqrt(a * a + b * b)
        if not size > 1e-12:
            return unknown, unknown, 1000.0
        cosine = min(max((self.c - left[x] * right[x]) / size, -1.0), 1.0)
        sine = math.sqrt((1 - cosine) * (1 + cosine))
        middle, away = arc_tangent(b, a) / DEGREE, arc_tangent(sine, cosine) / DEGREE
        loose = self.length / max(size * sine, self.length / 1000)
        return middle - away, middle + away, loose


def turn_vector(vector: list[float], axis: int, degrees: float) -> None:
    """Turn a vector about an axis."""
    sine, cosine = sine_cosine_of_degrees(degrees)
    y, z = vector[(axis + 1) % 3], vector[(axis + 2) % 3]
    vector[(axis + 1) % 3] = y * cosine - z * sine
    vector[(axis + 2) % 3] = y * sine + z * cosine
