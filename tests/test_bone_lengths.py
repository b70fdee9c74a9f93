"""Distances that a body keeps: found, measured after coding, and made constant again."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from running import mocapress

import mocapress as mp
from mocapress.errors import UnsupportedError

Array = NDArray[np.float64]
LENGTHS = (100.0, 250.0, 300.0, 80.0)


def chain(frames: int = 300) -> Array:
    """Give five markers, each at a constant distance from the one before; and one that is free."""
    random = np.random.default_rng(3)
    time = np.arange(frames) / 60
    places = [np.stack([200 * time, 900 + 20 * np.sin(5 * time), 0 * time], axis=1)]
    for i, length in enumerate(LENGTHS):
        a = np.sin((2 + i) * time + i)
        b = np.cos((1 + i) * time)
        way = np.stack([np.cos(a) * np.cos(b), np.sin(a), np.cos(a) * np.sin(b)], axis=1)
        places.append(places[-1] + length * way)
    free = places[0] + 500 * np.cumsum(random.normal(0, 0.05, (frames, 3)), axis=0) + 40
    return np.stack([*places, free], axis=1)


def clip_of(places: Array) -> mp.Clip:
    columns = tuple(
        mp.Column(f"m{i}.{axis}", i, axis, "mm") for i in range(places.shape[1]) for axis in "xyz"
    )
    flat = places.reshape(len(places), -1)
    return mp.Clip({"points": mp.Stream(flat, columns, Fraction(1, 60))})


def disturbed(places: Array) -> Array:
    return places + np.random.default_rng(4).normal(0, 3, places.shape)


def test_the_bones_are_the_distances_that_stay() -> None:
    found = mp.bones(clip_of(chain()))
    assert {frozenset((bone.near, bone.far)) for bone in found} >= {
        frozenset((i, i + 1)) for i in range(4)
    }
    assert not any(5 in (bone.near, bone.far) for bone in found)
    for bone in found:
        assert bone.length == pytest.approx(LENGTHS[min(bone.near, bone.far)])
        assert bone.spread < 1e-9
    # Each is behind the one that leads to it.
    reached = {found[0].near}
    for bone in found:
        assert bone.near in reached
        reached.add(bone.far)


def test_drift_is_by_how_much_lengths_are_off() -> None:
    places = chain()
    longer = places.copy()
    longer[:, 4] += 0.1 * (places[:, 4] - places[:, 3])
    away = mp.bone_drift(clip_of(places), clip_of(longer))
    own = [{bone.near, bone.far} for bone in mp.bones(clip_of(places))]
    assert away[:, own.index({3, 4})] == pytest.approx(8)
    assert np.abs(np.delete(away, own.index({3, 4}), axis=1)).max() < 1e-9


def test_lengths_are_made_constant_and_markers_stay_near() -> None:
    places = chain()
    noisy = clip_of(disturbed(places))
    known = mp.bones(clip_of(places))
    mended = mp.constant_lengths(noisy, known)
    assert np.abs(mp.bone_drift(clip_of(places), noisy)).max() > 5
    assert np.abs(mp.bone_drift(clip_of(places), mended)).max() < 1e-6
    both = [
        np.linalg.norm(mp.markers(c).positions - places, axis=2)[:, :5].mean()
        for c in (noisy, mended)
    ]
    assert both[1] < both[0]
    # Lengths are found in what is to be mended, too.
    alone = mp.constant_lengths(noisy)
    assert max(bone.spread for bone in mp.bones(alone)) < 1e-6


def test_missing_markers_are_left_alone() -> None:
    places = chain()
    places[100:120, 2] = np.nan
    places[130:140, 3] = 0
    clip = clip_of(disturbed(places))
    holes = np.array(clip.values)
    holes[130:140, 9:12] = 0
    clip = clip.with_frames(holes, clip.frame_time)
    mended = mp.constant_lengths(clip)
    assert (np.isnan(mended.values) == np.isnan(clip.values)).all()
    assert not mended.values[130:140, 9:12].any()
    assert np.isnan(mp.bone_drift(clip, mended)[100:120]).any()


def test_a_marker_that_was_hardly_seen_has_no_bones() -> None:
    places = chain()
    ghost = np.full((len(places), 1, 3), np.nan)
    ghost[50:60, 0] = places[50:60, 0] + 30
    found = mp.bones(clip_of(np.concatenate([places, ghost], axis=1)))
    assert found
    assert not any(6 in (bone.near, bone.far) for bone in found)


def test_a_clip_without_markers_has_no_bones(samples: Path) -> None:
    with pytest.raises(UnsupportedError):
        mp.bones(mp.read(samples / "freebvh.bvh"))


def test_commands_report_and_mend(tmp_path: Path) -> None:
    original, decoded = tmp_path / "original.c3d", tmp_path / "decoded.c3d"
    mp.write(clip_of(chain()), original)
    mp.write(clip_of(disturbed(chain())), decoded)
    done = mocapress("compare", original, decoded)
    assert done.exit_code == 0, done.output
    assert "length between" in done.output
    assert "m0 - m1" in done.output or "m1 - m0" in done.output
    mended = tmp_path / "mended.trc"
    done = mocapress("convert", decoded, "-o", mended, "--constant-lengths")
    assert done.exit_code == 0, done.output
    assert max(bone.spread for bone in mp.bones(mp.read(mended))) < 1e-3
