"""A duration never changes unasked, and nobody assumes a rate in silence."""

import warnings
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.columns import skeleton_columns

SKELETON = Skeleton((Joint("hips", -1, channels=("tx", "ty", "tz", "rz", "ry", "rx")),))
VALUES = np.arange(24.0).reshape(4, 6)


def clip_of(frame_time: Decimal | Fraction | None) -> Clip:
    return Clip.of(VALUES, skeleton_columns(SKELETON), frame_time, SKELETON)


def amc(header: str) -> bytes:
    rows = "".join(f"{i}\nroot 1 2 3 4 5 6\n" for i in range(1, 5))
    return f":FULLY-SPECIFIED\n:DEGREES\n{header}{rows}".encode()


rates = st.integers(24, 240).map(lambda rate: Fraction(1, rate))
# As files have them: .0083333, 0.016667, .04166666
frame_times = st.tuples(st.integers(24, 240), st.integers(4, 16)).map(
    lambda made: Decimal(f"{1 / made[0]:.{made[1]}f}")
)
ntsc = st.sampled_from([Fraction(1001, 24000), Fraction(1001, 30000), Fraction(1001, 60000)])


@given(rates | frame_times | ntsc, st.lists(st.sampled_from([".amc", ".bvh"]), max_size=5))
@example(Decimal("0.0070"), [".amc", ".amc", ".bvh"])
def test_a_duration_survives_all_ways_through_files(
    tmp_path_factory: pytest.TempPathFactory, frame_time: Decimal | Fraction, suffixes: list[str]
) -> None:
    folder = tmp_path_factory.mktemp("ways")
    clip = clip_of(frame_time)
    for number, suffix in enumerate(suffixes):
        mp.write(clip, folder / f"{number}{suffix}")
        clip = mp.read(folder / f"{number}{suffix}")
    assert clip.frame_time is not None
    assert abs(Fraction(clip.frame_time) / Fraction(frame_time) - 1) < Fraction(1, 10**16)
    if isinstance(frame_time, Decimal) and suffixes[-1:] == [".bvh"]:
        assert clip.frame_time == frame_time


@pytest.mark.parametrize("stated", ["60", "60.0", "6e1", " \t60 "])
def test_an_amc_may_state_its_rate(tmp_path: Path, stated: str) -> None:
    file = tmp_path / "a.amc"
    file.write_bytes(amc(f":SAMPLES-PER-SECOND {stated}\n"))
    assert mp.read(file).frame_time == Fraction(1, 60)
    file.write_bytes(amc(f":samples-per-second {stated}\r\n"))
    assert mp.read(file).frame_time == Fraction(1, 60)


@pytest.mark.parametrize("stated", ["", "x", "0", "-60", "nan", "inf", "1e999999999", "1e-999999"])
def test_what_is_no_rate_says_nothing(tmp_path: Path, stated: str) -> None:
    file = tmp_path / "a.amc"
    file.write_bytes(amc(f":SAMPLES-PER-SECOND {stated}\n"))
    assert mp.read(file).frame_time is None


def test_whole_rates_are_written_as_such(tmp_path: Path) -> None:
    mp.write(clip_of(Fraction(1, 60)), tmp_path / "a.amc")
    assert b"\n:SAMPLES-PER-SECOND 60\n" in (tmp_path / "a.amc").read_bytes()
    mp.write(clip_of(Decimal("0.04")), tmp_path / "b.amc")
    assert b"\n:SAMPLES-PER-SECOND 25\n" in (tmp_path / "b.amc").read_bytes()
    mp.write(clip_of(None), tmp_path / "c.amc")
    assert b"SAMPLES" not in (tmp_path / "c.amc").read_bytes()


def test_a_rate_is_assumed_with_a_warning_only(tmp_path: Path) -> None:
    clip = clip_of(None)
    with pytest.warns(mp.MotionWarning, match="120 frames per second are assumed") as caught:
        mp.write(clip, tmp_path / "a.bvh")
    assert caught[0].filename == __file__
    with pytest.warns(mp.MotionWarning, match="120 frames per second are assumed") as caught:
        assert mp.to_bvh_clip(clip).frame_time == Fraction(1, 120)
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mp.write(clip, tmp_path / "b.bvh", fps=50)
        mp.write(clip, tmp_path / "b.amc", fps=50)
    assert mp.read(tmp_path / "a.bvh").frame_time == Decimal("0.00833333333333333333")
    assert mp.read(tmp_path / "b.bvh").frame_time == Decimal("0.02")
    assert mp.read(tmp_path / "b.amc").frame_time == Fraction(1, 50)


@pytest.mark.parametrize("fps", [0, -1, float("nan"), float("inf")])
def test_rates_that_are_none(tmp_path: Path, fps: float) -> None:
    with pytest.raises(mp.ParameterError, match="fps; expected a number above 0"):
        mp.write(clip_of(None), tmp_path / "a.bvh", fps=fps)
    assert not list(tmp_path.iterdir())


slices = st.tuples(
    *[st.none() | st.integers(-9, 9)] * 2, st.none() | st.integers(-9, 9).filter(bool)
).map(lambda parts: slice(*parts))


@given(slices, rates | frame_times)
def test_a_slice_takes_frames_and_their_time(frames: slice, time: Decimal | Fraction) -> None:
    clip = clip_of(time)
    part = clip[frames]
    np.testing.assert_array_equal(part.values, clip.values[frames])
    assert part.frame_time == time * abs(frames.step or 1)
    assert (part.skeleton, part.columns) == (clip.skeleton, clip.columns)
    assert clip_of(None)[frames].frame_time is None


@given(slices)
def test_loading_some_frames_is_a_slice_of_all(samples: Path, frames: slice) -> None:
    blob = mp.compress(samples / "freebvh.bvh")
    part, whole = mp.load(blob, frames=frames), mp.load(blob)[frames]
    np.testing.assert_array_equal(part.values, whole.values)
    assert part.frame_time == whole.frame_time


def test_other_frames_need_another_way_than_other_values() -> None:
    clip = clip_of(Fraction(1, 60))
    with pytest.raises(ValueError, match="2 frames of values for a clip of 4"):
        clip.with_values(clip.values[::2])
    assert clip.with_frames(clip.values[::2], Fraction(1, 30)).frame_time == Fraction(1, 30)


def test_one_frame_is_a_slice_too(samples: Path) -> None:
    file = samples / "freebvh.bvh"
    clip = mp.read(file)
    with pytest.raises(TypeError, match=r"clip\[10:11\]"):
        clip[10]  # type: ignore[call-overload]
    with pytest.raises(mp.ParameterError, match="slice"):
        mp.load(mp.compress(file), frames=10)  # type: ignore[arg-type]


def test_a_clip_is_shown_in_a_line(samples: Path) -> None:
    shown = repr(mp.read(samples / "freebvh.bvh"))
    assert "69 frames x 168 channels" in shown
    assert "55 joints" in shown
    assert len(shown) < 120


@pytest.mark.parametrize("suffix", [".amc", ".bvh"])
@pytest.mark.parametrize("fps", [1e300, 1e-300])
def test_an_absurd_rate_is_not_written(tmp_path: Path, suffix: str, fps: float) -> None:
    with pytest.raises(mp.UnsupportedError, match="frame time"):
        mp.write(clip_of(None), tmp_path / f"a{suffix}", fps=fps)
    assert not list(tmp_path.iterdir())
