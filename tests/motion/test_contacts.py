"""Contacts: where a foot stands still on the floor, whatever the unit, the axis and the rate."""

from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.motion.contacts import slides, upward

SAMPLES = Path(__file__).parents[2] / "samples"
NAMES = ["hips", "head", "left_foot", "right_foot"]


def stepping(fps: float = 60, size: float = 170.0, slide: float = 0.0) -> mp.Clip:
    """Walk along x: each foot stands for half a second and then swings for half a second."""
    seconds = np.arange(round(4 * fps)) / fps
    places = np.zeros((len(seconds), 4, 3))
    for foot, phase in ((2, 0.0), (3, 0.5)):
        steps, part = np.divmod(seconds + phase, 1.0)
        swing = np.clip(2 * part - 1, 0, 1)
        places[:, foot, 0] = 0.6 * (steps + swing) + slide * np.minimum(2 * part, 1)
        places[:, foot, 1] = 0.12 * np.sin(np.pi * swing)
    places[:, 2:, 2] = (-0.06, 0.06)
    places[:, 0] = np.stack(
        [0.6 * seconds, np.full_like(seconds, 0.55), 0.03 * np.sin(np.pi * seconds)], axis=1
    )
    places[:, 1] = places[:, 0] + (0, 0.45, 0)
    return mp.from_positions(size * places, NAMES, fps, parents=[-1, 0, 0, 0])


def truth(fps: float) -> np.ndarray:
    part = (np.arange(round(4 * fps)) / fps) % 1
    return np.stack([part <= 0.5, part >= 0.5], axis=1)


@pytest.mark.parametrize(("fps", "size"), [(30, 1.7), (60, 170), (120, 30)])
def test_a_foot_is_in_contact_while_it_stands(fps: float, size: float) -> None:
    found = stepping(fps, size).contacts()
    assert [*found] == ["left_foot", "right_foot"]
    standing = np.stack([*found.values()], axis=1)
    assert standing.dtype == bool
    assert (standing == truth(fps)).mean() > 0.93


def test_the_axis_that_points_up_is_found() -> None:
    clip = stepping()
    turned = mp.positions(clip)[..., [0, 2, 1]]
    other = mp.from_positions(turned, NAMES, 60, parents=[-1, 0, 0, 0])
    assert upward(mp.positions(clip)) == 1
    assert upward(turned) == 2
    for joint, standing in clip.contacts().items():
        assert (other.contacts()[joint] == standing).all()


def test_slides_are_what_feet_move_while_they_stand() -> None:
    for slide in (0.0, 0.02):
        clip = stepping(slide=slide)
        standing = np.stack([*clip.contacts().values()], axis=1)
        moved = slides(mp.positions(clip)[:, 2:], standing, 1)
        # 0.02 of the size in half a second of 60 frames a second.
        assert np.median(moved) == pytest.approx(170 * slide / 30, abs=1e-6)


def test_thresholds_and_joints_can_be_given() -> None:
    clip = stepping()
    assert [*clip.contacts(["head"])] == ["head"]
    assert not clip.contacts(["head"])["head"].any()
    assert clip.contacts(["head"], speed=200, height=1)["head"].all()
    with pytest.raises(mp.ParameterError, match="no such joint"):
        clip.contacts(["tail"])


def test_what_cannot_have_contacts_is_told() -> None:
    clip = stepping()
    with pytest.raises(mp.UnsupportedError, match="sampling rate"):
        clip.with_frame_time(None).contacts()
    assert clip.with_frame_time(None).contacts(fps=60).keys() == clip.contacts().keys()
    places = mp.positions(clip)
    snake = mp.from_positions(places, ["a", "b", "c", "d"], 60, parents=[-1, 0, 1, 2])
    with pytest.raises(mp.UnsupportedError, match="called foot"):
        snake.contacts()
    with pytest.raises(mp.UnsupportedError, match="skeleton"):
        mp.from_array(np.zeros((2, 1)), ["root.tx"], 60).contacts()


@pytest.mark.parametrize("frames", [0, 1, 2])
def test_few_frames_and_missing_numbers_are_no_contacts_or_still_ones(frames: int) -> None:
    few = stepping()[:frames].contacts()["left_foot"]
    assert few.shape == (frames,)
    clip = stepping()
    values = clip.values.copy()
    values[30:40] = np.nan
    found = clip.with_values(values).contacts()["left_foot"]
    assert not found[30:40].any()
    assert found.any()


def test_a_recorded_walk_has_steps() -> None:
    walk = mp.read(SAMPLES / "freebvh.bvh")
    found = walk.contacts()
    assert found
    assert all(0.1 < standing.mean() < 1 for standing in found.values())
