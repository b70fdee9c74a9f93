"""Compressors of numbers restore matrices bit for bit, or they would be no rivals."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from mocapress_bench import rivals
from mocapress_bench.rivals import Rival

MAKERS: dict[str, Callable[[], Rival]] = {
    "pcodec float64": partial(rivals.pcodec, grid=False),
    "pcodec grid": partial(rivals.pcodec, grid=True),
    "OpenZL float64": partial(rivals.openzl, grid=False),
    "OpenZL grid": partial(rivals.openzl, grid=True),
    "Parquet": rivals.parquet,
    "fpzip": rivals.fpzip,
    "zfp": rivals.zfp,
}


@pytest.fixture(params=MAKERS)
def rival(request: pytest.FixtureRequest) -> Rival:
    try:
        return MAKERS[request.param]()
    except ImportError as missing:
        pytest.skip(f"not installed: {missing.name}")


def comes_back(rival: Rival, values: NDArray[np.float64]) -> None:
    packed = rival.compress(values)
    restored = rival.decompress(packed, (values.shape[0], values.shape[1]))
    assert restored.shape == values.shape
    assert restored.tobytes() == values.tobytes()


@pytest.mark.parametrize("printed", ["%.6g", "%.4f", "%.0f", "%.3e", "%.17g"])
def test_numbers_of_text_come_back(rival: Rival, printed: str) -> None:
    wave = [[40 * math.sin(0.1 * i + c) * 10.0**-c for c in range(9)] for i in range(300)]
    comes_back(rival, np.array([[float(printed % x) for x in row] for row in wave]))


@given(
    values=arrays(
        np.float64,
        st.tuples(st.integers(1, 30), st.integers(1, 4)),
        elements=st.sampled_from([0.0, 0.1, -7.5, 999999.5, 1e6, 1e-14, -1.6201e-14, 123456.0])
        | st.floats(-1e20, 1e20).map(lambda x: float(f"{x:.6g}") + 0.0)
        | st.integers(-(2**60), 2**60).map(float),
    )
)
def test_numbers_on_any_grid_come_back(values: NDArray[np.float64]) -> None:
    comes_back(rivals.pcodec(grid=True), values)


@given(
    values=arrays(
        np.uint64,
        st.tuples(st.integers(1, 9), st.integers(1, 3)),
        elements=st.integers(0, 2**64 - 1),
    )
)
def test_any_floats_come_back(values: NDArray[np.uint64]) -> None:
    comes_back(rivals.pcodec(grid=True), values.view(np.float64))


def test_the_grid_is_worth_it() -> None:
    wave = np.array([[float(f"{40 * math.sin(0.05 * i):.6g}")] for i in range(2000)])
    on_grid, floats = (len(rivals.pcodec(grid=grid).compress(wave)) for grid in (True, False))
    assert on_grid < 0.9 * floats
