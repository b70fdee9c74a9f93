"""The encoder of ``near``: from a goal to steps and chunks."""

from math import inf, log, log2
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.contract import Chunk, Encoded
from mocapress.codecs.markers import kept_of
from mocapress.codecs.near.figure import figure_of, tree_of
from mocapress.codecs.near.goal import MEAN_OF_MOST, Goal, Measure
from mocapress.codecs.near.header import COARSE, STEPS_PER_OCTAVE, joints_of, pack_header
from mocapress.codecs.near.turning import Turning, is_known, known_turnings, nearest, turnings_of
from mocapress.errors import ParameterError, VerificationError
from mocapress.motion import Skeleton, Stream

_MOST_STEP = 4096
_SCALE_OF_MEAN = 2.5
"""Where the search for a mean begins; 5.5 at coarse ones."""
_TRIES = 7
_NEAR_ENOUGH = 0.01
_MOST_COARSER = 0.3
"""Logarithm of by how much a scale may grow where bounds have made errors smaller."""
_INNER, _NEXT, _OUTER = 1.05, 1.15, 1.5
"""Means of joints may be so many times that of all; of those without further joints the last, of
those that such a joint follows the one before."""
_WEIGHTS = {"upperneck": 2.0, "head": 1.5} | {
    side + joint: weight
    for side in "lr"
    for joint, weight in (("humerus", 1.6), ("radius", 1.4), ("foot", 1.7))
}
"""Of joints of the known figure, of which the means would otherwise be above that."""
_EVEN_ENOUGH = 1.02
_MOST_TRIES = 12
_FULL_ENOUGH, _AIM = 0.97, 0.985
"""Of a budget of bytes: what is near enough, and what is tried next."""
_HASTE = 2.0
_SAMPLE = 256
"""Frames by which channels are weighed."""
_COARSE = 4e-3
"""Of the figure's size: at coarser scales long spans are worth more than early predictions; for the
known figure, of which predictions are known at once, from the second start on."""
_STARTS = (1.6e-4, 2.2e-3)
"""Of the figure's size: scales from which the next of the learned starts is taken."""
_RATE, _COARSE_RATE = 0.12, 0.2
"""What a bit is worth, in squares of the scale; the latter from the third start on."""


def _size(chunk: Chunk) -> int:
    return len(chunk.payload)


class _Try(NamedTuple):
    """A scale and weights of points, and what came of them."""

    off: float
    """Logarithm of the mean error beside the goal."""
    excess: float
    """How many times its share the mean of the worst point is."""
    scale: float
    weights: NDArray[np.float64]

    @property
    def lack(self) -> float:
        """Give by how much it is not good enough; a mean that is off counts ten times."""
        return 10 * max(abs(self.off) - _NEAR_ENOUGH, 0) + max(self.excess - _EVEN_ENOUGH, 0)


