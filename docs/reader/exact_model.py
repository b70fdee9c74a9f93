"""Levels 3 to 9 of ``exact``: the model of a clip, or of 1024 of its columns."""

from typing import TYPE_CHECKING

from exact_blend import Blend, Spread, Turns
from exact_experts import Frames, experts
from exact_lawful import Lawful
from exact_noise import Noise
from exact_residual import Residual
from exact_skeleton import Skeleton
from streams import Bit, Coded

if TYPE_CHECKING:
    from exact import Column, Coupling


class Channel:
    """A predicted column."""

    def __init__(self, column: "Column", law: Lawful | None, usual: int, memories: int) -> None:
        self.line, self.unit, self.law = column.line, column.unit, law
        self.sure = law is not None and law.joint is not None
        self.turns = Turns(column.turns) if column.turns else None
        self.across = [Bit() for _ in range(32)]
        count = usual + (3 if law else 0)
        first, end = (usual, usual + 1) if self.sure else (0, usual)
        self.blend = Blend(count, first, end, memories)
        self.spread = Spread()
        self.errors = [0.0] * 4
        """Of the law's predictions and the blend."""
        self._begin_with(column.start)

    def _begin_with(self, start: list[float]) -> None:
        chains = [len(chain.numbers()) for chain in self.blend.chains]
        if len(start) != 6 + sum(chains) + (4 if self.law else 0):
            return
        self.spread.weights = start[:6]
        at = 6
        for chain, size in zip(self.blend.chains, chains, strict=True):
            chain.take(start[at : at + size])
            at += size
        if self.law:
            self.errors = start[at:]


class Model:
    """What is known of the frames so far."""

    def __init__(
        self,
        stream: Coded,
        columns: list["Column"],
        couplings: list["Coupling"],
        level: int,
        shared: list[float],
    ) -> None:
        self.stream = stream
        self.noise = [Noise(column.line, column.start) for column in columns if column.noise]
        columns = [column for column in columns if not column.noise]
        self.experts = experts(columns, couplings, level)
        self.by_channel = [
            [expert for expert in self.experts if c in expert.targets] for c in range(len(columns))
        ]
        laws: dict[int, Lawful] = {}
        for coupling in couplings:
            if coupling.kind != 0:
                laws.update(dict.fromkeys(coupling.targets, Lawful(coupling, columns)))
        self.channels = [
            Channel(column, laws.get(c), len(self.by_channel[c]), 3 if level >= 8 else 1)
            for c, column in enumerate(columns)
        ]
        self.skeleton = None
        if level >= 8 and any(column.place is not None for column in columns):
            self.skeleton = Skeleton(columns)
        self.residual = Residual(stream, len(columns), shared)
        self.frames = Frames(len(columns))
        self.activity = 0.0
        self.first = True

    def next_frame(self) -> list[float]:
        """Take a row of numbers."""
        behind = [noise.next(self.stream) for noise in self.noise]
        self.frames.next()
        if self.first or self.stream.chance(65512):
            row = [self._next_first(c) for c in range(len(self.channels))]
            self.first = False
            return row + behind
        for expert in self.experts:
            expert.begin()
        if self.skeleton:
            self.skeleton.begin(self.frames)
        row = [self._next(c) for c in range(len(self.channels))]
        for expert in self.experts:
            expert.learn(self.frames)
        return row + behind

    def _next_first(self, c: int) -> float:
        number = self.residual.next_first(self.channels[c].line)
        for row in self.frames.rows:
            row[c] = self._level(c, number)
        return number

    def _next(self, c: int) -> float:
        channel, frames = self.channels[c], self.frames
        law, last = channel.law, frames.level(c, 1)
        if self.skeleton:
            frames.guesses[c] = self.skeleton.guess(c, frames)
        usual = [expert.predict(c, frames) - last for expert in self.by_channel[c]]
        lawful = law.predict(c, frames) if law else []
        blended = channel.blend.predict(usual + lawful)
        choices: list[float] = []
        if law and not channel.sure:
            choices = [*lawful, blended]
            blended = choices[channel.errors.index(min(channel.errors))]
        expected = bounded(last + blended) / channel.unit
        turned = channel.turns.left(expected) if channel.turns else 0.0
        step = channel.line.step(expected - turned) * channel.unit
        loose = law.looseness if law else 1.0
        if channel.sure:
            doubt = loose * step
        else:
            doubt = 0.0
            for prediction in usual:
                doubt += abs(prediction - blended)
            doubt /= len(usual)
        floor = (0.1 * step + 1e-9) / loose
        scale = loose * channel.spread.expect(doubt / loose, floor, self.activity)
        width = (scale + 0.15 * step) / channel.unit
        if channel.turns:
            turned = self._turned(channel, expected, turned, width)
        number = self.residual.next(c, channel.line, expected - turned, width)
        whole = number
        if channel.turns:
            whole = number + channel.turns.since(last / channel.unit, number)
        level = self._level(c, whole)
        error = level - last
        channel.blend.learn(error, scale + step)
        for i, choice in enumerate(choices):
            off = min(abs(error - choice), 20 * (scale + step))
            channel.errors[i] += 0.1 * (off - channel.errors[i])
        self.activity = channel.spread.learn((error - blended) / loose, self.activity)
        frames.rows[0][c] = level
        return number

    def _turned(self, channel: Channel, expected: float, turned: float, width: float) -> float:
        """Tell what to take from a prediction: the turns that it has left, but for the edges."""
        assert channel.turns
        within = expected - turned - channel.turns.lowest
        low = within < 180
        scales = (within if low else 360 - within) / width
        if not scales < 16:
            return turned
        if self.stream.bit(channel.across[int(2 * scales) if scales > 0 else 0]):
            return turned + (-360 if low else 360)
        return turned

    def _level(self, c: int, number: float) -> float:
        level = number * self.channels[c].unit
        return bounded(level) if level == level else 0.0


def bounded(level: float) -> float:
    """Keep a level within 10^6."""
    return level if -1e6 < level < 1e6 else 1e6 if level >= 1e6 else -1e6
