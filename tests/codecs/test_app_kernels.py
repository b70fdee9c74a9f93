"""What APP is built on: lines of numbers, and differences coded in context."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mocapress import _core

SIGNIFICANT, DECIMALS, SHORTEST32 = 2, 3, 4
singles = st.floats(allow_nan=False, allow_infinity=False, width=32)


def snap(value: float, line: int, digits: int) -> float:
    values = np.array([[value]])
    _core.snap(values, np.array([[-1, 0, line, digits]], dtype=np.int32))
    return float(values[0, 0])


@given(singles, st.integers(1, 6))
def test_snap_gives_the_decimal_that_the_text_of_a_float_has(value: float, digits: int) -> None:
    printed = float(f"{value:.{digits - 1}e}")
    single = float(np.float32(printed)) if abs(printed) < 3.4e38 else printed
    if abs(printed) > 1.2e-38 or printed == 0:  # below, a float32 has fewer digits
        assert snap(single, SIGNIFICANT, digits) == printed


@given(st.integers(-(10**6), 10**6), st.integers(0, 22))
def test_snap_gives_the_fixed_decimal_near_a_float(number: int, decimals: int) -> None:
    printed = float(f"{number}e-{decimals}")
    assert snap(float(np.float32(printed)), DECIMALS, decimals) == printed


@given(singles)
def test_snap_gives_the_shortest_decimal_of_a_float(value: float) -> None:
    assert snap(value, SHORTEST32, 0) == float(str(np.float32(value)))


@given(st.floats(), st.integers(0, 4), st.integers(-5, 400))
def test_snap_settles(value: float, line: int, digits: int) -> None:
    if line == SHORTEST32 and abs(value) > 3e38:
        return
    once = snap(value, line, digits)
    assert np.float64(snap(once, line, digits)).tobytes() == np.float64(once).tobytes()
    assert np.signbit(once) == np.signbit(value)


@pytest.mark.parametrize("line", [0, SIGNIFICANT, DECIMALS, SHORTEST32])
@pytest.mark.parametrize("value", [-0.0, np.inf, -np.inf])
def test_snap_keeps_what_has_no_digits(value: float, line: int) -> None:
    assert np.float64(snap(value, line, 3)).tobytes() == np.float64(value).tobytes()


@given(arrays(np.int64, st.integers(0, 50)))
def test_differences_come_back(values: np.ndarray) -> None:
    decoded = np.empty_like(values)
    _core.decode_differences(_core.encode_differences(values), decoded)
    assert decoded.tolist() == values.tolist()


def test_extreme_differences_come_back() -> None:
    values = np.array([0, 1, -1, 2**63 - 1, -(2**63)] * 30)
    coded = _core.encode_differences(values)
    decoded = np.empty_like(values)
    _core.decode_differences(coded, decoded)
    assert decoded.tolist() == values.tolist()
    for size in range(len(coded)):
        with pytest.raises(ValueError, match="cut off"):
            _core.decode_differences(coded[:size], decoded)


def test_carries_run_through_the_whole_output() -> None:
    # Nothing but sure answers of one kind, then the other: the low end nears the top of its word.
    for count in (1, 7, 100, 5000):
        values = np.array([2**62] * count + [0])
        decoded = np.empty_like(values)
        _core.decode_differences(_core.encode_differences(values), decoded)
        assert decoded.tolist() == values.tolist()
