"""Arrays of unit quaternions, scalar first: (..., 4), and their logarithms, (..., 3).

A unit quaternion ``[cos t/2; n sin t/2]`` turns by t about n; -q is the same turn. Its logarithm is
the vector ``n t/2``, at most half a straight angle long for the shorter way round.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def product(a: Array, b: Array) -> Array:
    """Multiply, (..., 4) by (..., 4): the turn b, and then a."""
    aw, ax, ay, az = np.moveaxis(a, -1, 0)
    bw, bx, by, bz = np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def conjugate(q: Array) -> Array:
    """Give the inverses of unit quaternions."""
    inverse: Array = q * np.array([1.0, -1.0, -1.0, -1.0])
    return inverse


def logarithm(q: Array) -> Array:
    """Give the half angle of each turn times its axis, (..., 3), radians.

    Of q and -q, which are the same turn, the shorter way round is taken: at most pi/2 long.
    """
    shorter = np.where(q[..., :1] < 0, -q, q)
    imaginary = shorter[..., 1:]
    sine = np.linalg.norm(imaginary, axis=-1, keepdims=True)
    angle = np.arctan2(sine, shorter[..., :1])
    return np.where(sine > 0, angle / np.where(sine > 0, sine, 1), 1.0) * imaginary


def exponential(vectors: Array) -> Array:
    """Give the unit quaternions of logarithms, (..., 3) to (..., 4)."""
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle), np.sinc(angle / np.pi) * vectors], axis=-1)


def power(q: Array, exponents: Array | float) -> Array:
    """Give q to the power t: the same axis, t times the angle.

    Parameters
    ----------
    q
        (..., 4).
    exponents
        One number, or an array of q's shape without its last axis.

    """
    return exponential(np.asarray(exponents, dtype=np.float64)[..., None] * logarithm(q))


def turned_degrees(a: Array, b: Array) -> Array:
    """Give the angle of the turn from a to b, (...), 0 to 180 degrees; the same for -a and -b."""
    between = product(conjugate(a), b)
    sine = np.linalg.norm(between[..., 1:], axis=-1)
    degrees: Array = np.degrees(2 * np.arctan2(sine, np.abs(between[..., 0])))
    return degrees
