"""The codec ``diffma`` (docs/format.md, docs/guide/diffma_json.md)."""

import lzma
from math import comb

from records import CorruptError, Record

ALPHABET = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~"
NEG, RAW, EQL, APX = range(4)


def decode(
    header: bytes,
    parameters: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
) -> list[list[float]]:
    """Give the rows of chunks; of the number formats, only how many there are counts."""
    record = Record(header)
    plans: list[tuple[float, int]] = []
    while len(plans) < len(formats):
        plan = record.double(), record.integer()
        plans += [plan] * record.integer()
    record.end()
    bits, window = int(parameters.get("bits", "6")), int(parameters.get("window", "64"))
    filters = [{"id": lzma.FILTER_LZMA2, "dict_size": 2**20}]
    rows = []
    for frames, payload in chunks:
        text = lzma.decompress(payload, lzma.FORMAT_RAW, filters=filters)
        lines = text.split(b"\n")
        columns = []
        told, tables = lines[: len(plans)], lines[len(plans) :]
        for (bound, order), codes, table in zip(plans, told, tables, strict=True):
            numbers = [float(number) for number in table.split(b" ")]
            columns.append(channel(opcodes(codes, bits), numbers, bits, window, bound, order))
            if len(columns[-1]) != frames:
                raise CorruptError("opcodes of another number of frames")
        rows += [list(row) for row in zip(*columns, strict=True)]
    return rows


def opcodes(text: bytes, bits: int) -> list[int]:
    """Read opcodes, of one or two characters each."""
    single = 85 if bits <= 6 else 85 - (2**bits - 82 + 83) // 84
    found = []
    indices = iter(ALPHABET.index(character) for character in text)
    for index in indices:
        if index >= single:
            index = single + (index - single) * 85 + next(indices)
        found.append(index)
    return found


def channel(
    codes: list[int], table: list[float], bits: int, window: int, bound: float, order: int
) -> list[float]:
    """Algorithm 2."""
    coefficients = [(-1) ** k * comb(order + 1, k + 1) for k in range(order + 1)]
    values, steps = table[:1], list[float]()
    taken, sign = 1, 1
    for code in codes:
        if code == NEG:
            sign = -sign
            continue
        complete = len(values) > order
        predicted = values[-1]
        if complete and order > 0:
            predicted = 0.0
            for k, coefficient in enumerate(coefficients):
                predicted += coefficient * values[-1 - k]
        value = predicted
        if code == RAW:
            value = table[taken]
            taken += 1
        elif code >= APX:
            value = predicted + sign * ((code - APX) * (mean(steps, window) * (bound / 2**bits)))
        if complete:
            steps.append(abs(value - predicted))
        values.append(value)
    if taken != len(table):
        raise CorruptError("a table too short or too long")
    return values


def mean(steps: list[float], window: int) -> float:
    """Give the mean of the last steps, summed block by block."""
    last = max(len(steps) - 1, 0) // window * window
    total = 0.0
    for step in steps[last:]:
        total += step
    before = 0.0
    for step in reversed(steps[max(len(steps) - window, 0) : last]):
        before += step
    return (before + total) / max(min(len(steps), window), 1)
