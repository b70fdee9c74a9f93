"""Conversion keeps where joints are, on paper and after a trip through files."""

from decimal import Decimal
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.formats import bvh
from mocapress.motion import Clip, Joint, Skeleton, convert
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.convert import to_amc_clip, to_bvh_clip
from mocapress.motion.kinematics import positions


def same_places(before: Clip, after: Clip, tolerance: float) -> float:
    """Compare joints of one name (the root by being first) and the ends of bones as sets."""
    assert before.skeleton is not None
    assert after.skeleton is not None
    place = {joint.name: i for i, joint in enumerate(after.skeleton.joints)}
    index = [0] + [place[joint.name] for joint in before.skeleton.joints[1:]]
    found, expected = positions(after)[:, index], positions(before)
    np.testing.assert_allclose(found, expected, atol=tolerance)
    count, count_after = len(before.skeleton.joints), len(after.skeleton.joints)
    ends = positions(before, end_sites=True)[:, count:]
    ends_after = positions(after, end_sites=True)[:, count_after:]
    for e in range(ends.shape[1]):
        distance = np.linalg.norm(ends_after - ends[:, e : e + 1], axis=-1)
        assert distance.max(axis=0).min() < 2 * tolerance
    return float(np.abs(found - expected).max())


def through_file(clip: Clip, path: Path) -> Clip:
    mp.write(clip, path)
    return mp.read(path)


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_samples_keep_their_places(samples: Path, tmp_path: Path, name: str) -> None:
    clip = convert.with_rate(mp.read(samples / name), 120)
    other = ".bvh" if name.endswith("amc") else ".amc"
    written = through_file(clip, tmp_path / f"converted{other}")
    assert same_places(clip, written, 1e-4) < 1e-4
    back = through_file(written, tmp_path / f"back{Path(name).suffix}")
    assert same_places(clip, back, 1e-4) < 1e-4


def test_a_joints_offset_is_its_parents_bone(samples: Path) -> None:
    """The common mistake of converters is to take the joint's own bone."""
    asf = (samples / "cmu_01_01.asf").read_text()
    femur = asf[asf.index("name lfemur") :]
    direction = np.array([float(x) for x in femur.split("direction")[1].split()[:3]])
    bone = direction * float(femur.split("length")[1].split()[0])
    converted = to_bvh_clip(mp.read(samples / "cmu_01_01.amc"), fps=120).skeleton
    assert converted is not None
    tibia = next(joint for joint in converted.joints if joint.name == "ltibia")
    np.testing.assert_allclose(tibia.offset, bone, atol=1e-5)


vectors = st.tuples(*[st.floats(-3, 3).map(lambda x: round(x, 3))] * 3)
channel_orders = st.permutations(["rx", "ry", "rz"]).map(tuple)


@st.composite
def bvh_clips(draw: st.DrawFn) -> Clip:
    joints = [Joint("hips", -1, draw(vectors), ("tx", "ty", "tz", *draw(channel_orders)))]
    for i in range(1, draw(st.integers(2, 7))):
        moves = ("tx", "ty", "tz") if draw(st.booleans()) else ()
        turns = draw(channel_orders) if draw(st.booleans()) else ()
        joints.append(Joint(f"j{i}", draw(st.integers(0, i - 1)), draw(vectors), moves + turns))
    parents = {joint.parent for joint in joints}
    joints = [
        Joint(j.name, j.parent, j.offset, j.channels, ends=() if i in parents else (draw(vectors),))
        for i, j in enumerate(joints)
    ]
    skeleton = Skeleton(tuple(joints))
    columns = skeleton_columns(skeleton)
    seed = draw(st.integers(0, 2**32))
    values = np.random.default_rng(seed).uniform(-400, 400, (4, len(columns)))
    return Clip.of(values, columns, Decimal("0.01"), skeleton)


@given(bvh_clips())
def test_any_skeleton_goes_to_asf_and_back(clip: Clip) -> None:
    amc = to_amc_clip(clip)
    same_places(clip, amc, 1e-8)
    assert amc.skeleton is not None
    for i, joint in enumerate(amc.skeleton.joints):  # what an ASF can say: one end per bone
        ends = {child.offset for child in amc.skeleton.joints if child.parent == i}
        assert len(ends | set(joint.ends)) <= 1
        assert i or not (ends - {(0.0, 0.0, 0.0)})
    same_places(clip, to_bvh_clip(amc), 1e-8)


@given(bvh_clips(), st.randoms())
def test_a_bvh_can_be_written_whatever_the_order_of_joints_and_columns(
    clip: Clip, random: Random
) -> None:
    # A file has joints depth first, a clip only parents first; columns of a joint keep their order.
    rank = [random.random() for _ in clip.skeleton.joints] if clip.skeleton else []
    order = sorted(range(clip.channels), key=lambda c: rank[clip.columns[c].joint])
    columns = tuple(clip.columns[c] for c in order)
    mixed = Clip.of(clip.values[:, order], columns, clip.frame_time, clip.skeleton)
    for one in (clip, mixed):
        (data,) = bvh.write(one).values()
        same_places(clip, mp.read(data), 1e-6)


def test_angles_go_on_where_they_can(samples: Path) -> None:
    """No jumps by full turns, and no flips between the two ways to say a rotation."""
    clip = to_bvh_clip(mp.read(samples / "cmu_01_01.amc"), fps=120)
    turning = [i for i, column in enumerate(clip.columns) if column.kind[0] == "r"]
    assert np.abs(np.diff(clip.values[:, turning], axis=0)).max() < 60


@pytest.mark.corpus
@pytest.mark.filterwarnings("ignore:.*the only one in the folder")
def test_the_whole_corpus_keeps_its_places(corpus_clips: list[Path], tmp_path: Path) -> None:
    for number, path in enumerate(corpus_clips):
        clip = convert.with_rate(mp.read(path), 120)
        if clip.skeleton is None or (number % 8 and "cmu" in path.parts):
            continue
        other = ".bvh" if path.suffix.lower() == ".amc" else ".amc"
        written = through_file(clip, tmp_path / f"{number}{other}")
        assert len(written.values) == clip.frames
        names = [joint.name for joint in clip.skeleton.joints]
        if len(set(names)) == len(names) and not any(" " in name for name in names):
            same_places(clip, written, 1e-4)
