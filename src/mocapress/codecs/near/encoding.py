"""The encoder of ``near``: from a goal to steps and chunks."""

from dataclasses import replace
from math import inf, log, log2

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.contract import Chunk, Encoded
from mocapress.codecs.markers import kept_of
from mocapress.codecs.near.figure import figure_of, tree_of
from mocapress.codecs.near.goal import MEAN_OF_MOST, WITHIN, Goal, Measure
from mocapress.codecs.near.header import (
    COARSE,
    STEPS_PER_OCTAVE,
    joints_of,
    order_of,
    pack_header,
)
from mocapress.codecs.near.turning import Turning, is_known, known_turnings, nearest, turnings_of
from mocapress.errors import VerificationError
from mocapress.motion import Skeleton, Stream

_MOST_STEP = 3072
"""Steps are no finer and no coarser, as exponents: the base of the known figure has to be within
the bounds of the format, too."""
SCALE_OF_MEAN = 2.5
"""Where the search for a mean begins."""
_INNER, _NEXT, _OUTER = 1.04, 1.15, 1.5
"""Means of joints may be so many times that of all; of those without further joints the last, of
those that such a joint follows the one before."""
_SIDES = {"foot": 1.1, "wrist": 1.06, "hand": 1.27, "thumb": 1.36}
_SHARES = {"upperneck": 1.04, "head": 1.28} | {f"{s}{j}": _SIDES[j] for s in "lr" for j in _SIDES}
"""The same of joints of the known figure, of which ACL's means are smaller than that."""
_WEIGHTS = {"upperneck": 2.0, "head": 1.5} | {
    side + joint: weight
    for side in "lr"
    for joint, weight in (("humerus", 1.6), ("radius", 1.4), ("foot", 1.7))
}
"""Of joints of the known figure, of which the means would otherwise be above that; with these its
steps are its own."""
_SAMPLE = 256
"""Frames by which channels are weighed."""
_SHORT_SPANS, _KNOWN_SHORT_SPANS = 6.5e-4, 4e-4
"""Of the figure's size: at coarser means long blocks are worth more than new predictions; the
latter for the known figure, whose predictions begin with what was learned."""
_STARTS = (1.2e-4, 1.3e-3)
"""Of the figure's size: means from which the next of the learned starts is taken."""
_SCALE_OF_ANY_MEAN = 3.0
_RATE, _COARSE_RATE = 0.12, 0.2
"""What a bit is worth, in squares of the scale; the latter from the third start on."""


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
        self.order = order_of(stream.columns, skeleton)
        if self.order:
            columns = tuple(stream.columns[c] for c in self.order)
            stream = replace(stream, values=stream.values[:, self.order], columns=columns)
        self.values = np.ascontiguousarray(stream.values, dtype=np.float64)
        figure = figure_of(skeleton, stream.columns, self.values)
        self.measure = Measure(goal, figure, stream.columns)
        self.value_most = np.full(stream.channels, WITHIN * max_error)
        if figure and goal.in_space:  # what moves no joint counts as a part of the figure's size
            moving = [figure.moves(column) for column in figure.columns]
            apart = WITHIN * min(max_error, goal.most / goal.size)
            self.value_most[~np.array(moving, bool)] = apart
        self.kept = np.zeros(self.values.shape, np.uint8)
        self.most = WITHIN * goal.largest(self.measure.points)
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
        known = turns and is_known(self.measure, stream.columns, self.values)
        self.usual = np.ones(self.measure.points)
        if known and skeleton is not None:
            names = [joint.name for joint in skeleton.joints]
            self.shares = np.array(
                [_SHARES.get(*each) for each in zip(names, self.shares, strict=True)]
            )
            self.usual = np.array([_WEIGHTS.get(name, 1.0) for name in names])
            self.usual /= self.usual.mean()
            self.weights *= self.usual
        self.turn(known=known, orders=turns)

    def turn(self, *, known: bool, orders: bool) -> None:
        """Let curves turn as the known figure's do, or, by `orders`, as is best for each joint."""
        self.known = known
        self.turnings: list[Turning] = []
        if known:
            self.turnings = nearest(self.measure, self.values, known_turnings())
        elif orders:
            scale = self.goal.mean * SCALE_OF_MEAN
            self.turnings = turnings_of(self.measure, self.columns, self.values, scale)
        self.curves = _core.near_turned_measure(self.measure.core, self.turnings)
        frames = self.values[:: max(1, len(self.values) // _SAMPLE)]
        moderate = np.where(np.abs(frames) < 1e9, frames, 0.0)
        self.sample = _core.near_turned(self.measure.core, moderate, self.turnings)
        self.own_levers = self._levers(self.usual) if known else np.zeros(self.values.shape[1])
        self.exponents = self._exponents()

    def encoded(self, scale: float, chunks: list[Chunk], errors: NDArray[np.float64]) -> Encoded:
        """Give header and chunks; every bound is checked on what they decode to.

        Raises
        ------
        VerificationError
            When an error is larger than was asked for.

        """
        largest = errors.max(axis=0, initial=0.0)
        for most, found in zip(self.most, largest, strict=True):
            if found > most:
                raise VerificationError(
                    "codec near breaks its bound; please report this",
                    expected=f"errors up to {most:g}",
                    found=f"{found:g}",
                )
        header = self.header(scale, (float(errors.mean()), float(largest.max())))
        return Encoded(header, tuple(chunks))

    def nothing(self) -> Encoded:
        """Give header and chunks of frames without channels."""
        frames = len(self.values)
        chunks = []
        for first in range(0, frames, self.chunk):
            stop = min(first + self.chunk, frames)
            payload = self._payload(first, stop, 1.0, self.most)[0]
            chunks.append(Chunk(first, stop - first, payload))
        return Encoded(self.header(1.0, (0.0, 0.0)), tuple(chunks))

    def _levers(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give how far channels move points that count so much, (C,), as logarithms.

        NaN for a channel that moves nothing.
        """
        squares = _core.near_levers(self.curves, self.sample, weights)
        with np.errstate(divide="ignore"):
            levers: NDArray[np.float64] = 0.5 * np.log2(squares)
        levers[~(np.isfinite(levers) & (squares > 1e-8))] = np.nan
        return levers

    def _exponents(self) -> NDArray[np.int64]:
        """Give what each channel's step is coarser than the scale, (C,) in 64ths of an octave."""
        levers = self._levers(self.weights) - self.own_levers
        # A channel that moves nothing has the step of one that moves a little, or the figure's own.
        nothing = 0.0 if self.known else np.fmin.reduce(levers, initial=0.0)
        levers[np.isnan(levers)] = nothing
        exponents: NDArray[np.int64] = np.rint(-levers * STEPS_PER_OCTAVE / COARSE).astype(np.int64)
        exponents *= COARSE
        if self.known:
            exponents += np.array(_core.near_figure()[0])
        return exponents

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
            parts[joint] = most / usual
        return parts

    def weigh(self, weights: NDArray[np.float64]) -> None:
        """Let errors of points count by these weights, (P,), and steps follow them."""
        self.weights = weights * ((self.parts**-2).mean() / weights.mean())
        self.exponents = self._exponents()

    def excess(self, errors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give how many times its share the mean of each point is, (P,)."""
        means = errors.mean(axis=0)
        excess: NDArray[np.float64] = means / (self.shares * max(means.mean(), 1e-300))
        return excess

    def off(self, errors: NDArray[np.float64]) -> float:
        """Give the logarithm of the mean error beside the goal."""
        mean = float((errors if self.goal.is_mean_asked else errors / self.parts).mean())
        return log(mean / self.goal.mean) if mean > 0 else -inf

    def _steps(self, scale: float) -> list[int]:
        steps = round(log2(scale) * STEPS_PER_OCTAVE) + self.exponents
        beyond = np.maximum(np.abs(steps) - _MOST_STEP, 0)
        steps -= (np.sign(steps) * np.ceil(beyond / COARSE) * COARSE).astype(np.int64)
        return [int(each) for each in steps]

    def _part(self, scale: float) -> float:
        """Give the mean error as a part of the figure's size: the goal's, or about what it will be.

        What hangs on it does not change while a scale is searched for a mean.
        """
        mean = self.goal.mean if self.budget == inf else scale / _SCALE_OF_ANY_MEAN
        return mean / self.goal.size

    def _knot(self, scale: float) -> int:
        """Give the step of knots, in eighths."""
        return 6 if self._part(scale) < _STARTS[0] else 4

    def _start(self, scale: float) -> int:
        """Give the learned start that is nearest, from 1 on; 0 where the scale says nothing."""
        if not self.starts:
            return 0
        return 1 + sum(self._part(scale) >= each for each in _STARTS)

    def _is_coarse(self, scale: float) -> bool:
        return self.starts and self._part(scale) >= _STARTS[1]

    def header(self, scale: float, errors: tuple[float, float]) -> bytes:
        """Give the codec header for a scale and mean and largest error."""
        steps = self._steps(scale)
        coarsest = _KNOWN_SHORT_SPANS if self.known else _SHORT_SPANS
        short_spans = self._part(scale) < coarsest
        return pack_header(
            self.goal.in_space,
            short_spans,
            errors,
            self._knot(scale),
            steps,
            self.joints,
            self.turnings,
            self.measure.uses_radians,
            self._start(scale),
            self.known,
            self.order,
        )

    def _payload(
        self, first: int, stop: int, scale: float, most: NDArray[np.float64]
    ) -> tuple[bytes, NDArray[np.float64]]:
        payload, _, errors = _core.near_encode(
            self.measure.core,
            self.curves,
            self.values[first:stop],
            self.header(scale, (0.0, 0.0)),
            scale,
            self.rate or (_COARSE_RATE if self._is_coarse(scale) else _RATE),
            self._is_coarse(scale),
            self.weights,
            most,
            self.value_most,
            self.kept[first:stop],
            3,
        )
        return payload, errors

    def chunks(
        self, scale: float, most: NDArray[np.float64], window: slice | None = None
    ) -> tuple[list[Chunk], NDArray[np.float64]]:
        """Code at a scale, within these largest errors of points, (P,), all frames or a few.

        Gives the chunks, and the errors of what they decode to, (F, P).
        """
        chunks, errors = [], []
        first, stop, _ = (window or slice(None)).indices(len(self.values))
        for begin in range(first, stop, self.chunk):
            payload, found = self._payload(begin, min(begin + self.chunk, stop), scale, most)
            chunks.append(Chunk(begin, len(found), payload))
            errors.append(found)
        return chunks, np.concatenate(errors)
