"""The codec ``app`` (docs/format.md)."""

import lines
from lines import rounded
from records import Record
from streams import Bit, Coded, symbol, tree

TABLES = {
    "k2-non-uniform": (-2, -0.5, 0, 0.5),
    "k3-uniform": (-1.75, -1.25, -0.75, -0.25, 0.25, 0.75, 1.25, 1.75),
    "k3-non-uniform": (-1, -0.5, -0.25, 0, 0.25, 0.5, 1, 2),
    "k4-non-uniform": (
        *(-2, -1.25, -1, -0.75, -0.5, -0.25, -0.125, 0),
        *(0.125, 0.25, 0.5, 0.75, 1, 1.25, 2, 5),
    ),
}
# How columns of each kind of number format are rounded, and how many digits to add to theirs.
ROUNDED = {
    0: ("significant", 0),
    1: ("decimals", 0),
    2: ("decimals", 0),
    3: ("significant", 1),
    5: ("shortest32", 0),
}


class Floats:
    """The models of all columns of one precision."""

    def __init__(self, single: bool, limit: int) -> None:
        self.single = single
        self.mantissa_bits, self.exponent_bits = (23, 8) if single else (52, 11)
        self.escapes = limit <= self.mantissa_bits
        self.moved = Bit()
        self.exponents = tree(3)
        self.contexts: dict[int, tuple[Bit, list[Bit]]] = {}

    def next(self, stream: Coded, predicted: float) -> float:
        """Take a number beside its prediction."""
        mantissa_bits, exponent_bits = self.mantissa_bits, self.exponent_bits
        bits = lines.bits32(predicted) if self.single else lines.bits64(predicted)
        top, mantissa = divmod(bits, 1 << mantissa_bits)
        sign, exponent = divmod(top, 1 << exponent_bits)
        if not stream.bit(self.moved):
            if exponent not in self.contexts:
                self.contexts[exponent] = Bit(), tree(5 if self.single else 6)
            escape, lengths = self.contexts[exponent]
            if not (self.escapes and stream.bit(escape)):
                return self._number(sign, exponent, mantissa + difference(stream, lengths))
        else:
            expo_diff = symbol(stream, self.exponents)
            if expo_diff < 7:
                exponent += expo_diff - 3
            else:
                sign, exponent = stream.raw(1), stream.raw(exponent_bits)
        return self._number(sign, exponent, stream.raw(mantissa_bits))

    def _number(self, sign: int, exponent: int, mantissa: int) -> float:
        bits = (sign << self.exponent_bits | exponent) << self.mantissa_bits | mantissa
        return lines.of_bits32(bits) if self.single else lines.of_bits64(bits)


def difference(stream: Coded, lengths: list[Bit]) -> int:
    """Take a difference: its length by a tree, then what is below its leading one, and its sign."""
    length = symbol(stream, lengths)
    if length == 0:
        return 0
    coded = stream.raw(length)
    size = coded >> 1 | 1 << length - 1
    return -size if coded % 2 else size


def decode(
    header: bytes,
    parameters: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
) -> list[list[float]]:
    """Give the rows of chunks; ``formats`` are kind and digits of each column's number format."""
    record = Record(header)
    codes, precisions = (record.list_in_runs(len(formats)) for _ in range(2))
    record.end()
    parents = parents_of(codes)
    cluster = int(parameters.get("t", "15"))
    limit = int(parameters.get("mantissa_limit", "12"))
    alphas = TABLES[parameters.get("table", "k3-non-uniform")]
    rows = []
    for frames, payload in chunks:
        columns = chunk_columns(payload, frames, parents, precisions, alphas, cluster, limit)
        for column, (kind, digits) in enumerate(formats):
            if precisions[column] == 2 and kind in ROUNDED:
                grid, more = ROUNDED[kind]
                columns[column] = [rounded(m, grid, digits + more) for m in columns[column]]
        rows += [list(row) for row in zip(*columns, strict=True)]
    return rows


def parents_of(codes: list[int]) -> list[int | None]:
    """Give each column's parent."""
    return [
        None if code == 0 else column - code // 2 if code % 2 == 0 else column + (code + 1) // 2
        for column, code in enumerate(codes)
    ]


def chunk_columns(
    payload: bytes,
    frames: int,
    parents: list[int | None],
    precisions: list[int],
    alphas: tuple[float, ...],
    cluster: int,
    limit: int,
) -> list[list[float]]:
    """Decode a chunk, column by column."""
    clusters, k = -(-frames // cluster), len(alphas).bit_length() - 1
    size = (clusters * len(parents) * k + 7) // 8
    indices = int.from_bytes(payload[:size], "little")
    stream = Coded(payload[size:])
    models = {single: Floats(single, limit) for single in (False, True)}
    columns: dict[int, list[float]] = {}

    def decode_column(c: int) -> None:
        parent = parents[c]
        if c in columns:
            return
        if parent is not None:
            decode_column(parent)
        floats = models[precisions[c] > 0]
        column: list[float] = []
        for j in range(frames):
            predicted = 0.0
            if j > 0:
                predicted = column[-1]
                if parent is not None:
                    index = indices >> k * (c * clusters + j // cluster) & len(alphas) - 1
                    step = columns[parent][j] - columns[parent][j - 1]
                    predicted += alphas[index] * step
            if predicted != predicted:
                predicted = 0.0
            column.append(floats.next(stream, predicted))
        columns[c] = column

    for c in range(len(parents)):
        decode_column(c)
    stream.end()
    return [columns[c] for c in range(len(parents))]
