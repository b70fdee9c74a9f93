"""DiffMA as published: Listing 2, Theorems 2.1 and 2.2, and the literal algorithms, bit for bit."""

import math
from fractions import Fraction
from pathlib import Path

import diffma_reference as reference
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core, codecs
from mocapress.codecs.diffma import Coding, DiffMA, Plan
from mocapress.codecs.diffma.allocation import psnr
from mocapress.errors import ParameterError

LISTING_1 = [[1.0, 1, 1, 1, 1], [0.0, 1, 2, 3, 4], [0.0, 0.0952, 0.1904, 0.285599, 0.380799]]

values = st.floats(-1e3, 1e3) | st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e300, -1e300, 5e-324])
walks = st.lists(st.floats(-1, 1), max_size=200).map(lambda steps: np.cumsum(steps).tolist())


def encode(
    x: list[float],
    *,
    n: int = 6,
    w: int = 64,
    beta: float = 4.0,
    order: int = 0,
    tau: float = 10.0,
    offset: float = 0.5,
    max_error: float = math.inf,
    spare_signs: bool = False,
) -> tuple[str, list[float]]:
    opcodes, table, squared_error = _core.diffma_encode(
        np.array(x, dtype=np.float64), n, w, beta, order, tau, offset, max_error, spare_signs
    )
    assert squared_error >= 0
    return opcodes.decode("ascii"), table.tolist()


def decode(
    b: str,
    t: list[float],
    frames: int,
    *,
    n: int = 6,
    w: int = 64,
    beta: float = 4.0,
    order: int = 0,
) -> list[float]:
    decoded = np.empty(frames)
    _core.diffma_decode(b.encode(), np.array(t, dtype=np.float64), decoded, n, w, beta, order)
    found: list[float] = decoded.tolist()
    return found


def bits(numbers: list[float]) -> bytes:
    return np.array(numbers, dtype=np.float64).tobytes()


def test_listing_1_gives_listing_2() -> None:
    coded = [encode(x, beta=2.0, offset=0.0) for x in LISTING_1]
    assert [b for b, _ in coded] == ["2222", "1ZZZ", "1ZYa"]
    assert [t for _, t in coded] == [[1], [0, 1], [0, 0.0952]]


@given(
    n=st.integers(1, 12),
    power=st.integers(1, 12),
    w=st.integers(1, 70),
    alpha=st.integers(-(2**16), 2**16),
    gamma=st.integers(-(2**16), 2**16),
    scale=st.integers(-20, 4),
    length=st.integers(1, 150),
)
def test_linear_lists_are_coded_as_the_theorems_say(
    n: int, power: int, w: int, alpha: int, gamma: int, scale: int, length: int
) -> None:
    """Theorems 2.1 and 2.2, in doubles: dyadic numbers, of which no operation rounds."""
    k = min(n, power)
    x = [(alpha * j + gamma) * 2.0**scale for j in range(length)]
    b, t = encode(x, n=n, w=w, beta=2.0**k, tau=math.inf)
    apx = reference.APX + 2 ** (n - k)
    expected = [reference.EQL] * (length - 1)
    if alpha and length > 1:
        start = [reference.RAW] if alpha > 0 else [reference.NEG, reference.RAW]
        expected = start + [apx] * (length - 2)
    assert b == reference.text(expected, n)
    assert t == x[: 2 if alpha else 1]
    assert decode(b, t, length, n=n, w=w, beta=2.0**k) == x


@given(
    n=st.integers(1, 8),
    power=st.integers(1, 8),
    w=st.integers(1, 9),
    alpha=st.fractions(),
    gamma=st.fractions(),
    length=st.integers(1, 30),
)
def test_the_theorems_hold_for_all_fractions(
    n: int, power: int, w: int, alpha: Fraction, gamma: Fraction, length: int
) -> None:
    """In exact arithmetic, as they are stated."""
    k = min(n, power)
    x = [alpha * j + gamma for j in range(length)]
    half = Fraction(1, 2)
    b, t = reference.encode(x, Fraction(2**k), math.inf, n, w, half)
    assert t == x[: 2 if alpha else 1]
    assert b.count(reference.APX + 2 ** (n - k)) == (max(length - 2, 0) if alpha else 0)
    assert reference.decode(b, t, Fraction(2**k), n, w) == x


