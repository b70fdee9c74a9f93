"""``compare`` and ``stats``."""

import json
from pathlib import Path

import numpy as np
import pytest
from running import mocapress

import mocapress as mp

SAMPLES = Path(__file__).parents[2] / "samples"
WALK = SAMPLES / "mocapbank.bvh"


def test_a_file_equals_what_it_is_compressed_to(tmp_path: Path) -> None:
    packed = tmp_path / "walk.mcz"
    assert mocapress("compress", "-1", WALK, "-o", packed).exit_code == 0
    result = mocapress("compare", WALK, packed, "--max", 0)
    assert result.exit_code == 0
    assert "largest error 0, PSNR inf dB" in result.stdout


def test_errors_are_shown_and_bounded(tmp_path: Path) -> None:
    lossy = tmp_path / "lossy.mcz"
    assert mocapress("compress", WALK, "--codec", "diffma:bound=4", "-o", lossy).exit_code == 0
    result = mocapress("compare", WALK, lossy)
    assert result.exit_code == 0
    assert "channel " in result.stdout
    assert "joint " in result.stdout
    facts = json.loads(mocapress("compare", WALK, lossy, "--json").stdout)[0]
    worst = facts["largest_error"]
    assert worst == max(row["largest"] for row in facts["channels"]) > 0
    assert mocapress("compare", WALK, lossy, "--max", worst).exit_code == 0
    bounded = mocapress("compare", WALK, lossy, "--max", worst / 2)
    assert bounded.exit_code == 3
    assert "expected errors up to" in bounded.stderr


def test_of_two_files_the_damaged_one_is_named(tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcz"
    cut.write_bytes(mp.compress(WALK)[:900])
    result = mocapress("compare", WALK, cut)
    assert result.exit_code != 0
    assert f"{cut}, byte 900: the file is cut off" in result.stderr


def test_clips_that_do_not_match_are_wrong_usage() -> None:
    result = mocapress("compare", WALK, SAMPLES / "cmu_01_01.amc")
    assert result.exit_code == 2
    assert "different channels" in result.stderr


def test_statistics_of_joints_and_channels() -> None:
    shown = mocapress("stats", WALK).stdout
    assert "largest speed" in shown
    facts = json.loads(mocapress("stats", WALK, "--json").stdout)[0]
    assert facts["joints"][0]["way"] > 0
    assert {row["missing"] for row in facts["channels"]} == {0}


def test_what_is_compressed_is_read_wherever_motion_is(tmp_path: Path) -> None:
    packed = tmp_path / "walk.mcz"
    assert mocapress("compress", "-1", WALK, "-o", packed).exit_code == 0
    assert mocapress("train", packed, "-o", tmp_path / "a.mcm").exit_code == 0
    assert mocapress("stats", packed).exit_code == 0
    assert mocapress("view", tmp_path, "--export", tmp_path / "page.html").exit_code == 0
    assert mocapress("convert", packed, "-o", tmp_path / "walk.bvh").exit_code == 0


def test_a_lossy_file_says_what_it_lost(tmp_path: Path) -> None:
    lossy = tmp_path / "lossy.mcz"
    told = mocapress("compress", WALK, "--codec", "diffma:bound=8", "-o", lossy).stdout
    facts = json.loads(mocapress("compare", WALK, lossy, "--json").stdout)[0]
    largest = f"largest error {facts['largest_error']:.3g}"
    assert largest in told
    assert f"PSNR {facts['psnr']:.1f} dB" in told
    apart = mp.positions(mp.read(WALK)) - mp.positions(mp.load(lossy))
    joints = np.linalg.norm(apart, axis=-1).max()
    assert f"joints off by up to {joints:.3g} cm" in told
    verified = json.loads(mocapress("verify", lossy, "--json").stdout)[0]["loss"]
    assert verified["codec"] == "diffma:bound=8.0"
    assert float(verified["largest_error"]) == pytest.approx(facts["largest_error"], rel=1e-5)
    assert float(verified["psnr"]) == pytest.approx(facts["psnr"], rel=1e-4)
    assert f"largest error {verified['largest_error']}" in mocapress("verify", lossy).stdout
    shown = mocapress("info", lossy).stdout
    assert "bound=8.0" in shown
    for key in ("largest_error", "mean_error", "psnr"):
        assert f"{key}: {verified[key]}" in shown


def test_the_picture_shows_where_the_errors_are(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    clip = mp.read(WALK)
    values = clip.values.copy()
    values[300:320, [column.name for column in clip.columns].index("LeftKnee.rx")] += 30
    mp.write(clip.with_values(values), tmp_path / "off.mcz")
    words = ("compare", WALK, tmp_path / "off.mcz", "--picture", tmp_path / "off.png")
    assert mocapress(*words).exit_code == 0
    again = mocapress(*words)
    assert (again.exit_code, "--force overwrites it" in again.stderr) == (1, True)
    drawn = np.asarray(image.open(tmp_path / "off.png").convert("RGB"), dtype=int)
    red = (drawn[..., 0] > 150) & (drawn[..., 1] < 80) & (drawn[..., 2] < 80)
    columns = np.flatnonzero(red.any(axis=0))
    # The chart begins 206 pixels from the left and is 798 wide.
    assert 206 + 798 * 299 / 455 <= columns.min() <= columns.max() <= 206 + 798 * 321 / 455
    wrong = mocapress(*words[:-1], tmp_path / "off.pdf")
    assert (wrong.exit_code, "no such kind of picture" in wrong.stderr) == (2, True)


def test_feet_have_contacts(tmp_path: Path) -> None:
    facts = json.loads(mocapress("stats", WALK, "--json").stdout)[0]["joints"]
    standing = {row["name"]: row["contact"] for row in facts if row["contact"] is not None}
    assert {"LeftAnkle", "RightAnkle"} <= {*standing}
    assert all(0 <= share <= 1 for share in standing.values())
    assert 0 < standing["RightAnkle"] < 1
    assert "contact" in mocapress("stats", WALK).stdout


def test_a_file_that_is_not_there_is_no_difference_and_no_damage(tmp_path: Path) -> None:
    assert mocapress("compare", WALK, tmp_path / "none.bvh", "--max", 0).exit_code == 1
    assert mocapress("verify", tmp_path / "none.mcz").exit_code == 1
