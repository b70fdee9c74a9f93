"""APP word by word: the paper's predictor and Algorithm 1, and the coder below them, unhurried.

Written from the paper and the description of the payload, one value at a time; the compiled codec
must make the same bytes.
"""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass
class Bit:
    """The chance of a 0 in 1/65536, learned at two rates."""

    fast: int = 1 << 15
    slow: int = 1 << 15

    def learn(self, one: int) -> None:
        self.fast += ((15 if one else 65520 + 16) - self.fast) >> 4
        self.slow += ((15 if one else 65520 + 128) - self.slow) >> 7


@dataclass
class Coder:
    """A range coder whose low end is one unbounded integer, and a list of raw bits."""

    low: int = 0
    words: int = 0
    range: int = (1 << 64) - 1
    raw_bits: list[int] = field(default_factory=list)

    def bit(self, model: Bit, one: int) -> None:
        bound = (self.range >> 16) * ((model.fast + model.slow) >> 1)
        model.learn(one)
        if one:
            self.low += bound
            self.range -= bound
        else:
            self.range = bound
        if self.range < 1 << 32:
            self.low <<= 32
            self.range <<= 32
            self.words += 1

    def tree(self, models: dict[int, Bit], bits: int, symbol: int) -> None:
        prefix = 1
        for i in reversed(range(bits)):
            one = symbol >> i & 1
            self.bit(models.setdefault(prefix, Bit()), one)
            prefix = prefix << 1 | one

    def raw(self, value: int, bits: int) -> None:
        self.raw_bits.extend(value >> i & 1 for i in range(bits))

    def finish(self) -> bytes:
        coded = b""
        for count in range(9):
            unit = 1 << (64 - 8 * count)
            number = -(-self.low // unit) * unit
            if number - self.low < self.range:
                size = 4 * self.words + count
                coded = (number // unit).to_bytes(size, "big")
                break
        size = len(coded)
        varint = []
        while size >= 0x80:
            varint.append(size & 0x7F | 0x80)
            size >>= 7
        bits = self.raw_bits + [0] * (-len(self.raw_bits) % 8)
        raw = (sum(bits[i + b] << b for b in range(8)) for i in range(0, len(bits), 8))
        return bytes([*varint, size]) + coded + bytes(raw)


@dataclass(frozen=True)
class Float:
    """A width of float: its bits of exponent and mantissa, and its codes for ``struct``."""

    exponent_bits: int
    mantissa_bits: int
    length_bits: int
    code: str
    integer: str

    def split(self, value: float) -> tuple[int, int, int]:
        """Step 1: sign, exponent, mantissa."""
        (bits,) = struct.unpack(self.integer, struct.pack(self.code, value))
        exponent = bits >> self.mantissa_bits & (1 << self.exponent_bits) - 1
        sign = bits >> (self.mantissa_bits + self.exponent_bits)
        return sign, exponent, bits & (1 << self.mantissa_bits) - 1

    def rounded(self, value: float) -> float:
        """Give the float of this width next to the value."""
        try:
            (number,) = struct.unpack(self.code, struct.pack(self.code, value))
        except OverflowError:
            return math.copysign(math.inf, value)
        return float(number)


SINGLE = Float(8, 23, 5, "<f", "<I")
DOUBLE = Float(11, 52, 6, "<d", "<Q")


@dataclass
class Algorithm1:
    """The corrections of one chunk; ``steps`` keeps which steps were executed for each value."""

    kind: Float
    limit: int
    coder: Coder
    is_moved: Bit = field(default_factory=Bit)
    expo_diff: dict[int, Bit] = field(default_factory=dict)
    escapes: dict[int, Bit] = field(default_factory=dict)
    mts: dict[int, dict[int, Bit]] = field(default_factory=dict)
    steps: list[str] = field(default_factory=list)

    def encode(self, m: float, p: float) -> None:
        sgn_a, exp_a, mts_a = self.kind.split(m)
        sgn_p, exp_p, mts_p = self.kind.split(p)
        if sgn_a == sgn_p and abs(exp_a - exp_p) < 4:
            step2 = "2"
            self.coder.bit(self.is_moved, int(exp_a != exp_p))
            if exp_a != exp_p:
                self.coder.tree(self.expo_diff, 3, exp_a - exp_p + 3)
        else:
            step2 = "3"
            self.coder.bit(self.is_moved, 1)
            self.coder.tree(self.expo_diff, 3, 7)
            self.coder.raw(sgn_a, 1)
            self.coder.raw(exp_a, self.kind.exponent_bits)
        step4 = "5"
        if sgn_a == sgn_p and exp_a == exp_p:
            difference = mts_a - mts_p
            bits = abs(difference).bit_length()
            if self.limit <= self.kind.mantissa_bits:
                escape = self.escapes.setdefault(exp_a, Bit())
                self.coder.bit(escape, int(bits >= self.limit))
            if bits < self.limit:
                step4 = "4"
                self.coder.tree(self.mts.setdefault(exp_a, {}), self.kind.length_bits, bits)
                if bits:
                    self.coder.raw(int(difference < 0), 1)
                    self.coder.raw(abs(difference) & (1 << bits - 1) - 1, bits - 1)
        if step4 == "5":
            self.coder.raw(mts_a, self.kind.mantissa_bits)
        self.steps.append("1" + step2 + step4)


def ideal_alpha(m: Sequence[Sequence[float]], c: int, p: int, rows: range) -> float:
    """Eq. 9, of the rows that have one before them."""
    product = square = 0.0
    for j in rows:
        if j > 0:
            product += (m[j][p] - m[j - 1][p]) * (m[j][c] - m[j - 1][c])
            square += (m[j][p] - m[j - 1][p]) * (m[j][p] - m[j - 1][p])
    alpha = product / square if square != 0 else 0.0
    return alpha if math.isfinite(alpha) else 0.0


def predicted(m: Sequence[Sequence[float]], j: int, c: int, p: int, alpha: float) -> float:
    """Eq. 6; 0 for the first row and for what is no number."""
    if j == 0:
        return 0.0
    if p < 0:
        return 0.0 if math.isnan(m[j - 1][c]) else m[j - 1][c]
    prediction = m[j - 1][c] + alpha * (m[j][p] - m[j - 1][p])
    return 0.0 if math.isnan(prediction) else prediction


def coding_order(parents: Sequence[int]) -> list[int]:
    """Give all columns, each after its parent, as early as that lets it come."""
    order: list[int] = []
    for column in range(len(parents)):
        line = [column]
        while parents[line[-1]] >= 0:
            line.append(parents[line[-1]])
        order.extend(c for c in reversed(line) if c not in order)
    return order


def payload(
    values: Sequence[Sequence[float]],
    parents: Sequence[int],
    singles: Sequence[bool],
    table: Sequence[float],
    t: int,
    mantissa_limit: int,
) -> bytes:
    """Code one chunk. ``singles`` says which columns are kept as float32."""
    n, columns = len(values), range(len(parents))
    kinds = [SINGLE if single else DOUBLE for single in singles]
    m = [[kinds[c].rounded(row[c]) for c in columns] for row in values]
    clusters = [range(b, min(b + t, n)) for b in range(0, n, t)]

    chosen: dict[tuple[int, int], int] = {}
    for c in columns:
        for i, rows in enumerate(clusters):
            alpha = ideal_alpha(m, c, parents[c], rows) if parents[c] >= 0 else 0.0
            chosen[c, i] = min(range(len(table)), key=lambda k: abs(table[k] - alpha))
    index = Coder()
    for c in columns:
        for i in range(len(clusters)):
            index.raw(chosen[c, i], len(table).bit_length() - 1)

    coder = Coder()
    algorithms = {kind: Algorithm1(kind, mantissa_limit, coder) for kind in (SINGLE, DOUBLE)}
    for c in coding_order(parents):
        for j in range(n):
            prediction = predicted(m, j, c, parents[c], table[chosen[c, j // t]])
            algorithms[kinds[c]].encode(m[j][c], kinds[c].rounded(prediction))
    return index.finish()[1:] + coder.finish()