@pytest.mark.parametrize("n", [1, 2, 6])
def test_the_theorem_does_not_hold_for_k_0(n: int) -> None:
    """A slip of the paper: q = 2^n is no opcode, so that every sample goes to the table."""
    x = [Fraction(j) for j in range(10)]
    b, t = reference.encode(x, Fraction(1), math.inf, n, 64, Fraction(1, 2))
    assert b == [reference.RAW] * 9
    assert t == x
    assert encode([float(j) for j in range(10)], n=n, beta=1.0)[0] == "1" * 9


def test_the_sign_is_told_before_an_equal_value_too() -> None:
    """d = 0 counts as +: falling, resting, falling takes three NEGs."""
    assert encode([3.0, 2.0, 2.0, 1.0], beta=2.0)[0][:5] == "01020"


def test_tolerance_is_strict() -> None:
    x = [0.0, 64.0, 64.0 + 64.0 * 33 / 64 + 0.5]  # half a step of 1 beside APX(33)
    assert encode(x, beta=1.0, offset=0.0, tau=0.5)[0] == "11"
    assert encode(x, beta=1.0, offset=0.0, tau=0.50001)[0] == "1a"


def test_an_all_zero_window_has_mean_zero_and_no_error_is_left() -> None:
    x = [0.0, 0.1, 0.2, 0.3, 1e9] + [7.3] * 200 + [7.4]
    assert encode(x)[0].endswith("2" * 199 + "1")  # the mean is exactly 0: no APX can follow


@given(
    x=st.lists(values, max_size=100) | walks,
    n=st.integers(1, 12),
    w=st.integers(1, 70),
    beta=st.floats(0.01, 300),
    offset=st.floats(0, 1),
    order=st.integers(0, 7),
    tau=st.sampled_from([0.01, 10.0, math.inf]),
    max_error=st.sampled_from([0.0, 0.02, math.inf]),
)
def test_the_core_is_the_literal_algorithm(
    x: list[float],
    n: int,
    w: int,
    beta: float,
    offset: float,
    order: int,
    tau: float,
    max_error: float,
) -> None:
    b, t = encode(x, n=n, w=w, beta=beta, offset=offset, order=order, tau=tau, max_error=max_error)
    literal_b, literal_t = reference.encode(x, beta, tau, n, w, offset, order, max_error)
    assert b == reference.text(literal_b, n)
    assert bits(t) == bits([float(v) for v in literal_t])
    decoded = decode(b, t, len(x), n=n, w=w, beta=beta, order=order)
    literal = reference.decode(literal_b, literal_t, beta, n, w, order)
    assert bits(decoded) == bits([float(v) for v in literal])
    assert all(abs(a - b) < max(tau, 1e-300) for a, b in zip(x, decoded, strict=True))
    assert all(abs(a - b) <= max_error for a, b in zip(x, decoded, strict=True))


@pytest.mark.parametrize("order", range(8))
def test_polynomials_of_one_degree_more_are_lossless(order: int) -> None:
    x = [float(sum((j - 5) ** d * (d + 1) for d in range(order + 2))) for j in range(40)]
    b, t = encode(x, beta=4.0, order=order)
    assert len(t) == order + 2
    assert len(set(b[-(40 - order - 2) :])) == 1  # equal opcodes at the tail
    assert decode(b, t, 40, order=order) == x


@given(x=walks, beta=st.floats(0.1, 100))
def test_spared_signs_decode_to_the_same(x: list[float], beta: float) -> None:
    b, t = encode(x, beta=beta)
    spared, same = encode(x, beta=beta, spare_signs=True)
    assert t == same
    assert len(spared) <= len(b)
    assert decode(b, t, len(x), beta=beta) == decode(spared, t, len(x), beta=beta)


@pytest.mark.parametrize("threads", [1, 5])
def test_threads_change_nothing(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: threads)
    random = np.random.default_rng(1)
    channels = np.cumsum(random.normal(size=(7, 30_000)), axis=1)
    plans = [Plan(4.0)] * 7
    records = Coding().encode(channels, plans)
    for channel, record in zip(channels, records, strict=True):
        b, t = encode(channel.tolist())
        assert (record.opcodes.decode(), record.table.tolist()) == (b, t)
    decoded = Coding().decode(records, plans, 30_000)
    assert decoded[6].tolist() == decode(
        records[6].opcodes.decode(), records[6].table.tolist(), 30_000
    )


@pytest.fixture(scope="module")
def clip(samples: Path) -> mp.Clip:
    whole = mp.read(samples / "cmu_01_01.amc")
    return whole[:900]


