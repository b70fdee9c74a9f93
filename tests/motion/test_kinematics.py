"""Positions and rotations: against closed forms, a literal version, and files of others."""

from pathlib import Path

import kinematics_reference as reference
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.kinematics import positions, rotations

angles = st.floats(-360, 360)
orders = st.permutations("xyz").map("".join)


def pose(skeleton: Skeleton, *rows: list[float]) -> Clip:
    return Clip.of(np.array(rows, dtype=np.float64), skeleton_columns(skeleton), None, skeleton)


def test_a_bent_arm_in_closed_form() -> None:
    arm = Skeleton(
        (
            Joint("shoulder", -1, (9, 9, 9), ("tx", "ty", "tz", "rz")),
            Joint("elbow", 0, (2, 0, 0), ("rz",), ends=((1, 0, 0),)),
        )
    )
    found = positions(pose(arm, [0, 5, 0, 90, 90]), end_sites=True)
    np.testing.assert_allclose(found[0], [[0, 5, 0], [0, 7, 0], [-1, 7, 0]], atol=1e-12)


def test_an_asf_bone_turns_about_its_own_axes() -> None:
    # The bone's x axis is the world's y axis: turning about it by 90 degrees leads z to x.
    bone = Joint("bone", 0, (0, 0, 0), ("rx",), axis=(0, 0, 90), ends=((0, 0, 3),))
    skeleton = Skeleton((Joint("root", -1), bone), "fixed")
    found = positions(pose(skeleton, [90]), end_sites=True)
    np.testing.assert_allclose(found[0, 2], [3, 0, 0], atol=1e-12)


@given(orders, st.lists(angles, min_size=6, max_size=6))
def test_bvh_channels_multiply_from_left_to_right(order: str, turns: list[float]) -> None:
    channels = tuple(f"r{axis}" for axis in order)
    skeleton = Skeleton(
        (
            Joint("a", -1, (1, 2, 3), channels),
            Joint("b", 0, (0.5, -1, 2), channels, ends=((1, 1, 1),)),
        )
    )
    check(pose(skeleton, turns))


@given(orders, st.lists(angles, min_size=12, max_size=12))
def test_asf_bones_turn_in_their_frames(order: str, turns: list[float]) -> None:
    axes = [tuple(turns[i : i + 3]) for i in (0, 3)]
    skeleton = Skeleton(
        (
            Joint("root", -1, (1, 0, 0), ("tx", "rx", "ry", "rz"), axes[0], order),  # type: ignore[arg-type]
            Joint("b", 0, (0, 0, 0), ("ry", "rz"), axes[1], order, ends=((1, 1, 1),)),  # type: ignore[arg-type]
        ),
        "fixed",
    )
    check(pose(skeleton, turns[6:]))


def check(clip: Clip, frames: list[int] | None = None) -> None:
    found, turns = positions(clip), rotations(clip)
    np.testing.assert_allclose(np.linalg.norm(turns, axis=-1), 1, atol=1e-12)
    for frame in frames or range(clip.frames):
        for j, matrix in enumerate(reference.world_of_frame(clip, frame)):
            np.testing.assert_allclose(found[frame, j], matrix[:3, 3], atol=1e-9)
            w, x, y, z = turns[frame, j]
            first_column = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
            np.testing.assert_allclose(first_column, matrix[:3, 0], atol=1e-9)


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_samples_agree_with_the_literal_version(samples: Path, name: str) -> None:
    clip = mp.read(samples / name)
    check(clip, [0, 1, clip.frames // 2, clip.frames - 1])


def test_radians_are_obeyed(samples: Path) -> None:
    degrees = mp.read(samples / "cmu_01_01.amc")
    turning = np.array([column.kind[0] == "r" for column in degrees.columns])
    values = np.where(turning, np.radians(degrees.values), degrees.values)
    assert degrees.skeleton is not None
    columns = tuple(
        type(c)(c.name, c.joint, c.kind, "rad" if c.kind[0] == "r" else c.unit)
        for c in degrees.columns
    )
    radians = Clip.of(values, columns, None, degrees.skeleton)
    np.testing.assert_allclose(positions(radians)[:9], positions(degrees)[:9], atol=1e-9)


def test_without_a_skeleton_there_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "walk.amc"
    file.write_bytes(b":DEGREES\n1\nroot 1 2 3 4 5 6\n")
    with pytest.raises(mp.UnsupportedError, match="no skeleton"):
        positions(mp.read(file))


LEGS = {
    "lhipjoint": "LHipJoint",
    "lfemur": "LeftUpLeg",
    "ltibia": "LeftLeg",
    "lfoot": "LeftFoot",
    "ltoes": "LeftToeBase",
    "rfemur": "RightUpLeg",
    "rtibia": "RightLeg",
    "rfoot": "RightFoot",
    "rtoes": "RightToeBase",
}


@pytest.mark.corpus
@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ("amc/cmu/01/01_01.amc", "bvh/fairmotion/01_01.bvh"),
        ("amc/cmu/12/12_01.amc", "bvh/bvh_pybvh/cmu_12_01_walk.bvh"),
    ],
)
def test_legs_agree_with_conversions_of_others(corpus: Path, ours: str, theirs: str) -> None:
    """Converted by others, these BVH have a T-pose as their first frame and the same legs."""
    amc, bvh = mp.read(corpus / ours), mp.read(corpus / theirs)
    assert amc.skeleton is not None
    assert bvh.skeleton is not None
    in_amc = {joint.name: i for i, joint in enumerate(amc.skeleton.joints)}
    in_bvh = {joint.name: i for i, joint in enumerate(bvh.skeleton.joints)}
    a = positions(amc)[:, [in_amc[name] for name in LEGS]]
    b = positions(bvh)[1:, [in_bvh[name] for name in LEGS.values()]]
    a, b = a - a[:, :1], b - b[:, :1]  # their root stands elsewhere
    np.testing.assert_allclose(a, b, atol=1e-3)
