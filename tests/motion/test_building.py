"""Clips from arrays, and arrays with names from clips."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mocapress as mp

SAMPLES = Path(__file__).parents[2] / "samples"
RANDOM = np.random.default_rng(5)


def test_numbers_with_names_are_a_clip(tmp_path: Path) -> None:
    values = RANDOM.normal(size=(20, 2))
    clip = mp.from_array(values, ["root.tx", "knee.rx"], 60)
    assert (clip["knee.rx"] == values[:, 1]).all()
    assert clip.columns[1].unit == "deg"
    mp.write(clip, tmp_path / "a.mcz")
    assert np.array_equal(mp.read(tmp_path / "a.mcz").values, values)
    with pytest.raises(mp.ParameterError, match="F x 3"):
        mp.from_array(values, ["a", "b", "c"])
    with pytest.raises(mp.ParameterError, match="numbers"):
        mp.from_array([["x", "y"]], ["a", "b"])
    with pytest.raises(mp.ParameterError, match="fps"):
        mp.from_array(values, ["a", "b"], 0)


def test_positions_are_those_of_joints_or_markers() -> None:
    places = RANDOM.normal(size=(10, 3, 3))
    joints = mp.from_positions(places, ["hip", "knee", "foot"], 30, parents=[-1, 0, 1])
    assert np.allclose(mp.positions(joints), places)
    markers = mp.markers(mp.from_positions(places, ["A", "B", "C"], 30))
    assert (markers.positions == places).all()
    assert markers.rate == 30
    with pytest.raises(mp.ParameterError, match="parent of joint 0"):
        mp.from_positions(places, ["a", "b", "c"], parents=[0, 0, 1])
    with pytest.raises(mp.ParameterError, match="parents"):
        mp.from_positions(places, ["a", "b", "c"], parents=[-1])


def test_rotations_make_the_clip_that_has_them(tmp_path: Path) -> None:
    walk = mp.read(SAMPLES / "mocapbank.bvh")[:30]
    assert walk.skeleton is not None
    turns = mp.rotations(walk, local=True)
    offsets = [joint.offset for joint in walk.skeleton.joints]
    built = mp.from_quaternions(
        turns,
        offsets,
        walk.skeleton.parents,
        walk.skeleton.names,
        walk.fps,
        root=mp.positions(walk)[:, 0],
    )
    assert np.allclose(mp.positions(built), mp.positions(walk), atol=1e-6)
    mp.write(built, tmp_path / "a.bvh")
    assert np.allclose(mp.positions(mp.read(tmp_path / "a.bvh")), mp.positions(walk), atol=1e-3)
    with pytest.raises(mp.ParameterError, match="unit quaternions"):
        mp.from_quaternions(2 * turns, offsets, walk.skeleton.parents, walk.skeleton.names)


def test_forms_of_rotations_are_the_same_turns() -> None:
    walk = mp.read(SAMPLES / "mocapbank.bvh")[:20]
    turns = Rotation.from_quat(np.roll(mp.rotations(walk).reshape(-1, 4), -1, axis=1))
    matrices = mp.rotations(walk, form="matrix")
    assert np.allclose(matrices.reshape(-1, 3, 3), turns.as_matrix())
    six = mp.rotations(walk, form="6d")
    assert np.allclose(six[..., :3], matrices[..., 0])
    assert np.allclose(six[..., 3:], matrices[..., 1])
    angles = mp.rotations(walk, form="zyx")
    again = Rotation.from_euler("ZYX", angles.reshape(-1, 3), degrees=True)
    assert np.allclose((again * turns.inv()).magnitude(), 0, atol=1e-7)
    for form in ("xx", "xyx2", "euler", "xyy"):
        with pytest.raises(mp.ParameterError, match="form"):
            mp.rotations(walk, form=form)


def test_velocities_are_per_second() -> None:
    places = np.zeros((5, 1, 3))
    places[:, 0, 0] = np.arange(5) * 0.5
    clip = mp.from_positions(places, ["root"], 10, parents=[-1])
    assert np.allclose(mp.velocities(clip)[:, 0], [5, 0, 0])
    assert np.allclose(mp.velocities(clip[:1]), 0)
    with pytest.raises(mp.UnsupportedError, match="rate"):
        mp.velocities(mp.from_positions(places, ["root"], parents=[-1]))


def test_a_time_is_cut_out() -> None:
    walk = mp.read(SAMPLES / "mocapbank.bvh")
    part = mp.crop(walk, 0.5, 1.0)
    assert np.array_equal(part.values, walk[15:30].values)
    assert len(mp.crop(walk, 1.0)) == len(walk) - 30
    with pytest.raises(mp.UnsupportedError):
        mp.crop(mp.read(SAMPLES / "cmu_01_01.amc"), 1)


def test_data_frames_have_names_and_times() -> None:
    pytest.importorskip("pandas", reason="pandas is not installed")
    walk = mp.read(SAMPLES / "mocapbank.bvh")
    frame = mp.to_dataframe(walk)
    assert (frame[walk.columns[3].name].to_numpy() == walk.values[:, 3]).all()
    assert frame.index.name == "seconds"


def test_labelled_arrays_have_names_and_times() -> None:
    pytest.importorskip("xarray", reason="xarray is not installed")
    walk = mp.read(SAMPLES / "cmu_01_01.amc")[:10]
    array = mp.to_xarray(walk)
    assert (array.sel(channel="root.tx").to_numpy() == walk["root.tx"]).all()
    assert array.dims == ("frame", "channel")
