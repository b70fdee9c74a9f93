"""Signatures of clips: 64 bytes by which similar ones are found among many.

A signature is a projection of what a clip does in time (six DCT coefficients and the deviation of
each feature) and of how its features go together, in whatever order (the logarithm of their
covariance, with the mean). ``projection.npz`` holds the projection; how it was learned says
docs/search.md.
"""

from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from mocapress.search.features import SIZE, features
from mocapress.search.standard import StandardMotion

Array = NDArray[np.float64]
Signature = NDArray[np.int8]

VERSION = 1
"""Of signatures and records; those of different versions cannot be compared."""
BYTES = 64
_COEFFICIENTS = 6
_LEAST_DEVIATION = 1e-4
"""Added to variances, so that what is still does not count."""
_NOISE = 3e-3
"""Added to variances before the logarithm."""
_ORDER_FREE = 0.5
"""Weight of the order-free part."""


class Projection(NamedTuple):
    """What makes a signature of a description."""

    mean: Array
    """(R,): the description of the average clip."""
    matrix: Array
    """(R, 64)."""
    step: float
    """One unit of a signature."""


def signature(motion: StandardMotion) -> Signature:
    """Give the signature of a clip: (64,) int8."""
    made: Signature = np.round(projected(features(motion))).clip(-127, 127).astype(np.int8)
    return made


def projected(of: Array) -> Array:
    """Give a signature of features (F, 35) before it is rounded: (64,)."""
    made: Array = (description(of) - projection().mean) @ projection().matrix / projection().step
    return made


def description(of: Array) -> Array:
    """Describe features (F, 35) by numbers that do not depend on F: (911,)."""
    spectrum = dct(of, axis=0, norm="ortho")[:_COEFFICIENTS] / np.sqrt(len(of))
    in_time = np.zeros((_COEFFICIENTS, SIZE))
    in_time[: len(spectrum)] = spectrum
    deviation = np.sqrt(of.var(axis=0) + _LEAST_DEVIATION)
    mean = of.mean(axis=0)
    around = of - mean
    joined = np.ones((SIZE + 1, SIZE + 1))
    joined[:-1, :-1] = around.T @ around / len(of) + np.outer(mean, mean) + _NOISE * np.eye(SIZE)
    joined[:-1, -1] = joined[-1, :-1] = mean
    sizes, ways = np.linalg.eigh(joined)
    logarithm = (ways * np.log(np.maximum(sizes, 1e-8))) @ ways.T
    upper = np.triu_indices(SIZE + 1)
    # Elements beside the diagonal stand for two.
    twice = np.where(upper[0] == upper[1], 1.0, np.sqrt(2.0))
    order_free = _ORDER_FREE * logarithm[upper] * twice
    return np.concatenate([in_time.ravel(), deviation, order_free])


@cache
def projection() -> Projection:
    """Read the projection that is shipped."""
    with files("mocapress.search").joinpath("projection.npz").open("rb") as file:
        read = np.load(file, allow_pickle=False)
        return Projection(
            read["mean"].astype(np.float64), read["matrix"].astype(np.float64), float(read["step"])
        )
