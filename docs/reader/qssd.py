"""The codec ``qssd`` (docs/format/qssd.md)."""

from itertools import pairwise
from math import floor, sqrt
from typing import NamedTuple

from lines import of_bits64
from records import CorruptError, Record
from streams import Bit, Coded, magnitude, symbol, tree

DEGREE = 0.017453292519943295
PI = 3.141592653589793
Quaternion = list[float]


class Joint:
    """Columns, their axes, importance, reference."""

    def __init__(self) -> None:
        self.columns: list[int] = []
        self.axes: list[int] = []
        self.importance = 1.0
        self.reference: Quaternion = []


class Body:
    """Section "Body"."""

    def __init__(self, record: Record) -> None:
        self.count = record.integer()
        self.joints: list[Joint] = []
        self.numbers: list[tuple[int, float, float]] = []
        columns = []
        for column, role in enumerate(record.list_in_runs(self.count)):
            if role == 0:
                columns.append(column)
                continue
            if role < 4:
                self.joints.append(Joint())
            self.joints[-1].columns.append(column)
            self.joints[-1].axes.append((role - 1) % 3)
        flags = record.integer()
        self.last_first, self.radians = bool(flags & 1), bool(flags & 2)
        for joint in self.joints:
            joint.importance = record.integer() / 16
            parts = [record.signed() for _ in range(4)]
            size = sqrt(float(sum(part * part for part in parts)))
            joint.reference = [part / size for part in parts]
        facts = record.numbers(2 * len(columns))
        self.numbers = list(zip(columns, facts[::2], facts[1::2], strict=True))


