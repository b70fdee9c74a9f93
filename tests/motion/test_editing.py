"""Clips as arrays of time, and clips made from clips."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.motion.statistics import statistics

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.fixture(scope="module")
def walk() -> mp.Clip:
    return mp.retime(mp.read(SAMPLES / "cmu_01_01.amc"), 120)[:400]


@pytest.fixture(scope="module")
def bvh() -> mp.Clip:
    return mp.read(SAMPLES / "mocapbank.bvh")


def test_a_clip_is_an_array_of_time(walk: mp.Clip) -> None:
    assert len(walk) == 400
    assert walk.fps == 120
    assert walk.duration == pytest.approx(400 / 120)
    assert walk.times[-1] == pytest.approx(399 / 120)
    assert (walk["root.tx"] == walk.values[:, 0]).all()
    assert walk.joint("root").shape == (400, 6)
    assert walk[:0]
    with pytest.raises(KeyError, match=r"root\.tx"):
        walk["root.tz2"]
    with pytest.raises(KeyError):
        walk.joint("nobody")
    with pytest.raises(ValueError, match="retime"):
        _ = mp.read(SAMPLES / "cmu_01_01.amc").times


def test_a_skeleton_names_its_joints(walk: mp.Clip) -> None:
    skeleton = walk.skeleton
    assert skeleton is not None
    assert skeleton.names[skeleton.index("lfemur")] == "lfemur"
    assert skeleton.parents[0] == -1
    with pytest.raises(KeyError):
        skeleton.index("tail")


def test_parts_joined_are_the_whole(walk: mp.Clip, bvh: mp.Clip) -> None:
    whole = mp.concat([walk[:150], walk[150:151], walk[151:]])
    assert np.array_equal(whole.values, walk.values)
    with pytest.raises(mp.ParameterError, match="columns"):
        mp.concat([walk, bvh])
    with pytest.raises(mp.ParameterError, match="frame time"):
        mp.concat([walk, mp.retime(walk, 60)])
    with pytest.raises(mp.ParameterError):
        mp.concat([])


@pytest.mark.parametrize("name", ["walk", "bvh"])
def test_half_the_rate_is_every_second_frame(name: str, request: pytest.FixtureRequest) -> None:
    clip = request.getfixturevalue(name)
    slower = mp.resample(clip, float(Fraction(1) / Fraction(clip.frame_time) / 2))
    assert np.array_equal(slower.values, clip[::2].values)
    assert slower.duration == pytest.approx(clip.duration, abs=float(clip.frame_time))


@pytest.mark.parametrize("name", ["walk", "bvh"])
def test_frames_between_lie_between(name: str, request: pytest.FixtureRequest) -> None:
    clip = request.getfixturevalue(name)[:60]
    finer = mp.resample(clip, 2 * (clip.fps or 0))
    assert np.array_equal(finer.values[::2], clip.values)
    turns = mp.rotations(finer)
    cosine = np.abs((turns[:-1] * turns[1:]).sum(axis=2))
    steps = np.degrees(2 * np.arccos(np.clip(cosine, 0, 1)))
    root = steps[: 2 * (len(clip) - 1), 0].reshape(-1, 2)
    assert np.allclose(root[:, 0], root[:, 1], atol=1e-4)  # the root turns at a constant speed
    places = mp.positions(finer)
    jumps = np.abs(np.diff(places, axis=0)).max()
    assert jumps <= np.abs(np.diff(mp.positions(clip), axis=0)).max()


def test_a_rotation_goes_the_short_way_round(bvh: mp.Clip) -> None:
    c = next(i for i, column in enumerate(bvh.columns) if column.kind == "ry")
    values = bvh.values[:2].copy()
    values[:, c] = 179, -179
    clip = bvh[:2].with_values(values)
    middle = mp.resample(clip, 2 * (clip.fps or 0)).values[1, c]
    assert abs(middle) == pytest.approx(180, abs=1)


def test_what_cannot_be_resampled(walk: mp.Clip) -> None:
    with pytest.raises(mp.UnsupportedError, match="rate"):
        mp.resample(mp.read(SAMPLES / "cmu_01_01.amc"), 60)
    for fps in (0, -1, float("nan"), float("inf")):
        with pytest.raises(mp.ParameterError):
            mp.resample(walk, fps)
    assert mp.resample(walk[:1], 30).values.tolist() == walk[:1].values.tolist()
    assert len(mp.resample(walk[:0], 30)) == 0
    values = walk.values[:10].copy()
    values[4, :8] = np.nan
    holes = mp.resample(walk[:10].with_values(values), 240)
    assert np.isnan(holes.values[7:10, :6]).all()
    assert np.isfinite(holes.values[[6, 10]]).all()


@pytest.mark.parametrize("name", ["walk", "bvh"])
def test_a_mirror_image_has_mirrored_positions(name: str, request: pytest.FixtureRequest) -> None:
    clip = request.getfixturevalue(name)[:50]
    skeleton = clip.skeleton
    image = mp.mirror(clip)
    names = [joint.lower() for joint in skeleton.names]
    pairs = [
        (i, names.index(other))
        for i, joint in enumerate(names)
        if (other := joint.replace("left", "right")) != joint and other in names
    ] or [(skeleton.index(f"l{bone}"), skeleton.index(f"r{bone}")) for bone in ("femur", "hand")]
    here, there = mp.positions(clip), mp.positions(image)
    for left, right in pairs:
        assert np.allclose(there[:, right] * [-1, 1, 1], here[:, left], atol=1e-9)
    assert np.allclose(mp.mirror(image).values, clip.values)


def test_what_has_no_mirror_image(walk: mp.Clip) -> None:
    alone = mp.read(b":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3\n")
    with pytest.raises(mp.UnsupportedError, match="skeleton"):
        mp.mirror(alone)


def test_differences_are_those_of_values_and_positions(walk: mp.Clip) -> None:
    assert mp.compare(walk, walk).psnr == float("inf")
    values = walk.values.copy()
    values[7, 0] += 0.5
    found = mp.compare(walk, walk.with_values(values))
    assert found.most == pytest.approx(0.5)
    assert found.largest.argmax() == 0
    assert found.largest_distance is not None
    assert np.allclose(found.largest_distance, 0.5)
    values[3, 4] = np.nan
    assert mp.compare(walk, walk.with_values(values)).largest[4] == float("inf")
    with pytest.raises(mp.ParameterError, match="frames"):
        mp.compare(walk, walk[:10])
    with pytest.raises(mp.ParameterError, match="channels"):
        mp.compare(walk, mp.read(SAMPLES / "mocapbank.bvh"))


def test_statistics_count_what_is_missing(walk: mp.Clip) -> None:
    values = walk.values.copy()
    values[:3, 1] = np.nan
    rows = statistics(walk.with_values(values))["channels"]
    assert [row["missing"] for row in rows[:3]] == [0, 3, 0]
    assert rows[0]["low"] == walk["root.tx"].min()
    joints = statistics(walk)["joints"]
    assert joints[0]["name"] == "root"
    assert joints[0]["way"] > 0
    assert statistics(walk[:0])["joints"] == []
