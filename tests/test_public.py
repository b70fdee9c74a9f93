"""What Python users see: documented fields, errors that name a way on, clips that can be read."""

import dataclasses
import inspect
import re
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from running import mocapress

import mocapress as mp

SAMPLES = Path(__file__).parents[1] / "samples"
RECORDS = [
    found
    for found in (getattr(mp, name) for name in mp.__all__)
    if dataclasses.is_dataclass(found) or hasattr(found, "_fields")
]


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_help_says_what_each_field_is(record: type) -> None:
    fields = getattr(record, "_fields", None) or [
        made.name for made in dataclasses.fields(record) if not made.name.startswith("_")
    ]
    _, _, attributes = (inspect.getdoc(record) or "").partition("Attributes\n----------\n")
    for field in fields:
        assert re.search(rf"^{field}\n    \S", attributes, re.MULTILINE), field


def test_messages_name_arguments_in_python_and_options_in_a_shell(tmp_path: Path) -> None:
    clip = mp.read(SAMPLES / "freebvh.bvh")
    mp.write(clip, tmp_path / "a.csv")
    with pytest.raises(mp.ExistsError, match=r"force=True overwrites it") as raised:
        mp.write(clip, tmp_path / "a.csv")
    assert "--" not in str(raised.value)
    shown = mocapress("convert", SAMPLES / "freebvh.bvh", "-o", tmp_path / "a.csv")
    assert "--force overwrites it" in shown.stderr
    assert (
        "--force"
        in mocapress("convert", SAMPLES / "freebvh.bvh", "-o", tmp_path / "a.csv", "--json").stdout
    )
    with pytest.raises(TypeError, match="a path, bytes or a binary stream, not int"):
        mp.read(5)  # type: ignore[arg-type]


def test_a_clip_feels_like_an_array() -> None:
    clip = mp.read(SAMPLES / "cmu_01_01.amc")
    assert np.asarray(clip) is clip.values
    assert np.asarray(clip, dtype=np.float32).dtype == np.float32
    assert np.array_equal(np.diff(clip, axis=0), np.diff(clip.values, axis=0))
    with pytest.raises(KeyError, match=r"root\.tx"):
        clip["root.tX"]
    with pytest.raises(KeyError, match="lfemur"):
        clip.joint("lfemu")
    assert clip.skeleton is not None
    with pytest.raises(KeyError, match="lfemur"):
        clip.skeleton.index("LFemur")


def test_positions_are_relative_to_the_root_where_that_is_wanted() -> None:
    clip = mp.read(SAMPLES / "freebvh.bvh")
    whole, relative = mp.positions(clip), mp.positions(clip, relative=True)
    assert not relative[:, 0].any()
    assert np.array_equal(relative, whole - whole[:, :1])


def test_clips_are_made_from_arrays_by_their_class() -> None:
    values = np.arange(12.0).reshape(2, 2, 3)
    assert np.array_equal(mp.Clip.from_positions(values, ["A", "B"], 60).values.ravel(), range(12))
    assert mp.Clip.from_array(values[0], names=["a", "b", "c"], fps=60).fps == 60
    turns = np.tile([1.0, 0, 0, 0], (2, 2, 1))
    made = mp.Clip.from_quaternions(turns, np.eye(3)[:2], [-1, 0], ["hip", "knee"], 60)
    assert made.skeleton is not None
    assert made.skeleton.names == ("hip", "knee")


def with_joint(clip: mp.Clip, **changes: object) -> mp.Clip:
    assert clip.skeleton is not None
    joints = list(clip.skeleton.joints)
    joints[3] = replace(joints[3], **changes)  # type: ignore[arg-type]
    return replace(clip, skeleton=replace(clip.skeleton, joints=tuple(joints)))


def with_skeleton(clip: mp.Clip, **changes: object) -> mp.Clip:
    assert clip.skeleton is not None
    return replace(clip, skeleton=replace(clip.skeleton, **changes))  # type: ignore[arg-type]


def with_column(clip: mp.Clip, **changes: object) -> mp.Clip:
    first, *others = clip.columns
    return clip.with_columns((replace(first, **changes), *others))  # type: ignore[arg-type]


UNSOUND: dict[str, Callable[[mp.Clip], mp.Clip]] = {
    "frame time of stream 'motion'": lambda clip: clip.with_frame_time(Fraction(0)),
    "frame time": lambda clip: clip.with_frame_time(Decimal("NaN")),
    "a Decimal or Fraction": lambda clip: clip.with_frame_time(0.01),  # type: ignore[arg-type]
    "parent; expected -1 or a joint before it": lambda clip: with_joint(clip, parent=9),
    "found -2": lambda clip: with_joint(clip, parent=-2),
    "channel; expected tx": lambda clip: with_joint(clip, channels=("qx", "rz", "rx")),
    "axis_order": lambda clip: with_joint(clip, axis_order="xxz"),
    "three finite numbers": lambda clip: with_joint(clip, offset=(float("nan"), 0.0, 0.0)),
    "angle_unit; expected deg or rad": lambda clip: with_skeleton(clip, angle_unit="grad"),
    "rotation; expected moving": lambda clip: with_skeleton(clip, rotation="odd"),
    "joint of column": lambda clip: with_column(clip, joint=4000),
    "metadata": lambda clip: replace(clip, metadata={"take": 5}),  # type: ignore[dict-item]
}


@pytest.mark.parametrize("said", UNSOUND)
@pytest.mark.parametrize("name", ["a.mcz", "a.bvh", "a.npz"])
def test_what_could_not_be_read_back_is_refused(said: str, name: str, tmp_path: Path) -> None:
    clip = UNSOUND[said](mp.read(SAMPLES / "freebvh.bvh")[:3])
    with pytest.raises(mp.ParameterError, match=re.escape(said)):
        mp.write(clip, tmp_path / name)
    assert not [*tmp_path.iterdir()]


def test_a_file_that_loses_something_is_written_only_where_it_is_said_how_much(
    tmp_path: Path,
) -> None:
    clip = mp.read(SAMPLES / "freebvh.bvh")
    with pytest.raises(mp.ParameterError, match='codec="diffma:bound=4"'):
        mp.write(clip, tmp_path / "a.diffma.json")
    mp.write(clip, tmp_path / "a.diffma.json", codec="diffma:max_error=0.5")
    assert np.abs(mp.read(tmp_path / "a.diffma.json").values - clip.values).max() <= 0.5
    mp.write(clip, tmp_path / "a.mcz", codec="diffma:max_error=0.5")
    read = mp.read(tmp_path / "a.mcz")
    assert float(read.metadata["largest_error"]) == pytest.approx(
        np.abs(read.values - clip.values).max(), rel=1e-5
    )
    with pytest.raises(mp.ParameterError, match="codec, but the file has none"):
        mp.write(clip, tmp_path / "a.bvh", codec="exact")
