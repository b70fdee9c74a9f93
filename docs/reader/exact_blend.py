"""From several predictions to one, and how far the number may lie from it."""

import math

from exact_arithmetic import natural_exp, natural_log
from exact_experts import Chain

FADINGS = (0.94, 0.985, 0.998)


class Blend:
    """One prediction from many; those from ``start`` to ``end`` make up the mean."""

    def __init__(self, count: int, start: int, end: int, memories: int) -> None:
        self.start, self.end = start, end
        self.chains = [Chain(count, fading, 1.0) for fading in FADINGS[:memories]]
        self.errors = [1.0] * memories

    def predict(self, predictions: list[float]) -> float:
        """Blend."""
        self.mean = 0.0
        for prediction in predictions[self.start : self.end]:
            self.mean += prediction
        self.mean /= self.end - self.start
        self.guesses = []
        weights = total = 0.0
        for chain, error in zip(self.chains, self.errors, strict=True):
            chain.begin()
            for i, prediction in enumerate(predictions[1:]):
                chain.see(i, prediction - self.mean)
            self.guesses.append(chain.predicted[-1])
            square = error * error + 1e-12
            weight = 1 / (square * square)
            weights += weight
            total += weight * self.guesses[-1]
        return self.mean + total / weights

    def learn(self, value: float, scale: float) -> None:
        """Learn what was to be predicted; ``scale`` is how far off it was to be expected."""
        for k, chain in enumerate(self.chains):
            error = (value - self.mean - self.guesses[k]) / scale
            self.errors[k] += 0.05 * (min(error * error, 25.0) - self.errors[k])
            near = min(max(error, -6.0), 6.0) * scale + self.guesses[k]
            chain.see(len(chain.values) - 1, near)
            chain.learn(1 / (scale * scale))


class Spread:
    """The scale of a channel's distribution."""

    def __init__(self) -> None:
        self.weights = [-0.1, 0.4, 0.2, 0.5, 0.15, 0.03]
        self.features = [0.0] * 6
        self.fast = self.middle = self.slow = self.last = 0.0
        self.seen = 0

    def expect(self, disagreement: float, floor: float, activity: float) -> float:
        """Give the scale of the next error."""
        if self.seen == 0:
            self.scale = 1000 * floor
            return self.scale
        middle = natural_log(self.middle + floor)
        self.features = [
            1.0,
            bounded(natural_log(self.fast + floor) - middle, 3),
            bounded(natural_log(self.slow + floor) - middle, 3),
            activity,
            bounded(natural_log(disagreement + floor) - middle, 3),
            self.last,
        ]
        total = middle
        for weight, feature in zip(self.weights, self.features, strict=True):
            total += weight * feature
        self.scale = max(natural_exp(bounded(total, 600)), 0.2 * floor)
        return self.scale

    def learn(self, error: float, activity: float) -> float:
        """Learn an error; give the activity behind it."""
        relative = error / self.scale
        square = relative * relative
        if self.seen > 0:
            slope = bounded(5 * square / (4 + square) - 1, 2)
            self.weights = [
                bounded(weight + 0.003 * slope * feature, 4)
                for weight, feature in zip(self.weights, self.features, strict=True)
            ]
            usual = natural_log(abs(relative) + 0.1) + 0.5
            self.last = min(max(usual, -2.0), 3.0)
            activity += 0.15 * (self.last - activity)
        self.seen += 1
        size = abs(error) if self.seen == 1 else min(abs(error), 20 * self.scale)
        rate = 1.0 / self.seen
        self.fast += max(0.4, rate) * (size - self.fast)
        self.middle += max(0.12, rate) * (size - self.middle)
        self.slow += max(0.03, rate) * (size - self.slow)
        return activity


def bounded(number: float, most: float) -> float:
    """Keep a number within bounds."""
    return most if number > most else number if number > -most else -most


class Turns:
    """Whole turns of a channel whose angles jump by 360 degrees."""

    def __init__(self, kind: int) -> None:
        self.lowest = -180.0 if kind == 1 else 0.0

    def left(self, predicted: float) -> float:
        """Give the turns by which a prediction has left the range."""
        return 360 * floor((predicted - self.lowest) / 360)

    @staticmethod
    def since(before: float, number: float) -> float:
        """Give the turns that bring a number closest to the angle before."""
        return 360 * floor((before - number) / 360 + 0.5)


def floor(turns: float) -> float:
    """Round down; too many turns are none."""
    return float(math.floor(turns)) if abs(turns) < 1e5 else 0.0
