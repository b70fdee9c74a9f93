"""The fast levels of ``exact``: every number on every line comes back, and cheaply."""

import lzma
import re
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core, codecs
from mocapress.api import Opened
from mocapress.codecs.exact import Exact
from mocapress.motion import Clip
from mocapress.source import Source

sys.path.append(str(Path(__file__).parents[2] / "docs/reader"))
import exact_fast
from exact_header import Column
from lines import Line

Values = NDArray[np.float64]
LEVELS = (1, 2, 3, 4, 5)
FLOAT64, FLOAT32, SIGNIFICANT, DECIMALS, SHORTEST32, PRINTED32, DEGREES32 = range(7)
LINES = [
    (FLOAT64, 0),
    (FLOAT32, 0),
    (SHORTEST32, 0),
    (PRINTED32, 6),
    (DEGREES32, 6),
    *((SIGNIFICANT, digits) for digits in (1, 2, 6, 9, 15)),
    *((DECIMALS, digits) for digits in (0, 4, 6, 15)),
]


def plan(
    columns: int, line: tuple[int, int], noise: int = 0, exponent: int = 0
) -> NDArray[np.int32]:
    """Give columns of one line, the last of them noise."""
    rows = [(*line, c >= columns - noise, exponent, 0, -1) for c in range(columns)]
    return np.array(rows, dtype=np.int32).reshape(-1, 6)


def payload_of(values: Values, told: NDArray[np.int32], level: int) -> bytes:
    return _core.exact_encode(np.ascontiguousarray(values), told, [], level, ([], []), False)[0]


def decoded(payload: bytes, shape: tuple[int, ...], told: NDArray[np.int32], level: int) -> Values:
    values = np.empty(shape)
    _core.exact_decode(payload, values, told, [], level, ([], []), True)
    return values


def assert_comes_back(values: Values, told: NDArray[np.int32], level: int) -> bytes:
    payload = payload_of(values, told, level)
    assert decoded(payload, values.shape, told, level).tobytes() == values.tobytes()
    return payload


def on_line(values: Values, line: tuple[int, int]) -> Values:
    """Round as the line's text does."""
    kind, digits = line
    if kind == FLOAT64:
        return values
    if kind == FLOAT32:
        return values.astype(np.float32).astype(np.float64)
    if kind in (PRINTED32, DEGREES32):
        unit = 57.29577951308232 if kind == DEGREES32 else 1
        printed = (values / unit).astype(np.float32).astype(np.float64) * unit
        return on_line(printed, (DECIMALS, digits))
    if kind == SHORTEST32:
        texts = [str(x) for x in values.astype(np.float32).ravel()]
    elif kind == SIGNIFICANT:
        texts = [f"{x:.{digits - 1}e}" for x in values.ravel()]
    else:
        texts = [f"{x:.{digits}f}" for x in values.ravel()]
    return np.array([float(text) for text in texts]).reshape(values.shape)


def walk(frames: int, columns: int, size: float = 1, seed: int = 0) -> Values:
    """Give smooth motion that crosses zero and many decades."""
    steps = np.random.default_rng(seed).normal(size=(frames, columns))
    return size * np.cumsum(np.cumsum(steps, axis=0) * 0.02, axis=0)


@pytest.mark.parametrize("level", LEVELS)
def test_the_sample_is_smaller_than_what_xz_makes_of_it(samples: Path, level: int) -> None:
    data = (samples / "cmu_01_01.amc").read_bytes()
    packed = mp.compress(data, f"exact:level={level}")
    assert mp.decompress(packed) == data
    assert 1.9 * len(packed) < len(lzma.compress(data, preset=9 | lzma.PRESET_EXTREME))


def test_each_level_is_smaller(samples: Path) -> None:
    data = (samples / "cmu_01_01.amc").read_bytes()
    sizes = [len(mp.compress(data, f"exact:level={level}")) for level in (*LEVELS, 6)]
    assert all(one < 0.996 * before for before, one in pairwise(sizes))


def test_a_level_is_not_larger_than_the_one_below(samples: Path) -> None:
    """Where more predictors do harm, the clip is coded as at a lower level."""
    data = (samples / "mocapbank.bvh").read_bytes()
    sizes = [len(mp.compress(data, f"exact:level={level}")) for level in range(1, 10)]
    assert all(size <= 1.002 * min(sizes[: i + 1]) for i, size in enumerate(sizes))


def test_no_level_costs_more_than_those_below_but_for_a_byte() -> None:
    """That byte is what the level is called."""
    values = np.random.default_rng(1).normal(size=(40, 3)).round(4)
    clip = mp.from_array(values, ("a", "b", "c"), fps=120)
    sizes = [len(mp.compress(clip, f"exact:level={level}")) for level in range(1, 10)]
    assert all(size <= min(sizes[: i + 1]) + 1 for i, size in enumerate(sizes))


def test_a_file_says_which_level_was_asked_for() -> None:
    values = np.random.default_rng(1).normal(size=(40, 3)).round(4)
    clip = mp.from_array(values, ("a", "b", "c"), fps=120)
    for level in (1, 5, 6, 9):
        blob = mp.compress(clip, f"exact:level={level},chunk=30")
        assert Opened(Source(blob)).codec() == mp.codec(f"exact:level={level},chunk=30")


def test_the_usual_level_is_the_same_everywhere() -> None:
    """Python, the compiled core and the page each have it once."""
    root = Path(__file__).parents[2]
    told = {
        "core/exact/codec.hpp": r"kUsualLevel = (\d);",
        "viewer/mcz/decoding.js": r"USUAL_LEVEL = (\d);",
        "docs/format/exact.md": r"`level` \((\d)\)",
    }
    for path, pattern in told.items():
        assert re.findall(pattern, (root / path).read_text(encoding="utf-8")) == ["5"], path
    assert Exact().level == 5