def error_of(text: str, clip: mp.Clip) -> tuple[NDArray[np.float64], int]:
    codec = codecs.codec(text)
    encoded = codec.encode(clip.main)
    decoded = codec.decode(encoded.header, encoded.chunks, clip.columns)
    return decoded - clip.values, sum(len(chunk.payload) for chunk in encoded.chunks)


def decibels(error: NDArray[np.float64]) -> float:
    return psnr(float((error**2).sum()), error.size)


def test_the_squared_error_is_that_of_the_decoded_values(clip: mp.Clip) -> None:
    channels = np.ascontiguousarray(clip.values.T)
    plans = [Plan(8.0)] * len(channels)
    records = Coding().encode(channels, plans)
    errors = ((Coding().decode(records, plans, clip.frames) - channels) ** 2).sum(axis=1)
    assert [record.squared_error for record in records] == pytest.approx(errors.tolist())
    assert errors.sum() > 0


def test_errors_are_limited_for_all_channels_or_some(clip: mp.Clip) -> None:
    error, _ = error_of("diffma:bound=32,max_error=0.05", clip)
    assert np.abs(error).max() <= 0.05
    error, _ = error_of(
        "diffma:bound=32,max_error=0.5,max_errors=root.t?:0.001/lowerback.*:0", clip
    )
    assert np.abs(error[:, :3]).max() <= 0.001
    assert not error[:, 6:9].any()
    assert 0.05 < np.abs(error).max() <= 0.5


def test_own_bounds_meet_the_target_in_fewer_bytes(clip: mp.Clip) -> None:
    shared, size = error_of("diffma:target_psnr=40", clip)
    assert abs(decibels(shared) - 40) < 3.5  # bounds are an octave, 6 dB, apart
    own, less = error_of("diffma:target_psnr=40,per=channel,chunk=1000", clip)
    assert 40 <= decibels(own) < 40.1
    assert less < size
    assert decibels(error_of("diffma:target_psnr=150,per=channel,chunk=1000", clip)[0]) >= 150


def test_the_half_of_equation_2_2_is_worth_6_db(clip: mp.Clip) -> None:
    """Listing 2 has none, the tables of the paper can only have been made with it."""
    rounded, _ = error_of("diffma", clip)
    cut_off, _ = error_of("diffma:round_offset=0", clip)
    assert 5 < decibels(rounded) - decibels(cut_off) < 7


def test_a_largest_error_alone_chooses_bounds_too(clip: mp.Clip) -> None:
    error, size = error_of("diffma:max_error=0.1,per=channel", clip)
    assert np.abs(error).max() <= 0.1
    assert all(size < error_of(f"diffma:max_error=0.1,bound={b}", clip)[1] for b in (1, 4, 16, 64))


def test_orders_are_chosen_where_they_save(clip: mp.Clip) -> None:
    parabola = clip.with_values(np.arange(900.0)[:, None] ** 2 * np.ones(62))
    error, size = error_of("diffma:order=auto", parabola)
    assert not error.any()
    assert size < error_of("diffma", parabola)[1]


def test_nan_and_infinities_stay_in_mcz(clip: mp.Clip) -> None:
    values = clip.values.copy()
    values[10:20, 3] = [math.nan, math.inf, -math.inf, 1, 2, math.nan, 3, 1e308, -1e308, 0]
    own = DiffMA(target_psnr=40, per="channel", tolerance=math.inf)
    for codec in (DiffMA(), own, DiffMA(order="auto")):
        encoded = codec.encode(clip.with_values(values).main)
        decoded = codec.decode(encoded.header, encoded.chunks, clip.columns)
        assert np.array_equal(np.isnan(decoded), np.isnan(values))
        assert np.array_equal(np.isinf(decoded), np.isinf(values))


@pytest.mark.parametrize(
    "wrong",
    [
        "bits=0",
        "bits=13",
        "window=0",
        "bound=0",
        "bound=nan",
        "bound=inf",
        "tolerance=0",
        "tolerance=nan",
        "round_offset=2",
        "max_error=-1",
        "max_error=nan",
        "max_errors=0.5",
        "max_errors=root.tx:x",
        "target_psnr=nan",
        "per=joint,target_psnr=40",
        "per=channel",
        "order=8",
        "order=x",
        "levels=16/x",
        "chunk=0",
    ],
)
def test_wrong_parameters_are_errors(wrong: str) -> None:
    with pytest.raises(ParameterError) as caught:
        codecs.codec(f"diffma:{wrong}")
    assert caught.value.expected
