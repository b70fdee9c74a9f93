"""Joints of ``near`` whose curves turn in another order than the file (docs/format/near.md)."""

import math
from dataclasses import dataclass

from exact_functions import atan2, sine_cosine
from records import CorruptError
from streams import Bit, Coded, symbol, tree

ORDERS = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))
PI = 3.141592653589793


@dataclass
class Turning:
    """A joint that turns otherwise."""

    first: int
    columns: tuple[int, int, int]
    axes: tuple[int, int, int]
    curves: tuple[int, int, int]
    nearest_to_zero: bool


def take_turnings(stream: Coded, joints: list[int]) -> list[Turning]:
    """Take which joints turn otherwise."""
    turned, nearest = [Bit(), Bit()], Bit()
    trees = [tree(3) for _ in range(3)]
    last, found = False, list[Turning]()
    for column, joint in enumerate(joints):
        is_last = column + 1 == len(joints) or joints[column + 1] != joint
        if not is_last or column < 2 or joints[column - 2] != joint:
            continue
        last = stream.bit(turned[int(last)])
        if last:
            orders = [symbol(stream, models) for models in trees]
            if max(orders) > 5:
                raise CorruptError("no order of three turns")
            columns, axes, curves = (ORDERS[order] for order in orders)
            found.append(Turning(column - 2, columns, axes, curves, stream.bit(nearest)))
    return found


def sign_of(axes: tuple[int, int, int]) -> float:
    """Tell whether axes follow each other as x, y, z do."""
    return 1.0 if (axes[0] + 1) % 3 == axes[1] else -1.0


def matrix_of(axes: tuple[int, int, int], angles: list[float]) -> list[list[float]]:
    """Give the product of three turns."""
    (sa, ca), (sb, cb), (sc, cc) = (sine_cosine(angle) for angle in angles)
    s, (p, q, r) = sign_of(axes), axes
    m = [[0.0] * 3 for _ in range(3)]
    u, v = sa * sb, ca * sb
    m[p][p], m[p][q], m[p][r] = cb * cc, -(s * (cb * sc)), s * sb
    m[q][p], m[q][q], m[q][r] = u * cc + s * (ca * sc), ca * cc - s * (u * sc), -(s * (sa * cb))
    m[r][p], m[r][q], m[r][r] = sa * sc - s * (v * cc), v * sc + s * (sa * cc), ca * cb
    return m


def angles_of(axes: tuple[int, int, int], m: list[list[float]]) -> list[float]:
    """Give the angles of a turn."""
    s, (p, q, r) = sign_of(axes), axes
    y, x = -(s * m[q][r]), m[r][r]
    h = math.sqrt(y * y + x * x)
    sine, cosine = (y / h, x / h) if h > 0 else (0.0, 1.0)
    third = s * (cosine * m[q][p]) + sine * m[r][p], cosine * m[q][q] + s * (sine * m[r][q])
    return [atan2(y, x), atan2(s * m[p][r], h), atan2(*third)]


def nearest_of(angles: list[float], last: list[float], turn: float) -> list[float]:
    """Give the way to write a turn that is nearest to another."""
    half = turn / 2
    ways = []
    for way in (angles, [angles[0] + half, half - angles[1], angles[2] + half]):
        near = [a + turn * math.floor((b - a) / turn + 0.5) for a, b in zip(way, last, strict=True)]
        away = 0.0
        for a, b in zip(near, last, strict=True):
            away += abs(a - b)
        ways.append((away, near))
    return ways[1][1] if ways[1][0] < ways[0][0] else ways[0][1]


def turn_back(
    turning: Turning, radians: bool, columns: list[list[float]], start: list[float]
) -> None:
    """Make the file's angles of the curves' in three columns."""
    into, out = (1.0, 1.0) if radians else (0.017453292519943295, 57.29577951308232)
    last = [start[c] for c in turning.columns]
    for f in range(len(columns[0])):
        curves = [column[f] * into for column in columns]
        angles = [a * out for a in angles_of(turning.axes, matrix_of(turning.curves, curves))]
        if not turning.nearest_to_zero:
            angles = last = nearest_of(angles, last, 2 * PI if radians else 360.0)
        for c, angle in zip(turning.columns, angles, strict=True):
            columns[c][f] = angle
