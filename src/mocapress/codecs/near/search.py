"""The search for a scale and for weights of joints at which errors are what was asked for."""

from dataclasses import dataclass
from math import exp, inf, log

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.contract import Chunk, Encoded
from mocapress.codecs.near.encoding import SCALE_OF_MEAN, Encoder
from mocapress.errors import ParameterError

EFFORTS = (1, 2, 3)
_LOOSE = 4
"""So many scales are tried without bounds at most, before they are tried with them."""
_READY = 0.04
"""Logarithm of by how much a mean may be off for bounds to be tried."""
_BOUNDED, _CLOSELY_BOUNDED, _LONG = 3, 2, 10
"""How often bounds are tried: usually, where they are close, and at the last effort."""
_CLOSE = 3.5
"""Bounds below so many times the mean are close: spans have to be coded again and again."""
_NEAR_ENOUGH = 0.01
_HASTE = 1.6
_DEAR = 0.3
"""What the worst joint's excess counts beside the bytes, both as logarithms."""
_WINDOW = 512
"""Frames of the middle of a clip in which the first effort searches."""
_ALIKE = 0.15
"""Logarithm of by how much the mean of the whole clip may then be off."""
_MOST_TRIES = 12
_FULL_ENOUGH, _AIM = 0.97, 0.985
"""Of a budget of bytes: what is near enough, and what is tried next."""


@dataclass(frozen=True, slots=True)
class Coded:
    """What came of a scale."""

    scale: float
    weights: NDArray[np.float64]
    """Of the points."""
    exponents: NDArray[np.int64]
    """Of the channels' steps, which follow from the weights."""
    chunks: list[Chunk]
    errors: NDArray[np.float64]
    off: float
    """Logarithm of the mean error beside the goal."""
    excess: NDArray[np.float64]
    """How many times its share the mean of each point is."""
    bounded: bool

    @property
    def size(self) -> int:
        """Give the bytes of the chunks."""
        return sum(len(chunk.payload) for chunk in self.chunks)

    def cost(self) -> tuple[bool, float]:
        """Give by what ways to code a clip are compared: the smallest is best."""
        too_large = self.off > _NEAR_ENOUGH
        excess = log(max(float(self.excess.max()), 1.0))
        return too_large, self.off if too_large else log(self.size) + _DEAR * excess


def encode(encoder: Encoder, effort: int) -> Encoded:
    """Code a clip as its goal asks; effort 1 is the quickest, 3 takes the most time.

    Raises
    ------
    ParameterError
        When a budget of bytes is too small.
    VerificationError
        When what was decoded breaks a bound.

    """
    if not encoder.values.size:
        return encoder.nothing()
    found = _searched(encoder, effort)
    encoder.weights, encoder.exponents = found.weights, found.exponents
    return encoder.encoded(found.scale, found.chunks, found.errors)


def _searched(encoder: Encoder, effort: int) -> Coded:
    if encoder.budget < inf:
        return _at(encoder, _scale_of_budget(encoder), bounded=True)
    if effort == 1:
        return _at(encoder, _quickly(encoder), bounded=True)
    close = encoder.goal.most < _CLOSE * encoder.goal.mean
    count = _LONG if effort > 2 else _CLOSELY_BOUNDED if close else _BOUNDED
    found: list[Coded] = []
    scale = encoder.goal.mean * SCALE_OF_MEAN
    while True:
        ready = len(found) >= _LOOSE or bool(found and abs(found[-1].off) < _READY)
        found.append(_at(encoder, scale, bounded=ready))
        if found[-1].off == -inf:
            return found[-1] if ready else _at(encoder, scale, bounded=True)
        bounded = [each for each in found if each.bounded]
        if len(bounded) == count:
            return min(bounded, key=Coded.cost)
        scale = _next(encoder, found)


def _at(encoder: Encoder, scale: float, *, bounded: bool, window: slice | None = None) -> Coded:
    most = encoder.most if bounded else np.full(encoder.measure.points, inf)
    chunks, errors = encoder.chunks(scale, most, window)
    off, excess = encoder.off(errors), encoder.excess(errors)
    return Coded(scale, encoder.weights, encoder.exponents, chunks, errors, off, excess, bounded)


def _next(encoder: Encoder, found: list[Coded]) -> float:
    """Give the next scale, and weigh joints anew."""
    last = found[-1]
    slope = 1.0
    if len(found) > 1 and found[-2].off != last.off:
        slope = log(last.scale / found[-2].scale) / (last.off - found[-2].off)
    encoder.weigh(encoder.weights * np.maximum(last.excess, 1.0) ** _HASTE)
    move = -last.off * min(max(slope, 0.4), 2.5)
    return last.scale * exp(min(max(move, -2.0), 2.0))


def _quickly(encoder: Encoder) -> float:
    """Find about the scale at which the mean error is the goal's.

    That of the middle of the clip, if it does for the whole; where that is unlike, of the whole.
    """
    first = max(0, (len(encoder.values) - _WINDOW) // 2)
    scale = encoder.goal.mean * SCALE_OF_MEAN
    for window, enough in ((slice(first, first + _WINDOW), _READY), (None, _ALIKE)):
        found: list[Coded] = []
        for _ in range(_LOOSE):
            found.append(_at(encoder, scale, bounded=False, window=window))
            if found[-1].off == -inf or (window is None and abs(found[-1].off) < enough):
                break
            scale = _next(encoder, found)
            if abs(found[-1].off) < enough:
                break
    return scale


def _scale_of_budget(encoder: Encoder) -> float:
    """Find about the finest scale at which header and chunks take no more than the budget."""
    scale, power = encoder.goal.mean * SCALE_OF_MEAN, -0.7
    best: tuple[int, float] | None = None
    before: tuple[float, float] | None = None
    for _ in range(_MOST_TRIES):
        header = len(encoder.header(scale, (scale, scale)))
        size = header + _at(encoder, scale, bounded=False).size
        if size <= encoder.budget and (best is None or size > best[0]):
            best = size, scale
        if _FULL_ENOUGH * encoder.budget <= size <= encoder.budget:
            break
        if before and before[0] != scale and before[1] != size:
            found = log(size / before[1]) / log(scale / before[0])
            power = min(max(found, -1.5), -0.1)
        before = scale, size
        move = log(_AIM * encoder.budget / size) / power
        scale *= exp(min(max(move, -3.0), 3.0))
    if best is None:
        raise ParameterError(
            "near:rate",
            expected="more",
            found=f"{encoder.budget:.0f} bytes for this clip, too few",
        )
    return best[1]
