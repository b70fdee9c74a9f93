"""Columns of rounding noise around zero: multiples of a power of two, in radians."""

from lines import DEGREES, Line, of_bits64
from records import CorruptError
from streams import Bit, Coded, Intervals, magnitude, symbol, tree
from tables import whole_numbers

ZERO, OTHER = 62, 63


class Noise:
    """A column of noise; ``start`` is what was learned from other clips."""

    def __init__(self, line: Line, start: list[float]) -> None:
        self.line = line
        first = whole_numbers("start_1")
        self.kinds, self.lengths = tree(6, first[64:128]), tree(6, first[128:192])
        models: list[Bit] = [*self.kinds, *self.lengths]
        if len(start) == 2 * len(models):
            for model, fast, slow in zip(models, start[::2], start[1::2], strict=True):
                model.fast, model.slow = (int(min(max(n, 15.0), 65520.0)) for n in (fast, slow))

    def next(self, stream: Coded | Intervals) -> float:
        """Take the next number."""
        kind = symbol(stream, self.kinds)
        if kind == OTHER:
            return of_bits64(stream.raw(64))
        sign = -1.0 if stream.raw(1) else 1.0
        if kind == ZERO:
            return sign * 0.0
        length = symbol(stream, self.lengths) + kind - 40
        if not 0 <= length <= 20:
            raise CorruptError("a noise of impossible length")
        radians = float(2 * magnitude(stream, length) + 1) * 2.0 ** (-46 - kind)
        return sign * self.line.number(self.line.near(radians * DEGREES))
