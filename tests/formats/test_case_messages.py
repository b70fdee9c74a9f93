"""What commands say of small odd files, and what is read of them (tests/cases/*/expected.txt)."""

import json
import shutil
import warnings
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from running import mocapress

import mocapress as mp
from mocapress.errors import MotionWarning

CASES = Path(__file__).parents[1] / "cases"


def info(name: str) -> dict[str, Any]:
    done = mocapress("info", CASES / name, "--json")
    assert done.exit_code == 0, done.output
    (facts,) = json.loads(done.stdout)
    return dict(facts)


def read(name: str) -> mp.Clip:
    """Read a case; what it is warned of is tested elsewhere."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MotionWarning)
        return mp.read(CASES / name)


def written_numbers(name: str) -> np.ndarray:
    """Give the numbers of the rows of a BVH, as Python reads them."""
    rows = (CASES / name).read_text().split("Frame Time:")[1].splitlines()[1:]
    return np.array([[float(word) for word in row.split()] for row in rows if row.split()])


def compressed(name: str, target: Path) -> tuple[str, str]:
    """Compress a file as the command does; give the codec and what is said."""
    done = mocapress("compress", CASES / name, "-o", target, "--level", 1)
    assert done.exit_code == 0, done.output
    packed = target / f"{Path(name).name}.mcz" if target.is_dir() else target
    (facts,) = json.loads(mocapress("info", packed, "--json").stdout)
    return facts.get("codec", ""), done.stderr


@pytest.mark.parametrize(
    "name",
    [
        *("08-one-frame-more-rokoko/a.bvh", "17-scale-channels/a.bvh"),
        *(f"18-nan-values/{letter}.bvh" for letter in "abcde"),
        *(f"33-amc-values-for-bones-without-dof/{letter}.amc" for letter in "ab"),
        *("42-asf-is-a-video/a.amc", "43-asf-of-another/a.amc", "14-all-six-zero-offsets/a.bvh"),
    ],
)
def test_motion_is_compressed_as_motion(name: str, tmp_path: Path) -> None:
    codec, _ = compressed(name, tmp_path / "packed.mcz")
    assert codec == "exact:level=1"


@pytest.mark.parametrize("command", ["compress", "convert", "view", "info"])
def test_a_row_too_many_is_named(command: str, tmp_path: Path) -> None:
    output = {
        "compress": ["-o", tmp_path / "a.mcz"],
        "convert": ["-o", tmp_path / "a.amc"],
        "view": ["--export", tmp_path / "a.html"],
        "info": [],
    }
    done = mocapress(command, CASES / "08-one-frame-more-rokoko/a.bvh", *output[command])
    assert done.exit_code == 0
    assert "line 157, byte 18262: more frames than declared; expected 119 frames; found 120" in (
        done.stderr
    )


@pytest.mark.parametrize("letter", "abcde")
def test_values_that_are_no_numbers_are_named_and_cost_no_others(letter: str) -> None:
    name = f"18-nan-values/{letter}.bvh"
    with pytest.warns(MotionWarning, match="no number.* in frame .*found (nan|infinity)") as told:
        clip = mp.read(CASES / name)
    bad = ~np.isfinite(clip.values)
    assert bad.any()
    assert 0 < bad.any(axis=0).sum() < clip.channels
    lines = (CASES / name).read_bytes().splitlines()
    first = int(np.flatnonzero(bad.any(axis=1))[0])
    row = next(n for n, line in enumerate(lines, 1) if line.startswith(b"Frame Time")) + 1 + first
    assert f"line {row}" in str(told[0].message)


@pytest.mark.parametrize(("letter", "place"), [("a", "frame 96"), ("b", "frame 40")])
def test_what_is_cut_off_is_kept_with_a_warning(letter: str, place: str, tmp_path: Path) -> None:
    name = f"26-truncated/{letter}.bvh"
    _, said = compressed(name, tmp_path / "a.mcz")
    assert "warning" in said
    assert place in said
    assert mp.decompress(tmp_path / "a.mcz") == (CASES / name).read_bytes()


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("14-all-six-zero-offsets/a.bvh", "cm (in motion the figure measures 177.5)"),
        ("48-up-and-root/static_root_walk.bvh", "cm (the figure measures 150)"),
    ],
)
def test_units_are_suggested(name: str, unit: str) -> None:
    assert info(name)["unit_suggested"] == unit


@pytest.mark.parametrize(
    ("letter", "rate"), [("a", 40), ("b", 120), ("c", 60), ("e", 25), ("f", 60), ("d", None)]
)
def test_rates_are_kept_on_the_way_to_an_amc_and_back(
    letter: str, rate: int | None, tmp_path: Path
) -> None:
    """An AMC states its rate since we write ``:SAMPLES-PER-SECOND``; so none is lost."""
    name = f"20-frame-rates/{letter}.bvh"
    clip = read(name)
    found = info(name)["seconds"]
    assert found is None if rate is None else found == pytest.approx(120 / rate, rel=1e-5)
    done = mocapress("convert", CASES / name, "-o", tmp_path / "a.amc")
    assert done.exit_code == 0
    back = mp.read(tmp_path / "a.amc")
    if rate is None:
        assert back.frame_time is None or not back.frame_time
    else:
        assert clip.frame_time is not None
        assert back.frame_time is not None
        assert float(back.frame_time) == pytest.approx(float(clip.frame_time), rel=1e-5)


def test_a_camera_moves(tmp_path: Path) -> None:
    for letter in "ab":
        clip = read(f"22-camera-one-bone/{letter}.bvh")
        places = mp.positions(clip)
        assert np.ptp(places, axis=0).max() > 0
        target = tmp_path / f"{letter}.html"
        done = mocapress("view", CASES / f"22-camera-one-bone/{letter}.bvh", "--export", target)
        assert done.exit_code == 0, done.output


def test_no_frames_are_told_of(tmp_path: Path) -> None:
    none = CASES / "23-one-frame-no-frame/b.bvh"
    clip = mp.read(none)
    assert clip.frames == 0
    assert clip.skeleton is not None
    for command, option, told in (
        ("view", "--export", "no frames to be played"),
        ("convert", "-o", "an AMC needs frames"),
    ):
        target = tmp_path / ("a.html" if command == "view" else "a.amc")
        done = mocapress(command, none, option, target)
        assert (done.exit_code, done.stderr.count("\n")) == (1, 1)
        assert told in done.stderr
        assert not target.exists()
    one = CASES / "23-one-frame-no-frame/a.bvh"
    assert mocapress("view", one, "--export", tmp_path / "one.html").exit_code == 0
    assert mocapress("convert", one, "-o", tmp_path / "one.amc").exit_code == 0


def test_an_asf_that_is_none_is_named(tmp_path: Path) -> None:
    _, said = compressed("42-asf-is-a-video/a.amc", tmp_path / "a.mcz")
    assert "a.asf: cannot be read, so a.amc is taken without a skeleton" in said
    assert "not an Acclaim skeleton; expected sections such as :root and :bonedata" in said
    assert mp.load(tmp_path / "a.mcz").skeleton is None
    alone = CASES / "42-asf-is-a-video/a.asf"
    done = mocapress("compress", alone, "-o", tmp_path / "asf.mcz")
    assert done.exit_code == 0
    assert mp.decompress(tmp_path / "asf.mcz") == alone.read_bytes()
    done = mocapress("info", alone)
    assert done.exit_code == 1
    assert "a.asf: not an Acclaim skeleton" in done.stderr


def test_the_asf_of_another_figure_is_named(tmp_path: Path) -> None:
    _, said = compressed("43-asf-of-another/a.amc", tmp_path / "a.mcz")
    assert "test.asf: is of another figure, so a.amc is taken without a skeleton" in said
    assert "the skeleton has no bone neck" in said
    assert mp.load(tmp_path / "a.mcz").skeleton is None


@pytest.mark.parametrize("case", ["24-other-layouts", "25-token-based-layouts"])
def test_layouts_are_read_alike(case: str) -> None:
    found = [read(f"{case}/{path.name}") for path in sorted((CASES / case).glob("*.bvh"))]
    assert {(clip.frames, clip.channels) for clip in found} == {(120, 18)}
    for clip in found[1:]:
        np.testing.assert_array_equal(clip.values, found[0].values)


def test_numbers_of_other_languages_have_their_values() -> None:
    for name in ("02-tiny-exponents/a.bvh", "03-python-exponents/a.bvh"):
        wanted = written_numbers(name)
        assert read(name).values.tobytes() == wanted.tobytes()
        assert ((wanted != 0) & (np.abs(wanted) < 1e-4)).any()


def test_names_survive_conversion(tmp_path: Path) -> None:
    for name, wanted in (("05-names-colon-dot-unicode", "Fuß"), ("04-names-with-blanks", " ")):
        mp.write(read(f"{name}/a.bvh"), tmp_path / f"{name}.amc")
        back = mp.read(tmp_path / f"{name}.amc").skeleton
        assert back is not None
        assert any(wanted in joint.name for joint in back.joints)
    clip = read("27-duplicate-names-and-channels/a.bvh")
    assert {column.name.split(".")[0] for column in clip.columns} >= {"Bone", "Bone#2"}


def test_radians_and_degrees_are_the_same_motion() -> None:
    places = [mp.positions(read(f"31-asf-radians/{letter}.amc")) for letter in "abc"]
    np.testing.assert_allclose(places[1], places[0], atol=1e-4)
    np.testing.assert_allclose(places[2], places[0], atol=1e-4)


@pytest.mark.parametrize(("letter", "rate"), [("a", 60), ("b", 60), ("c", 30)])
def test_rates_of_amc_are_told_everywhere(letter: str, rate: int, tmp_path: Path) -> None:
    name = f"32-amc-samples-per-second/{letter}.amc"
    assert Fraction(info(name)["frame_time"]) == pytest.approx(1 / rate, rel=1e-6)
    done = mocapress("convert", CASES / name, "-o", tmp_path / "a.bvh")
    assert done.exit_code == 0
    time = mp.read(tmp_path / "a.bvh").frame_time
    assert time is not None
    assert float(time) == pytest.approx(1 / rate, rel=1e-5)


def test_bones_keep_their_last_value() -> None:
    """Of rows that leave bones out; one that is first seen later begins with zeros."""
    clip = read("36-amc-partial-frames/a.amc")
    assert clip.frames == 120
    held = (np.diff(clip.values, axis=0) == 0).all(axis=1)
    assert np.isfinite(clip.values).all()
    assert not held.all()
    later = read("36-amc-partial-frames/c.amc")
    assert later.frames == 120
    assert np.isfinite(later.values).all()


@pytest.mark.parametrize("level", range(1, 10))
def test_couplings_crash_at_no_level(level: int, tmp_path: Path) -> None:
    for path in (CASES / "44-coupling-crash").glob("*.*"):
        if path.suffix != ".txt":
            blob = mp.compress(path, f"exact:level={level}")
            assert mp.decompress(blob) == path.read_bytes()


def test_begin_and_end_as_names_come_back(tmp_path: Path) -> None:
    for letter in "ab":
        clip = read(f"46-begin-end-names/{letter}.bvh")
        mp.write(clip, tmp_path / f"{letter}.amc")
        back = mp.read(tmp_path / f"{letter}.amc")
        assert back.skeleton is not None
        assert clip.skeleton is not None
        assert {joint.name for joint in clip.skeleton.joints} <= {
            joint.name for joint in back.skeleton.joints
        }


def test_cases_are_whole(tmp_path: Path) -> None:
    """Each has what is expected of it; a folder of them is compressed and restored."""
    folders = [path for path in CASES.iterdir() if path.is_dir()]
    assert all((path / "expected.txt").read_text().strip() for path in folders)
    shutil.copytree(CASES / "25-token-based-layouts", tmp_path / "in")
    done = mocapress("compress", tmp_path / "in", "-o", f"{tmp_path}/out/", "--level", 1)
    assert done.exit_code == 0
    done = mocapress("decompress", tmp_path / "out", "-o", f"{tmp_path}/back/")
    assert done.exit_code == 0
    for path in (tmp_path / "in").glob("*.bvh"):
        assert (tmp_path / "back" / path.name).read_bytes() == path.read_bytes()
