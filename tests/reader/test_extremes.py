"""The second reader decodes any columns to the same bits, also such as no motion has."""

import random
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mocapress import _core

sys.path.append(str(Path(__file__).parents[2] / "docs/reader"))
import exact_fast
from exact_header import Column, Coupling
from exact_model import Part
from lines import Line
from streams import Coded

FLOATS, SIGNIFICANT, DECIMALS, PRINTED = (0, 1, 4), 2, 3, (5, 6)


def on_line(values: NDArray[np.float64], kind: int, digits: int) -> NDArray[np.float64]:
    """Take the numbers of a line next to values."""
    line = Line(kind, digits)
    return np.array([line.number(line.near(x)) for x in values.tolist()])


def columns(choice: random.Random, count: int, far: int) -> list[Column]:
    """Choose lines, exponents and turns of columns."""
    lines = [*((kind, 0) for kind in FLOATS * 3), *((SIGNIFICANT, d) for d in range(1, 16))]
    lines += [(kind, d) for kind in (DECIMALS, *PRINTED) for d in range(0, 19, 3)]
    return [
        Column(
            Line(*choice.choice(lines)),
            c,
            unit=2.0 ** choice.choice([0, 0, 0, -far, -8, 8, far if far > 104 else 0]),
            turns=choice.choice([0, 0, 1, 2]),
        )
        for c in range(count)
    ]


def motion(choice: random.Random, frames: int, told: list[Column]) -> NDArray[np.float64]:
    """Give numbers of these columns, here and there with leaps, zeros and what is no number."""
    source = np.random.default_rng(choice.randrange(2**32))
    found = np.empty((frames, len(told)))
    for c, column in enumerate(told):
        size = 10.0 ** choice.choice([-30, -3, 0, 0, 1, 1, 3, 30])
        values = np.cumsum(source.normal(size=frames)) * size
        values[source.random(frames) < 0.05] *= 10.0 ** choice.randint(-6, 6)
        values[source.random(frames) < 0.02] = 0
        if column.turns:
            values = (values + 180) % 360 - (180 if column.turns == 1 else 0)
        found[:, c] = on_line(values, column.line.kind, column.line.digits)
    odd = [np.nan, np.inf, -np.inf, 1e300, 5e-324, -0.0]
    found[choice.randrange(frames), choice.randrange(len(told))] = choice.choice(odd)
    return found


def check(
    level: int,
    told: list[Column],
    values: NDArray[np.float64],
    couplings: list[Coupling],
    *,
    known: bool = False,
) -> None:
    """Encode with the core, decode with the reader."""
    plan = [
        (
            one.line.kind,
            one.line.digits,
            one.noise,
            np.log2(one.unit),
            one.turns,
            c if known else -1,
        )
        for c, one in enumerate(told)
    ]
    payload, _, _ = _core.exact_encode(
        values,
        np.array(plan, dtype=np.int32),
        [(one.kind, one.sources, one.targets, []) for one in couplings],
        level,
        ([], []),
        False,
    )
    if level < 6:
        rows = exact_fast.decode(payload, len(values), told, couplings, level)
    else:
        stream = Coded(payload)
        part = Part(stream, level, told, couplings, known, {})
        rows = [part.frame(first=frame == 0) for frame in range(len(values))]
        stream.end()
    assert np.array(rows).tobytes() == values.tobytes()


@pytest.mark.parametrize("seed", range(40))
def test_any_columns_decode_to_the_same_bits(seed: int) -> None:
    choice = random.Random(seed)
    level = 1 + seed % 9
    frames = choice.choice([5, 30]) if level > 5 else 90
    told = columns(choice, choice.choice([3, 9, 14]), far=1000)
    told[-1].noise, told[-1].unit, told[-1].turns = True, 1.0, 0
    values = motion(choice, frames, told)
    couplings = [Coupling(choice.choice([1, 2]), [*range(6)], [6, 7, 8])] if len(told) > 9 else []
    couplings += [Coupling(0, [0, 1], [4, 5])] if len(told) > 3 else []
    check(level, told, values, couplings if level > 2 else [])


@pytest.mark.parametrize("seed", range(6))
def test_any_columns_of_the_known_skeleton_decode_to_the_same_bits(seed: int) -> None:
    choice = random.Random(seed)
    told = columns(choice, 62, far=1000)
    values = motion(choice, 6, told)
    check(8 + seed % 2, told, values, [Coupling(2, [*range(6)], [6, 7, 8])], known=True)


def test_a_prediction_beyond_its_line_decodes_to_the_same_bits() -> None:
    told = [Column(Line(SIGNIFICANT, 6), 0, unit=2.0**-1000)]
    check(3, told, np.array([[5e299], [9.9e299], [9.9e299], [1e299]]), [])