class Encoder:
    """Codes a stream."""

    def __init__(
        self,
        goal: Goal,
        max_error: float,
        chunk: int,
        stream: Stream,
        skeleton: Skeleton | None,
        budget: float = inf,
    ) -> None:
        self.goal, self.chunk, self.budget = goal, chunk, budget
        self.values = np.ascontiguousarray(stream.values, dtype=np.float64)
        figure = figure_of(skeleton, stream.columns, self.values)
        self.measure = Measure(goal, figure, stream.columns)
        self.value_most = np.full(stream.channels, max_error)
        if figure and goal.in_space:  # what moves no joint counts as a part of the figure's size
            moving = [figure.moves(column) for column in figure.columns]
            self.value_most[~np.array(moving, bool)] = min(max_error, goal.most / goal.size)
        self.kept = np.zeros(self.values.shape, np.uint8)
        self.most = np.full(self.measure.points, goal.most)
        self.shares = self._shares(skeleton)
        self.parts = self._parts()
        self.weights = self.parts**-2
        self.joints = joints_of(stream.columns, skeleton)
        self.columns = stream.columns
        if figure and figure.markers and goal.in_space:
            self.joints = joints_of(figure.columns, tree_of(figure, self.values))
            self.kept = kept_of(figure.markers, self.values).astype(np.uint8)
        self.rate: float | None = None
        self.starts = goal.in_space
        turns = goal.in_space and max_error == inf
        known = turns and self.parts.min(initial=1) >= 1  # its steps are too coarse for closer ones
        self.turn(known=known and is_known(self.measure, stream.columns, self.values), orders=turns)
        if self.known and skeleton is not None:
            usual = [_WEIGHTS.get(joint.name, 1.0) for joint in skeleton.joints]
            self._weigh(self.weights * np.array(usual))

    def turn(self, *, known: bool, orders: bool) -> None:
        """Let curves turn as the known figure's do, or, by `orders`, as is best for each joint."""
        self.known = known
        self.turnings: list[Turning] = []
        if known:
            self.turnings = nearest(self.measure, self.values, known_turnings())
        elif orders:
            scale = self.goal.mean * _SCALE_OF_MEAN
            self.turnings = turnings_of(self.measure, self.columns, self.values, scale)
        self.curves = _core.near_turned_measure(self.measure.core, self.turnings)
        self.exponents = self._levers()

    def encode(self) -> Encoded:
        """Give header and chunks; every bound was checked on what they decode to."""
        frames, channels = self.values.shape
        if not frames or not channels:
            return Encoded(self._header(1.0, (0.0, 0.0)), self._empty())
        scale = self._scale() if self.budget == inf else self._scale_of_budget()
        scale, payloads, errors = self._bounded(scale)
        largest = errors.max(axis=0, initial=0.0)
        for most, found in zip(self.most, largest, strict=True):
            if found > most:
                raise VerificationError(
                    "codec near breaks its bound; please report this",
                    expected=f"errors up to {most:g}",
                    found=f"{found:g}",
                )
        header = self._header(scale, (float(errors.mean()), float(largest.max())))
        return Encoded(header, tuple(payloads))

    def _bounded(self, scale: float) -> tuple[float, list[Chunk], NDArray[np.float64]]:
        """Code within the bounds; give the scale, the chunks and their errors.

        Bounds may make the mean smaller than was asked for. Then a coarser scale may do.
        """
        chunks, errors = self._chunks(scale, self.most)
        off = self._off(errors)
        if self.budget < inf or not -inf < off < -_NEAR_ENOUGH:
            return scale, chunks, errors
        coarser = scale * float(np.exp(min(-off, _MOST_COARSER)))
        others, theirs = self._chunks(coarser, self.most)
        smaller = sum(map(_size, others)) < sum(map(_size, chunks))
        if smaller and self._off(theirs) <= _NEAR_ENOUGH:
            return coarser, others, theirs
        return scale, chunks, errors

    def _empty(self) -> tuple[Chunk, ...]:
        """Chunks of frames without channels."""
        return tuple(
            Chunk(
                first,
                min(self.chunk, len(self.values) - first),
                self._payload(first, 1.0, self.most)[0],
            )
            for first in range(0, len(self.values), self.chunk)
        )

    def _levers(self) -> NDArray[np.int64]:
        """Give what each channel's step is coarser than the scale, (C,) in 64ths of an octave."""
        if self.known:
            return np.array(_core.near_figure()[0], np.int64)
        frames = self.values[:: max(1, len(self.values) // _SAMPLE)]
        moderate = np.where(np.abs(frames) < 1e9, frames, 0.0)
        turned = _core.near_turned(self.measure.core, moderate, self.turnings)
        squares = _core.near_levers(self.curves, turned, self.weights)
        with np.errstate(divide="ignore"):
            levers = 0.5 * np.log2(squares)
        # A channel that moves nothing has the step of one that moves a little.
        known = np.isfinite(levers) & (squares > 1e-8)
        levers[~known] = levers[known].min(initial=0.0)
        exponents: NDArray[np.int64] = np.rint(-levers * STEPS_PER_OCTAVE / COARSE).astype(np.int64)
        return exponents * COARSE

    def _shares(self, skeleton: Skeleton | None) -> NDArray[np.float64]:
        """Give by how much the mean of each point may be above that of all, (P,)."""
        shares = np.full(self.measure.points, inf)
        if self.goal.in_space and skeleton is not None:
            inner = {joint.parent for joint in skeleton.joints}
            following = {j.parent for i, j in enumerate(skeleton.joints) if i not in inner}
            shares[: len(skeleton.joints)] = [
                _OUTER if j not in inner else _NEXT if j in following else _INNER
                for j in range(len(skeleton.joints))
            ]
        return shares

    def _parts(self) -> NDArray[np.float64]:
        """Give how many times the usual largest error each point may have, (P,)."""
        usual = self.goal.most if self.goal.most < inf else self.goal.mean / MEAN_OF_MOST
        parts = np.ones(self.measure.points)
        for joint, most in self.goal.of_joints:
            self.most[joint] = most
            parts[joint] = most / usual
        return parts

    def _weigh(self, weights: NDArray[np.float64]) -> None:
        self.weights = weights * ((self.parts**-2).mean() / weights.mean())
        self.exponents = self._levers()

    def _excess(self, errors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give how many times its share the mean of each point is, (P,)."""
        means = errors.mean(axis=0)
        excess: NDArray[np.float64] = means / (self.shares * max(means.mean(), 1e-300))
        return excess

    def _off(self, errors: NDArray[np.float64]) -> float:
        """Give the logarithm of the mean error beside the goal."""
        mean = float((errors if self.goal.is_mean_asked else errors / self.parts).mean())
        return log(mean / self.goal.mean) if mean > 0 else -inf

    def _steps(self, scale: float) -> list[int]:
        base = round(log2(scale) * STEPS_PER_OCTAVE)
        if self.known:
            return [base + int(each) for each in self.exponents]
        low = -_MOST_STEP + (base + _MOST_STEP) % COARSE
        high = _MOST_STEP - (_MOST_STEP - base) % COARSE
        return [int(each) for each in np.clip(base + self.exponents, low, high)]

    def _knot(self, scale: float) -> int:
        """Give the step of knots, in eighths."""
        return 6 if scale / self.goal.size < 2e-4 else 4

    def _start(self, scale: float) -> int:
        """Give the learned start that is nearest, from 1 on; 0 where the scale says nothing."""
        if not self.starts:
            return 0
        return 1 + sum(scale / self.goal.size >= each for each in _STARTS)

    def _is_coarse(self, scale: float) -> bool:
        return self.starts and scale / self.goal.size >= _STARTS[1]

    def _header(self, scale: float, errors: tuple[float, float]) -> bytes:
        steps = self._steps(scale)
        early = scale / self.goal.size < (_STARTS[0] if self.known else _COARSE)
        return pack_header(
            self.goal.in_space,
            early,
            errors,
            self._knot(scale),
            steps,
            self.joints,
            self.turnings,
            self.measure.uses_radians,
            self._start(scale),
            self.known,
        )

    def _payload(
        self, first: int, scale: float, most: NDArray[np.float64]
    ) -> tuple[bytes, NDArray[np.float64]]:
        payload, _, errors = _core.near_encode(
            self.measure.core,
            self.curves,
            self.values[first : first + self.chunk],
            self._header(scale, (0.0, 0.0)),
            scale,
            self.rate or (_COARSE_RATE if self._is_coarse(scale) else _RATE),
            self._is_coarse(scale),
            self.weights,
            most,
            self.value_most,
            self.kept[first : first + self.chunk],
            3,
        )
        return payload, errors

    def _chunks(
        self, scale: float, most: NDArray[np.float64]
    ) -> tuple[list[Chunk], NDArray[np.float64]]:
        chunks, errors = [], []
        for first in range(0, len(self.values), self.chunk):
            payload, found = self._payload(first, scale, most)
            chunks.append(Chunk(first, len(found), payload))
            errors.append(found)
        return chunks, np.concatenate(errors)

    def _scale_of_budget(self) -> float:
        """Find about the finest scale at which header and chunks take no more than the budget."""
        unbounded = np.full(self.measure.points, inf)
        scale, power = self.goal.mean * _SCALE_OF_MEAN, -0.7
        best: tuple[int, float] | None = None
        before: tuple[float, float] | None = None
        for _ in range(_MOST_TRIES):
            chunks, _ = self._chunks(scale, unbounded)
            header = len(self._header(scale, (scale, scale)))
            size = header + sum(map(_size, chunks))
            if size <= self.budget and (best is None or size > best[0]):
                best = size, scale
            if _FULL_ENOUGH * self.budget <= size <= self.budget:
                break
            if before and before[0] != scale and before[1] != size:
                found = log(size / before[1]) / log(scale / before[0])
                power = min(max(found, -1.5), -0.1)
            before = scale, size
            move = log(_AIM * self.budget / size) / power
            scale *= float(np.exp(min(max(move, -3.0), 3.0)))
        if best is None:
            raise ParameterError(
                "near:rate",
                expected="more",
                found=f"{self.budget:.0f} bytes for this clip, too few",
            )
        return best[1]

    def _scale(self) -> float:
        """Find the scale at which the mean error is the goal's."""
        scale, tried = self.goal.mean * _SCALE_OF_MEAN, list[_Try]()
        unbounded = np.full(self.measure.points, inf)
        for _ in range(_TRIES):
            errors = self._chunks(scale, unbounded)[1]
            off = self._off(errors)
            if off == -inf:
                return scale
            excess = self._excess(errors / self.parts)
            tried.append(_Try(off, float(excess.max()), scale, self.weights))
            if tried[-1].lack <= 0:
                break
            slope = 1.0
            if len(tried) > 1 and tried[-2].off != off:
                slope = log(scale / tried[-2].scale) / (off - tried[-2].off)
            self._weigh(self.weights * np.maximum(excess, 1.0) ** _HASTE)
            move = -off * min(max(slope, 0.4), 2.5)
            scale *= float(np.exp(min(max(move, -2.0), 2.0)))
        best = min(tried, key=lambda one: one.lack)
        self._weigh(best.weights)
        return best.scale