class Counted:
    """A counted bit."""

    def __init__(self, byte: int = 128) -> None:
        self.zeros, self.all = 3 * (2 * byte + 1), 1536

    def take(self, stream: Coded) -> bool:
        """Take it, and count it."""
        one = stream.chance(min(max((self.zeros << 16) // self.all, 64), 65472))
        self.zeros += 0 if one else 64
        self.all += 64
        if self.all > 25600:
            self.zeros, self.all = self.zeros // 2, self.all // 2
        return one


class Sample(NamedTuple):
    """A frame, the frames that it is predicted from, and their weights."""

    frame: int
    known: list[int]
    weights: list[float]


def stages(frames: int, levels: int) -> list[tuple[int, int, list[Sample]]]:
    """Give kind, stride and frames of the stages."""
    wide, last = 2**levels, frames - 1
    found = [(0, wide, [Sample(0, [], [])])]
    anchors = [*range(0, last, wide), last] if last else [0]
    for before, frame in pairwise(anchors):
        found.append((1, wide, [Sample(frame, [before], [1.0])]))
    for kind, level in enumerate(reversed(range(levels)), 2):
        stride, samples = 2**level, []
        for t in range(stride, last, 2 * stride):
            known = [t - stride, min(t + stride, last)]
            known += [t - 3 * stride] if t >= 3 * stride else []
            far = min(t + 3 * stride, last)
            known += [far] if far > known[1] else []
            weights = []
            for own in known:
                over = under = 1.0
                for other in known:
                    if other != own:
                        over, under = over * (t - other), under * (own - other)
                weights.append(over / under)
            samples.append(Sample(t, known, weights))
        found.append((kind, stride, samples))
    return found


def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Multiply."""
    return [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]


# 1/3!, 1/5! ... and 1/2!, 1/4! ..., with their signs.
SINE = (-6, 120, -5040, 362880, -39916800, 6227020800, -1307674368000)
COSINE = (-2, 24, -720, 40320, -3628800, 479001600, -87178291200, 20922789888000)


def sine_cosine(a: float) -> tuple[float, float]:
    """Give sine and cosine ("Symbols")."""
    if abs(a) > 1e6:
        raise CorruptError("an angle of more turns than any motion has")
    quarter = float.fromhex("0x1.921fb544p+0")
    quarters = a / quarter
    count = int(quarters + (-0.5 if quarters < 0 else 0.5))
    x = (a - count * quarter) - count * float.fromhex("0x1.0b4611a6p-34")
    x -= count * float.fromhex("0x1.3198a2e037073p-69")
    q = x * x
    sine, cosine = 1.0 / SINE[-1], 1.0 / COSINE[-1]
    for n in reversed(SINE[:-1]):
        sine = 1.0 / n + q * sine
    for n in reversed(COSINE[:-1]):
        cosine = 1.0 / n + q * cosine
    sine, cosine = x + x * q * sine, 1 + q * cosine
    return ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[count % 4]


def difference(stream: Coded, lengths: list[Bit]) -> int:
    """Take a signed number."""
    length = symbol(stream, lengths)
    if length == 0:
        return 0
    negative = stream.raw(1)
    size = magnitude(stream, length)
    return -size if negative else size


def about(axis: list[float], half: float) -> Quaternion:
    """Give a turn about an axis."""
    sine, cosine = sine_cosine(half)
    return [cosine, sine * axis[0], sine * axis[1], sine * axis[2]]


def direction(vector: list[float]) -> tuple[list[float], float]:
    """Give axis and length of a vector."""
    size = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
    return [part / size for part in vector] if size else vector, size


def angle(y: float, x: float) -> float:
    """Give the angle of a point ("Rows")."""
    low, high = min(abs(x), abs(y)), max(abs(x), abs(y), 1e-300)
    tangent = base = 0.0
    if low > 0.6681786379192989 * high:
        tangent, base = 1.0, PI / 4
    elif low > 0.198912367379658 * high:
        tangent, base = 0.41421356237309503, PI / 8
    r = (low - tangent * high) / (high + tangent * low)
    q, series = r * r, 1.0 / 21
    for n in range(19, 0, -2):
        series = 1.0 / n - q * series
    found = base + r * series
    if abs(y) > abs(x):
        found = PI / 2 - found
    if x < 0:
        found = PI - found
    return -found if y < 0 else found


class Decoder:
    """What all chunks share."""

    def __init__(self, header: bytes, model: bytes | None) -> None:
        record = Record(header)
        learned = record.integer()
        self.levels, self.omitted = record.integer(), record.integer()
        self.step, self.correction = record.double(), record.double()
        self.atoms: list[list[tuple[list[float], float]]] = []
        self.chances = b""
        own = Record(model or b"") if learned else record
        self.body = Body(own)
        if learned:
            for _ in range(own.integer()):
                atom = []
                for joint in self.body.joints:
                    scale = 128 * joint.importance
                    atom.append(direction([own.signed() / scale for _ in range(3)]))
                self.atoms.append(atom)
            self.chances = own.bytes()
            own.end()
        record.end()

    def counted(self) -> list[list[Counted]]:
        """Give the bits that say whether a symbol is 0, of each kind."""
        count = len(self.atoms) + self.body.count
        known = len(self.chances) // count if count else 0
        bits = []
        for kind in range(18):
            if known:
                start = min(kind, known - 1) * count
                bits.append([Counted(byte) for byte in self.chances[start : start + count]])
            else:
                usual = (40, 110, 170, 200)[min(kind, 3)]
                bits.append([Counted(usual) for _ in range(count)])
        return bits

    def decode(self, payload: bytes, frames: int) -> list[list[float]]:
        """Give the rows of a chunk."""
        stream = Coded(payload)
        zeros, rest = self.counted(), tree(6)
        more = [[[Counted() for _ in range(14)] for _ in range(2)] for _ in range(18)]
        turns: list[list[Quaternion]] = [[] for _ in range(frames)]
        numbers: list[list[float]] = [[] for _ in range(frames)]
        for kind, stride, samples in stages(frames, self.levels):
            for sample in samples:
                symbols = [0] * (len(self.atoms) + self.body.count)
                if stride >> self.omitted:
                    for s in range(len(symbols)):
                        if zeros[kind][s].take(stream):
                            bits = more[kind][s >= len(self.atoms)]
                            symbols[s] = self._magnitude(stream, bits, rest)
                self._put_together(sample, symbols, turns, numbers)
        rows: list[list[float]] = []
        for own, others in zip(turns, numbers, strict=True):
            rows.append(self._row(own, others, rows[-1] if rows else None))
        self._correct(stream, rows)
        stream.end()
        return rows

    def _magnitude(self, stream: Coded, bits: list[Counted], rest: list[Bit]) -> int:
        sign = -1 if stream.raw(1) else 1
        for size, bit in enumerate(bits, 1):
            if not bit.take(stream):
                return sign * size
        more = difference(stream, rest)
        if more < 0:
            raise CorruptError("a magnitude below its least")
        return sign * (15 + more)

    def _predicted(self, sample: Sample, turns: list[list[Quaternion]], j: int) -> Quaternion:
        if not sample.known:
            return self.body.joints[j].reference
        known = [turns[frame][j] for frame in sample.known]
        if len(known) == 1:
            return known[0]
        total = [0.0] * 4
        for turned, weight in zip(known, sample.weights, strict=True):
            if along(turned, known[0]) < 0:
                weight = -weight
            total = [a + weight * b for a, b in zip(total, turned, strict=True)]
        size = sqrt(along(total, total))
        return [part / size for part in total] if size > 1e-9 else known[0]

    def _put_together(
        self,
        sample: Sample,
        symbols: list[int],
        turns: list[list[Quaternion]],
        numbers: list[list[float]],
    ) -> None:
        weighted = [(k, m) for k, m in enumerate(symbols[: len(self.atoms)]) if m]
        weighted.sort(key=lambda pair: -abs(pair[1]))
        own = symbols[len(self.atoms) :]
        made = []
        for j, joint in enumerate(self.body.joints):
            turned = self._predicted(sample, turns, j)
            for k, m in weighted:
                axis, half = self.atoms[k][j]
                if half:
                    turned = product(turned, about(axis, m * self.step * half))
            vector = [0.0] * 3
            for column, axis_index in zip(joint.columns, joint.axes, strict=True):
                vector[axis_index] = own[column] * self.step / joint.importance
            if any(vector):
                turned = product(turned, about(*direction(vector)))
            made.append(turned)
        turns[sample.frame] = made
        for n, (column, importance, reference) in enumerate(self.body.numbers):
            predicted = 0.0 if sample.known else reference
            for frame, weight in zip(sample.known, sample.weights, strict=True):
                predicted += weight * numbers[frame][n]
            numbers[sample.frame].append(predicted + own[column] * self.step / importance)

    def _row(
        self, turns: list[Quaternion], numbers: list[float], before: list[float] | None
    ) -> list[float]:
        row = [0.0] * self.body.count
        for joint, turned in zip(self.body.joints, turns, strict=True):
            self._angles(joint, turned, before, row)
        for (column, _, _), number in zip(self.body.numbers, numbers, strict=True):
            row[column] = number
        return row

    def _angles(
        self, joint: Joint, q: Quaternion, before: list[float] | None, row: list[float]
    ) -> None:
        places = list(zip(joint.columns, joint.axes, strict=True))
        if self.body.last_first:
            places.reverse()
        axes = [axis for _, axis in places]
        found, twin = euler(q, axes)
        unit = DEGREE if self.body.radians else 1.0
        sums = [0.0, 0.0]
        for n, (column, _) in enumerate(places):
            near = before[column] / unit if before else 0.0
            for i, angles in enumerate((found, twin)):
                angles[n] -= 360 * floor((angles[n] - near) / 360 + 0.5)
                sums[i] += abs(angles[n] - near)
        chosen = twin if len(places) == 3 and before and sums[1] < sums[0] else found
        for n, (column, _) in enumerate(places):
            row[column] = chosen[n] * unit

    def _correct(self, stream: Coded, rows: list[list[float]]) -> None:
        column_bit, any_bit, kind_bit, sizes = Counted(), Counted(), Counted(), tree(6)
        if not Counted().take(stream):
            return
        for column in range(self.body.count):
            if not column_bit.take(stream):
                continue
            for row in rows:
                if not any_bit.take(stream):
                    continue
                if kind_bit.take(stream):
                    row[column] = of_bits64(stream.raw(64))
                else:
                    row[column] += difference(stream, sizes) * self.correction


def euler(q: Quaternion, axes: list[int]) -> tuple[list[float], list[float]]:
    """Give the angles about the axes of a product, degrees, and the other set of three."""
    w, a = q[0], q[1 + axes[0]]
    if len(axes) == 1:
        first, second, third = 2 * angle(a, w), 0.0, 0.0
    else:
        k = 3 - axes[0] - axes[1]
        b, c = q[1 + axes[1]], q[1 + k]
        e = 1 if (axes[0] + 1) % 3 == axes[1] else -1
        sine = min(max(2 * (w * b + e * a * c), -1.0), 1.0)
        second = angle(sine, sqrt(1 - sine * sine))
        if abs(sine) > 1 - 1e-14:
            first, third = 2 * angle(a, w), 0.0
        else:
            first = angle(2 * (w * a - e * b * c), w * w - a * a - b * b + c * c)
            third = angle(2 * (w * c - e * a * b), w * w + a * a - b * b - c * c)
    found = [first / DEGREE, second / DEGREE, third / DEGREE]
    return found, [found[0] + 180, 180 - found[1], found[2] + 180]


def along(p: Quaternion, q: Quaternion) -> float:
    """Give the scalar product."""
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]


def decode(
    header: bytes,
    _: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
    model: bytes | None = None,
) -> list[list[float]]:
    """Give the rows of chunks."""
    decoder = Decoder(header, model)
    if decoder.body.count != len(formats):
        raise CorruptError("a header of other columns")
    return [row for frames, payload in chunks for row in decoder.decode(payload, frames)]
