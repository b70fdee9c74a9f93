"""``cat``, and ``convert`` of a part of a clip or at another rate."""

from pathlib import Path

import numpy as np
import pytest
from running import mocapress

import mocapress as mp

SAMPLES = Path(__file__).parents[2] / "samples"
WALK = SAMPLES / "mocapbank.bvh"


@pytest.mark.parametrize("name", ["mocapbank.bvh", "cmu_01_01.amc", "markers.c3d", "markers.trc"])
def test_cat_writes_the_file(name: str, tmp_path: Path) -> None:
    packed = tmp_path / "packed.mcz"
    assert mocapress("compress", "-1", SAMPLES / name, "-o", packed).exit_code == 0
    for path in (SAMPLES / name, packed):
        assert mocapress("cat", path).stdout_bytes == (SAMPLES / name).read_bytes()


@pytest.mark.parametrize("name", ["mocapbank.bvh", "cmu_01_01.amc"])
def test_cat_writes_frames_as_they_stand_in_the_file(name: str, tmp_path: Path) -> None:
    packed = tmp_path / "packed.mcz"
    assert mocapress("compress", "-1", SAMPLES / name, "-o", packed).exit_code == 0
    some = mocapress("cat", packed, "--frames", "-7:-2").stdout_bytes
    assert some == mocapress("cat", SAMPLES / name, "--frames", "-7:-2").stdout_bytes
    whole = (SAMPLES / name).read_bytes().splitlines()
    lines = [line for line in some.splitlines() if not line.startswith(b"Frames:")]
    assert set(lines) <= set(whole)
    kept = mp.read(some, asf_path=SAMPLES / "cmu_01_01.asf" if "amc" in name else None)
    assert np.array_equal(kept.values, mp.read(SAMPLES / name).values[-7:-2])


@pytest.mark.parametrize("name", ["markers.c3d", "markers.trc"])
def test_cat_writes_markers_anew(name: str, tmp_path: Path) -> None:
    packed = tmp_path / "packed.mcz"
    assert mocapress("compress", "-1", SAMPLES / name, "-o", packed).exit_code == 0
    for path in (SAMPLES / name, packed):
        some = mp.read(mocapress("cat", path, "--frames", "3:9").stdout_bytes)
        assert np.array_equal(some.values, mp.read(SAMPLES / name).values[3:9])


def test_cat_names_what_it_cannot_read(tmp_path: Path) -> None:
    (tmp_path / "note").write_text("hello")
    found = mocapress("cat", tmp_path / "note", "--frames", "1:2")
    assert (found.exit_code, "not a motion file" in found.stderr) == (1, True)
    assert mocapress("cat", WALK, "--frames", "1-2").exit_code == 2


@pytest.mark.parametrize(
    ("options", "frames", "fps"),
    [
        (["--frames", "10:20"], slice(10, 20), 30),
        (["--time", "0.5:1"], slice(15, 30), 30),
        (["--every", "3"], slice(None, None, 3), 10),
        (["--frames", "4:", "--every", "2"], slice(4, None, 2), 15),
        (["--resample", "10"], slice(None, None, 3), 10),
        (["--retime", "60"], slice(None), 60),
    ],
)
def test_convert_takes_a_part(
    options: list[str], frames: slice, fps: float, tmp_path: Path
) -> None:
    part = tmp_path / "part.bvh"
    assert mocapress("convert", WALK, "-o", part, *options).exit_code == 0
    clip = mp.read(part)
    assert np.array_equal(clip.values, mp.read(WALK).values[frames])
    assert clip.fps == pytest.approx(fps, rel=1e-4)


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (["--fps", "60"], 2, "--retime"),
        (["--frames", "5:5"], 2, "no frames are left"),
        (["--time", "1000:"], 2, "no frames are left"),
        (["--frames", "1:2", "--time", "0:1"], 2, "exclude each other"),
        (["--resample", "9", "--retime", "9"], 2, "exclude each other"),
    ],
)
def test_convert_refuses_what_is_unclear(
    options: list[str], code: int, told: str, tmp_path: Path
) -> None:
    found = mocapress("convert", WALK, "-o", tmp_path / "part.bvh", *options)
    assert (found.exit_code, told in found.stderr) == (code, True)
    assert not [*tmp_path.iterdir()]


def test_a_stated_rate_may_be_told_again(tmp_path: Path) -> None:
    assert mocapress("convert", WALK, "-o", tmp_path / "walk.bvh", "--fps", 30).exit_code == 0


def test_a_rate_printed_with_few_digits_is_the_rate_that_it_stands_for() -> None:
    clip = mp.read(WALK)
    assert len(mp.resample(clip, 30)) == len(clip)
    assert np.array_equal(mp.resample(clip, 30).values, clip.values)


def test_columns_of_tables_are_chosen_by_name(tmp_path: Path) -> None:
    table = tmp_path / "some.csv"
    words = ("convert", SAMPLES / "cmu_01_01.amc", "-o", table, "--columns")
    assert mocapress(*words, "root.*,lfemur.rx").exit_code == 0
    names = table.read_text().partition("\n")[0].split(",")
    assert names == [
        "frame",
        *(f"root.{k}" for k in ["tx", "ty", "tz", "rx", "ry", "rz"]),
        "lfemur.rx",
    ]
    wrong = mocapress(*words, "lfemr.rx", "-f")
    assert (wrong.exit_code, "near it are" in wrong.stderr) == (2, True)
    figure = mocapress("convert", SAMPLES / "freebvh.bvh", "--to", "amc", "--columns", "*")
    assert (figure.exit_code, "AMC is no table" in figure.stderr) == (2, True)