@pytest.mark.parametrize("level", LEVELS)
def test_fast_levels_need_no_more_than_a_chunk(samples: Path, level: int) -> None:
    """Chunks of one frame cost what their numbers cost."""
    clip = mp.read(samples / "cmu_01_01.amc")
    few = Clip.of(clip.values[:20], clip.columns)
    codec = codecs.codec(f"exact:level={level},chunk=1")
    encoded = codec.encode(few.main)
    assert len(encoded.chunks) == 20
    for chunk in encoded.chunks:
        row = codec.decode(encoded.header, [chunk], few.columns)
        assert row.tobytes() == few.values[chunk.first : chunk.first + 1].tobytes()
        assert len(chunk.payload) < 4 * few.values.shape[1]


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("size", [1e-9, 1, 1e7])
def test_motion_on_every_line_comes_back(line: tuple[int, int], size: float, level: int) -> None:
    values = on_line(walk(300, 11, size), line)
    for exponent in (0, 16, -400):
        assert_comes_back(values, plan(11, line, exponent=exponent), level)


@pytest.mark.parametrize("line", LINES)
@given(
    bits=st.lists(st.integers(0, 2**64 - 1), min_size=6, max_size=60), level=st.sampled_from(LEVELS)
)
def test_any_bits_on_every_line_come_back(
    line: tuple[int, int], bits: list[int], level: int
) -> None:
    values = np.array(bits[: len(bits) // 3 * 3], dtype=np.uint64).view(np.float64).reshape(-1, 3)
    assert_comes_back(values, plan(3, line), level)
    assert_comes_back(values, plan(3, line, noise=2, exponent=900), level)


@given(
    numbers=st.lists(
        st.sampled_from([0.0, -0.0, 1.0, -1.0, 9.99999, 10.0, 0.1, 0.0999999, -99.9999, 100.0])
        | st.floats(-1000, 1000),
        min_size=2,
        max_size=50,
    ),
    line=st.sampled_from(LINES),
    level=st.sampled_from(LEVELS),
)
def test_numbers_around_the_ends_of_decades_come_back(
    numbers: list[float], line: tuple[int, int], level: int
) -> None:
    values = on_line(np.array(numbers).reshape(-1, 1), line)
    assert_comes_back(values, plan(1, line), level)


@pytest.mark.parametrize("level", LEVELS)
def test_decimals_beyond_the_last_place_come_back(level: int) -> None:
    line = (DECIMALS, 15)
    values = on_line(walk(20, 2), line)
    values[5:8, 0] = 2.0**62 / 1e15, -(2.0**62) / 1e15, 1e300
    assert_comes_back(values, plan(2, line), level)


@pytest.mark.parametrize("level", LEVELS)
def test_crossing_a_decade_costs_little(level: int) -> None:
    """The same motion around 50 and around 100 costs nearly the same: steps change exactly."""
    line = (SIGNIFICANT, 6)
    motion = walk(2000, 6)
    motion *= 3 / np.abs(motion).max()
    sizes = [
        len(assert_comes_back(on_line(motion + place, line), plan(6, line), level))
        for place in (50, 100)
    ]
    # Above 100 a digit is missing, in half of the frames.
    assert sizes[1] < sizes[0]


@pytest.mark.parametrize("level", LEVELS)
def test_rounding_noise_costs_less_than_its_digits(level: int) -> None:
    random = np.random.default_rng(5)
    radians = (2 * random.integers(-2000, 2000, (500, 2)) + 1) * 2.0**-60
    values = on_line(np.degrees(radians), (SIGNIFICANT, 6))
    payload = assert_comes_back(values, plan(2, (SIGNIFICANT, 6), noise=2), level)
    assert len(payload) < values.size * 16 / 8


@pytest.mark.parametrize("level", LEVELS)
def test_resting_channels_cost_next_to_nothing(level: int) -> None:
    values = np.zeros((4000, 4))
    values[:40] = on_line(walk(40, 4), (DECIMALS, 4))
    payload = assert_comes_back(values, plan(4, (DECIMALS, 4)), level)
    assert len(payload) < 1000


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("noise", [0, 1])
def test_payloads_of_a_wrong_length_are_found_out(level: int, noise: int) -> None:
    line = (SIGNIFICANT, 6)
    values, told = on_line(walk(12, 4), line), plan(4, line, noise)
    payload = payload_of(values, told, level)
    wrong = [payload[:length] for length in range(len(payload))]
    wrong += [payload + bytes(more) for more in range(1, 9)]
    for broken in wrong:
        with pytest.raises(ValueError, match="does not decode"):
            decoded(broken, values.shape, told, level)


def test_levels_are_not_mixed_up(samples: Path) -> None:
    """The header says at which level a clip is coded, whatever the parameters say."""
    clip = mp.read(samples / "freebvh.bvh")
    for coded in (1, 6):
        encoded = codecs.codec(f"exact:level={coded}").encode(clip.main)
        for level in (1, 3, 9):
            codec = codecs.codec(f"exact:level={level}")
            back = codec.decode(encoded.header, encoded.chunks, clip.columns)
            assert back.tobytes() == clip.values.tobytes()


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("line", LINES)
def test_the_second_reader_agrees(line: tuple[int, int], level: int) -> None:
    values = on_line(walk(60, 10, 3), line)
    values[20:30, 3] = 0
    values[40, 5], values[50, 6] = np.inf, 123456
    payload = assert_comes_back(values, plan(10, line), level)
    found = exact_fast.decode(payload, 60, [Column(Line(*line))] * 10, [], level)
    assert np.array(found).tobytes() == values.tobytes()
