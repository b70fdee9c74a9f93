"""The sixteen standard joints: the same for the same motion, whatever the skeleton and the file."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from people import STYLES, named, person

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.motion import Clip, Column, Joint, Skeleton
from mocapress.motion.standard_joints import by_names, read_mapping
from mocapress.search.features import features, read_record, record
from mocapress.search.standard import standard_motion


@pytest.mark.parametrize("style", STYLES)
def test_names_of_all_systems_mean_the_same_joints(style: str) -> None:
    same = standard_motion(person(3, style=style))
    expected = standard_motion(person(3, style="LaFAN"))
    for joint in range(4, 16):
        assert same.places[:, joint] == pytest.approx(expected.places[:, joint], abs=1e-9), joint
    assert same.root == pytest.approx(expected.root, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("feet", [(), ("left_toe", "right_toe")])
def test_the_tree_tells_what_names_do(seed: int, feet: tuple[str, ...]) -> None:
    # Where there are no toes, knees say which side is left. These people bend theirs at random.
    named = person(seed, without=feet)
    skeleton = named.skeleton
    assert skeleton is not None
    knees = [
        i for i, c in enumerate(named.columns) if c.name.endswith("Leg.rx") and "Up" not in c.name
    ]
    values = named.values.copy()
    values[:, knees] = np.abs(values[:, knees]) + 10
    named = named.with_frames(values, named.frame_time)
    joints = tuple(replace(j, name=f"q{i}") for i, j in enumerate(skeleton.joints))
    unnamed = replace(named, skeleton=replace(skeleton, joints=joints))
    expected, same = standard_motion(named), standard_motion(unnamed)
    assert same.places[:, 3:] == pytest.approx(expected.places[:, 3:], abs=1e-9)


@pytest.mark.parametrize(
    ("names", "joint", "expected"),
    [
        # What twists, what pulls, and fingers are less like a joint's name than the joint is.
        ("ik_foot_l foot_l", "left_ankle", "foot_l"),
        ("thigh_twist_01_l thigh_l", "left_hip", "thigh_l"),
        ("LeftHandThumb1 LeftHand", "left_wrist", "LeftHand"),
        ("lThighBend lThighTwist", "left_hip", "lThighBend"),
        ("upperleg01.L upperleg02.L", "left_hip", "upperleg01.L"),
        ("HandRight WristRight", "right_wrist", "WristRight"),
        ("HeadTop_End Head Neck", "head", "Head"),
        ("Bip01_HeadNub Bip01_Head Neck", "head", "Bip01_Head"),
        ("Spine Neck", "head", "Neck"),
        ("leg_l_thigh leg_l_shin", "left_hip", "leg_l_thigh"),
        ("LHipJoint LeftUpLeg LeftLeg", "left_hip", "LeftUpLeg"),
    ],
)
def test_of_several_names_the_plainest_counts(names: str, joint: str, expected: str) -> None:
    skeleton = Skeleton((Joint("root", -1), *(Joint(name, 0) for name in names.split())))
    assert skeleton.names[by_names(skeleton)[joint]] == expected


def test_one_word_means_what_the_joints_around_it_leave() -> None:
    # In Japanese 腕 is the arm, in Chinese the wrist.
    for names, roles in (
        ("左腕 左ひじ 左手首", ("shoulder", "elbow", "wrist")),
        ("左肩 左肘 左腕", ("shoulder", "elbow", "wrist")),
    ):
        skeleton = Skeleton(tuple(Joint(name, i - 1) for i, name in enumerate(names.split())))
        known = by_names(skeleton)
        assert [known[f"left_{role}"] for role in roles] == [0, 1, 2]


def test_size_and_heading_and_place_do_not_count() -> None:
    one = standard_motion(person(1))
    other = standard_motion(person(1, size=0.01, turned=0))
    assert other.places == pytest.approx(one.places, abs=1e-9)
    turned = standard_motion(person(1, turned=130))
    assert turned.leg == pytest.approx(one.leg)
    assert np.linalg.norm(turned.places, axis=2) == pytest.approx(
        np.linalg.norm(one.places, axis=2), abs=1e-9
    )


def test_joined_takes_are_not_blurred_where_they_meet() -> None:
    first, second = person(1, turned=130), person(2)
    values = np.concatenate([first.values, second.values])
    values[60:, 0] += 700  # elsewhere along the floor
    joined = standard_motion(first.with_frames(values, first.frame_time))
    assert joined.cuts == (60,)
    assert joined.mirrored().cuts == (60,)
    assert joined[50:].cuts == (10,)
    assert joined[60:].cuts == joined[:60].cuts == ()
    parts = [standard_motion(first), standard_motion(second)]
    for part, own in zip(parts, (joined[:60], joined[60:]), strict=True):
        assert own.places == pytest.approx(part.places, abs=1e-9)
        assert own.heading == pytest.approx(part.heading, abs=1e-9)
        # Heights are from the lowest ankle of all, so they may differ, and what changes does not.
        assert features(own)[:, 31:] == pytest.approx(features(part)[:, 31:], abs=1e-9)
    read = read_record(record(joined))
    apart = np.concatenate([read_record(record(joined[:60])), read_record(record(joined[60:]))])
    assert np.delete(read, 30, axis=1) == pytest.approx(np.delete(apart, 30, axis=1), abs=1e-6)


def test_who_moves_without_jumps_has_no_cuts() -> None:
    assert all(standard_motion(person(seed, frames=300)).cuts == () for seed in range(8))
    assert standard_motion(person(0, frames=1)).cuts == ()


def test_the_frame_rate_does_not_count() -> None:
    slow = standard_motion(person(2, frames=61, fps=30))
    fast = standard_motion(person(2, frames=241, fps=120))
    odd = standard_motion(person(2, frames=101, fps=50))
    assert slow.frames == fast.frames == odd.frames == 61
    assert fast.places == pytest.approx(slow.places, abs=1e-9)
    assert np.abs(odd.places - slow.places).max() < 0.02


def test_hips_are_in_the_middle_and_the_lowest_ankle_stands_on_the_floor() -> None:
    motion = standard_motion(person(4))
    assert motion.places[:, 0] == pytest.approx(0)
    assert motion.places[:, 7] + motion.places[:, 13] == pytest.approx(0, abs=1e-9)
    ankles = motion.root[:, None, 1] + motion.places[:, [9, 15], 1]
    assert ankles.min() == pytest.approx(0)
    assert motion.root[0, [0, 2]] == pytest.approx(0)


def test_z_up_is_seen() -> None:
    clip = person(5)
    assert clip.skeleton is not None
    tilted = [
        replace(j, offset=(j.offset[0], -j.offset[2], j.offset[1])) for j in clip.skeleton.joints
    ]
    still = person(5, still=True)
    flat = clip.with_values(0 * still.values)
    upright = standard_motion(flat)
    lying = standard_motion(replace(flat, skeleton=Skeleton(tuple(tilted))))
    assert lying.places == pytest.approx(upright.places, abs=1e-9)


def turned_about_x(clip: Clip, degrees: float) -> Clip:
    """Hang a body below a joint that turns all of it."""
    assert clip.skeleton is not None
    joints = [replace(joint, parent=joint.parent + 1) for joint in clip.skeleton.joints]
    columns = [replace(column, joint=(column.joint or 0) + 1) for column in clip.columns]
    columns.append(Column("world.rx", 0, "rx"))
    values = np.column_stack([clip.values, np.full(clip.frames, degrees)])
    skeleton = Skeleton((Joint("world", -1, channels=("rx",)), *joints))
    return Clip.of(values, tuple(columns), clip.frame_time, skeleton)


@pytest.mark.parametrize("degrees", [90, 180, -90])
def test_bodies_are_stood_up(degrees: float) -> None:
    upright = standard_motion(person(5))
    turned = standard_motion(turned_about_x(person(5), degrees))
    assert turned.places == pytest.approx(upright.places, abs=1e-9)
    assert turned.root == pytest.approx(upright.root, abs=1e-9)


def test_who_stands_on_the_hands_is_not_turned() -> None:
    clip = person(5)
    shoulders = [
        i for i, c in enumerate(clip.columns) if re.fullmatch(".*(Left|Right)Arm.rz", c.name)
    ]
    values = clip.values * 0
    values[:, shoulders] = (90, -90)  # arms beyond the head
    handstand = standard_motion(turned_about_x(clip.with_frames(values, clip.frame_time), 180))
    assert (handstand.places[:, 3, 1] < -0.5).all()


@pytest.mark.parametrize("turned", [0, 40, 90, 250])
def test_who_crawls_crawls_wherever_the_head_is(turned: float) -> None:
    clip = person(5, turned=turned)
    (bent,) = (i for i, c in enumerate(clip.columns) if c.name == "Hips.rx")
    knees = [i for i, c in enumerate(clip.columns) if c.name.endswith("UpLeg.rx")]
    values = clip.values * 0
    values[:, bent - 1] = turned
    values[:, bent], values[:, knees] = 80, -80  # on all fours
    crawling = standard_motion(clip.with_frames(values, clip.frame_time))
    assert (crawling.places[:, 3, 2] > 0.5).all()  # the head is in front
    assert (crawling.places[:, 9, 1] < -0.5).all()  # feet are below


def test_mirroring_exchanges_sides_and_comes_back() -> None:
    motion = standard_motion(person(6))
    mirrored = motion.mirrored()
    assert mirrored.places[:, 5] == pytest.approx(motion.places[:, 11] * (-1, 1, 1))
    assert mirrored.mirrored().places == pytest.approx(motion.places)


def test_a_stretch_begins_anew() -> None:
    motion = standard_motion(person(7, frames=90))
    part = motion[30:60]
    assert part.frames == 30
    assert part.start == 1
    assert part.root[0, [0, 2]] == pytest.approx(0)
    assert part.heading[0] == 0
    assert np.linalg.norm(np.diff(part.root, axis=0), axis=1) == pytest.approx(
        np.linalg.norm(np.diff(motion.root[30:60], axis=0), axis=1)
    )


@pytest.mark.parametrize("frames", [1, 2])
def test_few_frames_are_enough(frames: int) -> None:
    assert standard_motion(person(0, frames=frames)).frames == frames


def test_gaps_are_bridged_where_a_joint_was_lost() -> None:
    clip = person(4)
    whole = standard_motion(clip)
    values = clip.values.copy()
    toe = next(i for i, c in enumerate(clip.columns) if c.name == "LeftToe.rx")
    hip = next(i for i, c in enumerate(clip.columns) if c.name == "LeftUpLeg.rx")
    values[:, toe] = np.nan  # is not among the sixteen
    values[20:22, hip] = values[0, hip] = np.nan
    values[40, 0] = 1e300  # all of the body
    bridged = standard_motion(clip.with_frames(values, clip.frame_time))
    kept = np.r_[1:20, 22:40, 41:60]
    assert bridged.places[kept] == pytest.approx(whole.places[kept], abs=0.02)
    assert bridged.places == pytest.approx(whole.places, abs=0.2)
    values[:, hip] = np.nan
    with pytest.raises(UnsupportedError, match="places that are numbers"):
        standard_motion(clip.with_frames(values, clip.frame_time))


@pytest.mark.parametrize("style", ["LaFAN", "no names"])
def test_who_is_nowhere_is_not_found(style: str) -> None:
    clip = person(4, style=style)
    with pytest.raises(UnsupportedError, match=r"places.* numbers"):
        standard_motion(clip.with_values(clip.values * np.nan))


def test_missing_joints_are_named() -> None:
    lame = person(0, without=("left_wrist", "right_ankle", "right_toe"))
    with pytest.raises(UnsupportedError, match=r"correspond to left_wrist, right_ankle"):
        standard_motion(lame)


def test_no_skeleton_and_no_frames_are_told() -> None:
    clip = person(0)
    with pytest.raises(UnsupportedError, match="needs a skeleton"):
        standard_motion(replace(clip, skeleton=None))
    with pytest.raises(UnsupportedError, match="needs frames"):
        standard_motion(clip[:0])


def test_a_mapping_names_joints_that_nothing_else_tells(tmp_path: Path) -> None:
    lame = person(0, without=("left_wrist", "right_wrist"))
    names = named("LaFAN")
    mapping = {"left_wrist": names["left_elbow"], "right_wrist": names["right_elbow"]}
    mapped = standard_motion(lame, mapping)
    assert mapped.places[:, 6] == pytest.approx(mapped.places[:, 5])
    file = tmp_path / "joints.json"
    file.write_text('{"left_wrist": "LeftForeArm", "right_wrist": "RightForeArm"}')
    assert read_mapping(file) == mapping


@pytest.mark.parametrize(
    ("mapping", "told"),
    [({"tail": "Hips"}, "no standard joint: tail"), ({"head": "Nose"}, "that the skeleton lacks")],
)
def test_a_mapping_of_what_is_not_there_is_refused(mapping: dict[str, str], told: str) -> None:
    with pytest.raises(ParameterError, match=told):
        standard_motion(person(0), mapping)


@pytest.mark.parametrize("text", ["[]", "{", '{"head": 1}', "[" * 10000])
def test_a_mapping_file_that_is_none_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "joints.json"
    file.write_text(text)
    with pytest.raises(ParameterError):
        read_mapping(file)
