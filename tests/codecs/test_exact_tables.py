"""Numbers that lie on a grid, or are few, or missing, cost what they should."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core
from mocapress.codecs import Encoded
from mocapress.codecs.exact.codec import _Coder
from mocapress.codecs.exact.columns import Told
from mocapress.codecs.exact.header import pack_header
from mocapress.codecs.exact.roles import find_roles
from mocapress.codecs.exact.start import Start
from mocapress.codecs.exact.tables import Table, coded
from mocapress.motion import Column, Stream

Values = NDArray[np.float64]
RANDOM = np.random.default_rng(1)
WALK = np.cumsum(RANDOM.normal(size=(1500, 6)) * 40, axis=0)


def encoded(values: Values, spec: str = "exact") -> Encoded:
    """Code values, and see that their bits come back, and those of the first rows alone."""
    columns = tuple(Column(f"v{i}", -1, "v") for i in range(values.shape[1]))
    codec = mp.codec(spec)
    made = codec.encode(Stream(values, columns))
    back = codec.decode(made.header, made.chunks, columns)
    assert back.tobytes() == values.tobytes()
    part = codec.decode(made.header, made.chunks, columns, stop=7)
    assert part.tobytes() == values[:7].tobytes()
    return made


def size(values: Values, spec: str = "exact") -> int:
    made = encoded(values, spec)
    return len(made.header) + sum(len(chunk.payload) for chunk in made.chunks)


def six_digits(values: Values) -> Values:
    return np.array([[float(f"{number:.6g}") for number in row] for row in values])


def as_floats(values: Values) -> Values:
    return values.astype(np.float32).astype(np.float64)


@pytest.mark.parametrize("spec", ["exact", "exact:level=9", "exact:level=1"])
@pytest.mark.parametrize(("origin", "step"), [(0.0, 0.06437297910451889), (0.25, 10 / 65536)])
def test_whole_numbers_times_a_float_cost_what_whole_numbers_cost(
    spec: str, origin: float, step: float
) -> None:
    whole = np.rint(WALK)
    floats = as_floats(origin + step * whole)
    assert size(floats, spec) < 1.02 * size(whole, spec) + 100
    assert {table.size for table in Told.find(floats)[0].tables} == {0}


def test_a_grid_with_some_roundings_is_still_a_grid() -> None:
    # Two roundings, as a program leaves that scales in float32 before it adds.
    whole = np.rint(WALK)
    twice = ((whole * 0.3).astype(np.float32) * np.float32(0.0173)).astype(np.float64)
    told, _, _ = Told.find(twice)
    assert {table.step > 0 for table in told.tables} == {True}
    assert size(twice) < 0.8 * size(as_floats(0.00519 * WALK))


def test_numbers_off_a_grid_do_not_cost_the_line_of_the_others() -> None:
    whole = np.rint(WALK)
    step = 0.06437297910451889
    floats = as_floats(step * whole)
    noise = np.random.default_rng(1).normal(0, 0.01, floats[100:160].shape)
    floats[100:160] = as_floats(floats[100:160] + noise)  # 4 % of them
    boxed = np.stack([coded(Table(step=step), column) for column in floats.T], axis=1)
    assert np.isnan(boxed).mean() > 0.035
    # Of a number off the grid its float32 is told, and where it is.
    assert size(boxed) < 1.1 * size(whole) + 11 * noise.size


def test_a_grid_whose_middle_was_taken_off_is_still_a_grid() -> None:
    # What is left near 0 has more digits than the grid, and now and then is not quite 0.
    whole = np.rint(WALK)
    volts = (whole * 0.000152588).astype(np.float32)
    moved = (volts - volts.mean(axis=0, dtype=np.float32)).astype(np.float64)
    moved[np.abs(moved) < 0.0001] = as_floats(np.array([6.1e-13]))[0]
    told, _, _ = Told.find(moved)
    assert len(told.table_of) == 6
    assert all(told.table_of)
    assert {table.step > 0 for table in told.tables} == {True}
    assert size(moved) < 0.8 * size(as_floats(0.000152588 * WALK))


@pytest.mark.parametrize("rounded", [lambda values: np.round(values, 3), six_digits])
def test_decimals_that_were_stored_as_floats_cost_what_decimals_cost(
    rounded: Callable[[Values], Values],
) -> None:
    decimals = rounded(WALK / 10)
    told, numbers, _ = Told.find(as_floats(decimals))
    assert numbers.tobytes() == decimals.tobytes()
    assert {table.all for table in told.tables} == {True}
    assert size(as_floats(decimals)) < size(decimals) + 20


def test_floats_among_decimals_that_were_stored_come_back() -> None:
    floats = as_floats(np.round(WALK / 10, 3))
    floats[::40] = as_floats(floats[::40] + 1e-4)
    floats[7] = [-0.0, 3.4e38, -3.4e38, np.inf, -np.inf, 1e-40]
    assert any(table.all for table in Told.find(as_floats(floats))[0].tables)
    encoded(as_floats(floats))


def test_few_numbers_are_a_list() -> None:
    numbers = np.sort(as_floats(RANDOM.normal(size=40)))
    steps = np.clip(np.cumsum(RANDOM.integers(-1, 2, (1500, 3)), axis=0) + 20, 0, 39)
    told, _, _ = Told.find(numbers[steps])
    assert [len(table.numbers) for table in told.tables] == [40]
    assert size(numbers[steps]) < 1.1 * size(steps.astype(np.float64)) + 200


def test_columns_without_a_grid_have_none() -> None:
    told, numbers, masks = Told.find(as_floats(WALK))
    assert not told.tables
    assert not masks
    assert np.array_equal(numbers, as_floats(WALK))


@pytest.mark.parametrize("spec", ["exact", "exact:level=2,chunk=100"])
def test_gaps_cost_little(spec: str) -> None:
    values = as_floats(WALK)
    gaps = values.copy()
    gaps[100:400, :3] = np.nan
    gaps[:30, 3:] = np.nan
    gaps[900:, 1] = np.nan
    assert size(gaps, spec) < size(values, spec)
    assert size(gaps, spec) < 0.9 * size(values, spec)


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_zeros_among_floats_cost_little(zero: float) -> None:
    # A force plate that nobody stands on.
    values = as_floats(WALK)
    values[200:1300] = zero
    assert size(values) < 0.4 * size(as_floats(WALK))


def test_every_number_comes_back() -> None:
    values = as_floats(0.5 * np.rint(WALK))
    values[3, 0], values[4, 0], values[5, 0] = np.inf, -np.inf, -0.0
    values[6, 1], values[7, 1] = np.nan, 1e-300
    values[8, 2] = np.uint64(0x7FF8000020000000).view(np.float64)
    values[9, 3] = 1e30
    values[:, 4] = np.nan
    encoded(values)
    encoded(values[:1])
    encoded(values[:2])
    encoded(np.full((5, 2), np.nan))


def restored(table: Table, places: Values) -> Values:
    """Give what a decoder makes of a column of places, (F,)."""
    numbers = np.ascontiguousarray(places[:, None])
    roles = find_roles(numbers, lambda _, __: [])
    header = pack_header(roles, Told(tables=[table], table_of=[1]), has_model=False)
    payload, _, _ = _Coder(roles, 1, Start()).encode(numbers)
    rows = np.empty_like(numbers)
    _core.exact_decode_chunk(header, payload, rows, len(rows), 1, b"")
    return rows[:, 0]


def test_numbers_outside_a_table_are_boxed() -> None:
    numbers = np.array([0.1, 0.2, np.nan, np.inf, -0.0, 0.5]).astype(np.float32)
    values = numbers.astype(np.float64)
    listed = Table(numbers=np.sort(values[[0, 1, 5]]))
    grid = Table(origin=0.0, step=float(np.float32(0.1)))
    for table in (listed, grid):
        places = coded(table, values)
        assert restored(table, places).tobytes() == values.tobytes()
        assert np.isnan(places[2:5]).all()


def test_a_place_outside_a_list_is_refused() -> None:
    table = Table(numbers=np.array([0.5, 1.5]))
    for place in (2.0, -1.0, 0.5, np.inf):
        with pytest.raises(ValueError, match="outside its list"):
            restored(table, np.array([place]))
