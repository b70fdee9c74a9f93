"""The skeleton that lies beside a motion file: which is taken, what is said, what is written."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

import mocapress as mp
from mocapress.cli.app import app
from mocapress.storage import ExistsError

CASES = Path(__file__).parent / "cases"
# Long enough to be compressed as motion.
AMC = b":DEGREES\n" + b"".join(
    b"%d\nroot 1 2 3 %d.%d 5 -%d.5\n" % (i, i * i % 90, i % 7 + 1, i * i % 31)
    for i in range(1, 400)
)
ASF = b":name %s\n:root\norder TX TY TZ RX RY RZ\n:bonedata\n:hierarchy\n"


def mocapress(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def rows(*words: object) -> list[dict[str, Any]]:
    result = mocapress(*words, "--json")
    assert result.exit_code == 0, result.output
    found: list[dict[str, Any]] = json.loads(result.stdout)
    return found


def folder(tmp_path: Path, *names: str) -> Path:
    """Make a folder with files of these names in it; each ASF bears its name."""
    for name in names:
        contents = ASF % name.encode() if name.lower().endswith(".asf") else AMC
        (tmp_path / name).write_bytes(contents)
    return tmp_path


@pytest.mark.parametrize(
    ("names", "found", "how"),
    [
        (("02_05.amc", "02_05.ASF", "02.asf", "x.asf"), "02_05.ASF", "same name"),
        (("02_05.amc", "02.asf", "03.asf"), "02.asf", "subject"),
        (("02_05.amc", "0.asf", "02.asf"), "02.asf", "subject"),
        (("02_05_b.amc", "02.asf", "02_05.asf"), "02_05.asf", "subject"),
        (("walk.v2.amc", "walk.asf", "x.asf"), "walk.asf", "subject"),
        (("02_05.amc", "03.asf"), "03.asf", "only one in the folder"),
        (("02_05.amc", "03.asf", "04.asf"), None, None),
        (("02_05.amc",), None, None),
    ],
)
def test_which_skeleton_was_used_is_said(
    tmp_path: Path, names: tuple[str, ...], found: str | None, how: str | None
) -> None:
    file = folder(tmp_path, *names) / names[0]
    place = None if found is None else str(tmp_path / found)
    (row,) = rows("info", file)
    assert (row["skeleton"], row["skeleton_found"]) == (place, how)
    guessed = [warning for warning in row["warnings"] if warning["warning"] == "guessed-skeleton"]
    assert bool(guessed) == (how == "only one in the folder")
    assert all(warning["file"] == place for warning in guessed)

    packed = tmp_path / f"{names[0]}.mcz"
    packed.write_bytes(mp.compress(file))
    (row,) = rows("info", packed)
    assert (row.get("skeleton"), row.get("skeleton_found")) == (place, how)


def test_reading_says_it_in_metadata_and_warns_of_a_guess(tmp_path: Path) -> None:
    file = folder(tmp_path, "walk.amc", "other.asf") / "walk.amc"
    with pytest.warns(mp.MotionWarning, match=r"other\.asf: taken as the skeleton of walk\.amc"):
        clip = mp.read(file)
    assert clip.metadata["skeleton"] == str(tmp_path / "other.asf")
    assert clip.metadata["skeleton_found"] == "only one in the folder"
    given = mp.read(file, asf_path=tmp_path / "other.asf")
    assert given.metadata["skeleton_found"] == "given"
    mp.compress(file)  # needs no skeleton, so there is nothing to warn of


def test_an_embedded_skeleton_comes_before_one_beside(samples: Path, tmp_path: Path) -> None:
    packed = tmp_path / "cmu_01_01.amc.mcz"
    packed.write_bytes(mp.compress(samples / "cmu_01_01.amc", embed_asf=True))
    folder(tmp_path, "cmu_01_01.asf")
    clip = mp.load(packed)
    assert clip.metadata["skeleton_found"] == "embedded"
    assert clip.skeleton is not None
    assert len(clip.skeleton.joints) > 1


@pytest.mark.parametrize(
    ("case", "asf"), [("42-asf-is-a-video", "a.asf"), ("43-asf-of-another", "test.asf")]
)
def test_a_skeleton_that_is_none_or_of_another_is_left_away(
    tmp_path: Path, case: str, asf: str
) -> None:
    for file in (CASES / case).glob("*.a*"):
        shutil.copy(file, tmp_path)
    source, data = tmp_path / "a.amc", (tmp_path / "a.amc").read_bytes()

    (row,) = rows("compress", source)
    (warning,) = row["warnings"]
    assert warning["file"] == str(tmp_path / asf)
    assert "a.amc is taken without a skeleton" in warning["what"]
    packed = tmp_path / "a.amc.mcz"
    assert mp.decompress(packed) == data
    assert packed.stat().st_size < len(data) / 3  # compressed as motion all the same

    for file in (source, packed):
        with pytest.warns(mp.MotionWarning, match=asf):
            clip = (mp.load if file == packed else mp.read)(file)
        assert clip.skeleton is None
        assert "skeleton" not in clip.metadata
    with pytest.raises(mp.FormatError, match=asf):
        mp.read(source, asf_path=tmp_path / asf)

    result = mocapress("convert", source, "--to", "bvh", "-o", tmp_path / "a.bvh")
    assert result.exit_code == 1
    assert str(tmp_path / asf) in result.output
    assert not (tmp_path / "a.bvh").exists()


def test_a_video_that_is_named_as_a_skeleton_is_stored(tmp_path: Path) -> None:
    video = tmp_path / "a.asf"
    shutil.copy(CASES / "42-asf-is-a-video/a.asf", video)
    rows("compress", video)
    assert mp.decompress(tmp_path / "a.asf.mcz") == video.read_bytes()


def test_a_skeleton_that_cannot_be_opened_is_left_away(tmp_path: Path) -> None:
    file = folder(tmp_path, "walk.amc") / "walk.amc"
    (tmp_path / "walk.asf").mkdir()
    with pytest.warns(mp.MotionWarning, match=r"walk\.asf: cannot be read"):
        assert mp.decompress(mp.compress(file)) == AMC


def test_what_is_broken_itself_is_not_blamed_on_the_skeleton(tmp_path: Path) -> None:
    file = folder(tmp_path, "walk.amc", "walk.asf") / "walk.amc"
    file.write_bytes(b":DEGREES\n1\nroot one 2 3 4 5 6\n")
    with pytest.raises(mp.FormatError) as caught:
        mp.read(file)
    assert caught.value.file == str(file)


def test_a_pair_is_written_together_or_not_at_all(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")
    for taken, left in (("walk.amc", "walk.asf"), ("walk.asf", "walk.amc")):
        (tmp_path / taken).write_bytes(b"mine")
        with pytest.raises(ExistsError, match=taken):
            mp.write(clip, tmp_path / "walk.amc")
        assert not (tmp_path / left).exists()
        assert (tmp_path / taken).read_bytes() == b"mine"
        (tmp_path / taken).unlink()


@pytest.mark.parametrize("words", [(), ("--force",)])
def test_the_skeleton_of_others_is_not_overwritten(
    samples: Path, tmp_path: Path, words: tuple[str, ...]
) -> None:
    """An ASF without an AMC of its name is the subject's: --force is about the output."""
    shutil.copy(samples / "freebvh.bvh", tmp_path / "walk.bvh")
    (tmp_path / "walk.asf").write_bytes(ASF % b"of others")
    result = mocapress("convert", tmp_path / "walk.bvh", "--to", "amc", *words)
    assert result.exit_code != 0
    assert "walk.asf" in result.output
    assert (tmp_path / "walk.asf").read_bytes() == ASF % b"of others"
    assert not (tmp_path / "walk.amc").exists()
    with pytest.raises(ExistsError, match=r"walk\.asf"):
        mp.write(mp.read(tmp_path / "walk.bvh"), tmp_path / "walk.amc", force=True)


def test_a_pair_that_is_there_is_replaced_when_asked(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    mp.write(clip, tmp_path / "walk.amc")
    skeleton = (tmp_path / "walk.asf").read_bytes()
    (tmp_path / "walk.asf").write_bytes(ASF % b"older")
    (tmp_path / "walk.amc").write_bytes(AMC)
    mp.write(clip, tmp_path / "walk.amc", force=True)
    assert (tmp_path / "walk.asf").read_bytes() == skeleton
    # Where the skeleton that would be written is there already, it stays.
    (tmp_path / "walk.amc").unlink()
    mp.write(clip, tmp_path / "walk.amc")
    assert mp.read(tmp_path / "walk.amc").frames == clip.frames
