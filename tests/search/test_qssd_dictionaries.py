"""Dictionaries of poses as signatures: what makes clips alike, and what must not."""

from itertools import permutations

import numpy as np
import pytest
from numpy.typing import NDArray

from mocapress.codecs.qssd.quaternions import conjugate, exponential, product, turned_degrees
from mocapress.motion.standard_joints import JOINTS
from mocapress.search.qssd import bone_turns, dictionary_of, distances, mirrored

Array = NDArray[np.float64]


def swing(seed: int, frames: int = 40, joints: int = 6) -> Array:
    """Turns of joints, each to and fro about an axis of its own."""
    random = np.random.default_rng(seed)
    axes = random.normal(size=(3, joints, 3)) * 0.3
    waves = np.sin(np.linspace(0, 6, frames)[:, None] * (1, 2, 3) + 0.4 * random.normal(size=3))
    return exponential(np.einsum("fk,kjc->fjc", waves, axes))


@pytest.mark.parametrize("sums", [False, True])
def test_a_clip_is_nearest_to_itself_and_to_itself_slower(sums: bool) -> None:
    clips = [swing(seed) for seed in range(5)]
    own = np.array([dictionary_of(clip, sums=sums) for clip in clips])
    slower = dictionary_of(np.repeat(clips[2], 2, axis=0), sums=sums)
    assert distances(own[2], own)[2] == pytest.approx(0, abs=1e-9)
    assert distances(slower, own).argmin() == 2
    assert distances(own[2], own, dots=True).argmin() == 2


def test_what_a_joint_turns_from_does_not_count() -> None:
    """Only displacements from a reference pose are decomposed: section 4.2 of the paper."""
    clip = swing(1)
    bent = product(exponential(np.full((1, 6, 3), 0.4)), clip)
    assert dictionary_of(bent) == pytest.approx(dictionary_of(clip), abs=1e-9)
    assert dictionary_of(bent, first=True) == pytest.approx(dictionary_of(clip, first=True))
    assert (dictionary_of(clip, first=True) != dictionary_of(clip)).any()


def test_atoms_are_assigned_so_that_the_sum_is_least() -> None:
    random = np.random.default_rng(3)
    first, *others = random.normal(size=(4, 4, 2, 3))
    found = distances(first, np.array(others))
    for value, other in zip(found, others, strict=True):
        costs = 1 - np.abs(np.einsum("kjc,ljc->kl", first, other))
        best = min(
            sum(costs[i, p] for i, p in enumerate(order)) for order in permutations(range(4))
        )
        assert value == pytest.approx(best)


def test_signs_and_order_of_atoms_do_not_count() -> None:
    own = dictionary_of(swing(0))
    assert distances(own, -own[None, ::-1]) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("frames", [1, 3])
def test_still_and_short_clips_have_dictionaries_of_nothing(frames: int) -> None:
    still = np.broadcast_to(swing(0)[:1], (frames, 6, 4))
    own = dictionary_of(still)
    assert own.shape == (5, 6, 3)
    assert not own.any()
    assert distances(own, np.array([own, dictionary_of(swing(1))])) == pytest.approx([5, 5])


def test_a_seed_begins_as_published() -> None:
    clip = swing(2)
    assert (dictionary_of(clip, seed=1) == dictionary_of(clip, seed=1)).all()
    assert (dictionary_of(clip, seed=1) != dictionary_of(clip, seed=2)).any()


def test_bones_turn_from_their_mean_direction() -> None:
    elbow, wrist = JOINTS.index("left_elbow"), JOINTS.index("left_wrist")
    places = np.zeros((3, 16, 3))
    places[:, :, 1] = np.arange(16)
    angles = np.radians([-50, 0, 50])
    places[:, wrist] = places[:, elbow] + 2 * np.stack(
        [np.cos(angles), np.sin(angles), 0 * angles], axis=-1
    )
    turns = bone_turns(places)
    assert np.linalg.norm(turns, axis=-1) == pytest.approx(1)
    still = np.array([1.0, 0, 0, 0])
    assert turned_degrees(turns[:, wrist - 1], still) == pytest.approx([50, 0, 50], abs=1e-6)
    vectors = np.pad(places[:, wrist] - places[:, elbow], [(0, 0), (1, 0)])
    own = turns[:, wrist - 1]
    back = product(product(conjugate(own), vectors), own)
    assert back[:, 1:] == pytest.approx(np.broadcast_to([2.0, 0, 0], (3, 3)))


def test_bones_without_length_and_opposite_ones_have_turns() -> None:
    places = np.zeros((3, 16, 3))
    places[:, 1, 1] = (1, 1, -1)
    turns = bone_turns(places)
    assert np.linalg.norm(turns, axis=-1) == pytest.approx(1)
    assert turned_degrees(turns[2, 0], np.array([1.0, 0, 0, 0])) == pytest.approx(180)


def test_a_mirrored_clip_has_the_mirrored_dictionary() -> None:
    random = np.random.default_rng(4)
    waves = np.sin(np.linspace(0, 6, 60)[:, None] * (1, 2))
    places = random.normal(size=(16, 3)) + np.einsum(
        "fk,kjc->fjc", waves, random.normal(size=(2, 16, 3))
    )
    order = [JOINTS.index(other(joint)) for joint in JOINTS]
    flipped = places[:, order] * (-1, 1, 1)
    own = dictionary_of(bone_turns(places))
    found = distances(dictionary_of(bone_turns(flipped)), np.array([mirrored(own), own]))
    assert found[0] == pytest.approx(0, abs=1e-6)
    assert found[1] > 0.1
    assert mirrored(mirrored(own)) == pytest.approx(own)


def other(joint: str) -> str:
    if joint.startswith("left"):
        return joint.replace("left", "right")
    return joint.replace("right", "left")
