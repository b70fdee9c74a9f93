"""Names come back from files that mocapress writes, whatever they are."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.formats.asf import format_asf, parse_asf
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.columns import skeleton_columns

# fmt: off
ODD = [
    "", " ", "  ", "a b", " a", "a ", "a\tb", "a\nb", "a\r", "\0", "\x1a", "\x7f", "\x85", "\xa0",
    "{", "}", "a{b}", "#", "a#b", "%", "%41", "%.", "a%.2", "50%", ":x", "(x", "-5", "12", "1a",
    "root", "ROOT", "begin", "End", "end", "End Site", "JOINT", "MOTION", "CHANNELS", "OFFSET",
    "Fuß", "mainà", "Hüfte", "Å", "腰", "\u2028", "\ufeffa", "name", "mocapress-root", "//",
]
# fmt: on
names = st.sampled_from(ODD) | st.text(st.characters(exclude_categories=[]), max_size=6)


def clip_of(names: list[str], parents: list[int]) -> Clip:
    joints = tuple(
        Joint(
            name,
            min(parent, i - 1),
            (0.0, float(i), 1.0),
            ("tx", "ty", "tz", "rz", "ry", "rx") if i == 0 else ("rz", "ry", "rx"),
            ends=((0.0, 1.0, 0.0),) if i and i not in parents else (),
        )
        for i, (name, parent) in enumerate(zip(names, parents, strict=True))
    )
    skeleton = Skeleton(joints)
    columns = skeleton_columns(skeleton)
    values = np.arange(2.0 * len(columns)).reshape(2, -1) % 89
    return Clip.of(values, columns, Fraction(1, 60), skeleton)


def names_of(clip: Clip) -> list[str]:
    assert clip.skeleton is not None
    return [joint.name for joint in clip.skeleton.joints]


@st.composite
def clips(draw: st.DrawFn) -> Clip:
    """Give a chain or a tree in the order of a BVH, which has a joint's children behind it."""
    called = draw(st.lists(names, min_size=1, max_size=6))
    parents, above = [-1], [0]
    for i in range(1, len(called)):
        above = above[: draw(st.integers(1, len(above)))]
        parents.append(above[-1])
        above.append(i)
    return clip_of(called, parents)


def check(clip: Clip, folder: Path) -> None:
    mp.write(clip, folder / "a.bvh")
    bvh = mp.read(folder / "a.bvh")
    assert names_of(bvh) == names_of(clip)
    assert [column.name for column in bvh.columns] == [column.name for column in clip.columns]
    fitted = mp.to_amc_clip(clip)
    mp.write(clip, folder / "a.amc")
    amc = mp.read(folder / "a.amc")
    assert names_of(amc) == names_of(fitted)
    assert [column.name for column in amc.columns] == [column.name for column in fitted.columns]
    assert not set(names_of(clip)) - set(names_of(amc))
    np.testing.assert_allclose(mp.positions(amc), mp.positions(fitted), atol=1e-6)
    mp.write(amc, folder / "b.bvh")
    assert sorted(names_of(mp.read(folder / "b.bvh"))) == sorted(names_of(amc))


@given(clips())
def test_any_names_come_back(tmp_path_factory: pytest.TempPathFactory, clip: Clip) -> None:
    check(clip, tmp_path_factory.mktemp("names"))


@pytest.mark.parametrize("name", ODD)
def test_odd_names_come_back(tmp_path: Path, name: str) -> None:
    check(clip_of([name, "hip", name, "knee", name], [-1, 0, 1, 1, 3]), tmp_path)


def test_usual_names_stay_as_they_are(tmp_path: Path) -> None:
    usual = ["Hips", "mixamorig:LeftUpLeg", "b_l-arm.001", "Left Hand", "Fuß", "腰"]
    clip = clip_of(usual, [-1, 0, 1, 2, 3, 4])
    mp.write(clip, tmp_path / "a.bvh")
    text = (tmp_path / "a.bvh").read_text("utf-8")
    assert all(f" {name}\n" in text for name in usual)
    mp.write(clip, tmp_path / "a.amc")
    asf, amc = ((tmp_path / f"a.{kind}").read_text("utf-8") for kind in ("asf", "amc"))
    for name in ["mixamorig:LeftUpLeg", "b_l-arm.001", "Left%20Hand", "Fuß", "腰"]:
        assert f"     name {name}\n" in asf
        assert f"\n{name} " in amc


def test_names_without_a_skeleton_come_back(tmp_path: Path) -> None:
    file = tmp_path / "a.amc"
    file.write_bytes(b"1\nroot 1 2 3 4 5 6\nHand%20L 1\nHand%20L 2\nF\xfc\xdfe 3\n")
    clip = mp.read(file)
    called = [column.name for column in clip.columns[6:]]
    assert called == ["Hand L.v1", "Hand L#2.v1", "Füße.v1"]
    mp.write(clip, tmp_path / "b.amc")
    again = mp.read(tmp_path / "b.amc")
    assert [column.name for column in again.columns] == [column.name for column in clip.columns]


def test_names_in_utf8_and_in_latin1() -> None:
    skeleton = Skeleton((Joint("root", -1), Joint("Hüfteà", 0, ends=((0.0, 1.0, 0.0),))))
    text = format_asf(skeleton).decode()
    for encoding in ("utf-8", "latin-1"):
        read = parse_asf(text.encode(encoding))
        assert [joint.name for joint in read.joints] == ["root", "Hüfteà"]
