"""DiffMA word by word: Algorithms 1 and 2 of the paper, unhurried, on floats or exact fractions.

Lines are numbered as in the paper. ``order`` above 0 is the extension of docs/guide/diffma_json.md.
"""

import math
from collections.abc import Sequence
from typing import Any

Number = Any
"""A float or a Fraction: mypy has no type for what both can do."""

NEG, RAW, EQL, APX = 0, 1, 2, 3
ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~"


def mean_of_last(steps: Sequence[Number], w: int) -> Number:
    """Compute the mean of the last w of all steps, in the order that the format lays down."""
    if not steps:
        return 0
    begin = (len(steps) - 1) // w * w
    forwards: Number = 0
    for step in steps[begin:]:
        forwards += step
    backwards: Number = 0
    for step in reversed(steps[max(0, len(steps) - w) : begin]):
        backwards += step
    return (backwards + forwards) / min(len(steps), w)


def predict(decoded: Sequence[Number], order: int) -> Number:
    if order == 0 or len(decoded) <= order:
        return decoded[-1]
    predicted: Number = 0
    for k in range(order + 1):
        predicted += (-1) ** k * math.comb(order + 1, k + 1) * decoded[-1 - k]
    return predicted


def encode(
    x: Sequence[Number],
    beta: Number,
    tau: Number,
    n: int,
    w: int,
    offset: Number = 0.5,
    order: int = 0,
    max_error: Number = math.inf,
) -> tuple[list[int], list[Number]]:
    """Algorithm 1: opcodes as numbers (Eq. 3.1), and the look-up table."""
    b: list[int] = []
    t: list[Number] = []
    l: list[Number] = []  # noqa: E741  # all that were appended; the mean looks at the last w
    s_before = 1  # 2
    if not x:
        return b, t
    t.append(x[0])  # 5
    decoded = [x[0]]
    for v in x[1:]:  # 8
        p = predict(decoded, order)
        d = v - p  # 10
        s = 1 if d >= 0 else -1  # 11
        if s != s_before:
            b.append(NEG)  # 12
        c = None
        m = mean_of_last(l, w)  # 14
        if d == 0:  # 15
            c, near = EQL, p
        elif m > 0:  # 18
            unit = m * (beta / 2**n)
            if unit > 0 and abs(d) / unit + offset < 2**n:
                q = math.floor(abs(d) / unit + offset)  # 19
                near = p + s * (q * unit)  # 20
                if abs(v - near) < tau and abs(v - near) <= max_error:  # 21
                    c = APX + q
        if c is None:
            c, near = RAW, v
            t.append(v)
        b.append(c)
        if len(decoded) > order:
            l.append(abs(near - p))  # 31
        decoded.append(near)
        s_before = s
    return b, t


def decode(
    b: Sequence[int], t: Sequence[Number], beta: Number, n: int, w: int, order: int = 0
) -> list[Number]:
    """Algorithm 2."""
    if not t:
        return []
    decoded, rest = [t[0]], list(t[1:])
    l: list[Number] = []  # noqa: E741
    s = 1
    for c in b:
        if c == NEG:
            s = -s
            continue
        p = predict(decoded, order)
        if c == EQL:
            near = p
        elif c == RAW:
            near = rest.pop(0)
        else:
            near = p + s * ((c - APX) * (mean_of_last(l, w) * (beta / 2**n)))
        if len(decoded) > order:
            l.append(abs(near - p))
        decoded.append(near)
    assert not rest
    return decoded


def text(b: Sequence[int], n: int) -> str:
    """Give opcodes as characters."""
    lead = max(0, math.ceil((2**n - 82) / 84))
    single = 85 - lead
    found = ""
    for c in b:
        if c < single:
            found += ALPHABET[c]
        else:
            found += ALPHABET[single + (c - single) // 85] + ALPHABET[(c - single) % 85]
    return found
