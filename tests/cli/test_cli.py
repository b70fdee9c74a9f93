"""The command line as scripts and people use it."""

import dataclasses
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from running import mocapress, process

import mocapress as mp
from mocapress.cli import main

SAMPLES = Path(__file__).parents[2] / "samples"
GOLDEN = Path(__file__).parents[1] / "golden"
AMC = b":FULLY-SPECIFIED\n:DEGREES\n" + b"".join(
    b"%d\nroot %d.5 2 3 4 5 6\nhip 1.25 -0.125\n" % (i, i) for i in range(1, 9)
)


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    file = tmp_path / "walk.amc"
    file.write_bytes(AMC)
    return file


def test_there_and_back(walk: Path) -> None:
    assert mocapress("compress", walk).exit_code == 0
    packed = walk.with_name("walk.amc.mcz")
    walk.unlink()
    assert mocapress("verify", packed).exit_code == 0
    assert mocapress("decompress", packed).exit_code == 0
    assert walk.read_bytes() == AMC


def test_a_name_without_a_suffix_gets_that_of_the_original(walk: Path) -> None:
    small = walk.with_name("small.mcz")
    assert mocapress("compress", walk, "-o", small).exit_code == 0
    assert mocapress("decompress", small).exit_code == 0
    assert walk.with_name("small.amc").read_bytes() == AMC
    walk.with_name("junk.mcz").write_bytes(b"no such file")
    result = mocapress("decompress", walk.with_name("junk.mcz"))
    assert result.exit_code == 1
    assert "not compressed by mocapress" in result.stderr


def test_nothing_is_overwritten_without_force(walk: Path) -> None:
    packed = walk.with_name("walk.amc.mcz")
    packed.write_bytes(b"precious")
    result = mocapress("compress", walk)
    assert result.exit_code == 1
    assert "--force" in result.stderr
    assert packed.read_bytes() == b"precious"
    assert mocapress("compress", walk, "--force").exit_code == 0
    assert mp.decompress(packed) == AMC


def test_folders_keep_their_shape(tmp_path: Path) -> None:
    for name in ("in/a/one.amc", "in/b/two.AMC", "in/b/notes.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(AMC)
    result = mocapress("compress", tmp_path / "in", "-o", tmp_path / "out", "-j", 2)
    assert result.exit_code == 0
    assert "in: not motion, left out: notes.txt" in result.stderr
    found = sorted(str(p.relative_to(tmp_path / "out")) for p in (tmp_path / "out").rglob("*.mcz"))
    assert found == ["a/one.amc.mcz", "b/two.AMC.mcz"]
    result = mocapress("decompress", tmp_path / "out", "-o", tmp_path / "back")
    assert result.exit_code == 0
    assert (tmp_path / "back/b/two.AMC").read_bytes() == AMC


def test_streams(walk: Path) -> None:
    packed = process("compress", "-", data=AMC)
    assert packed.returncode == 0
    assert process("decompress", "-", data=packed.stdout).stdout == AMC
    named = process("compress", walk, "-o", "-").stdout
    assert 0 <= len(named) - len(packed.stdout) - len(walk.name) <= 1
    assert process("decompress", "-", data=named).stdout == AMC


def test_json_is_for_machines(walk: Path, tmp_path: Path) -> None:
    missing = tmp_path / "missing.amc"
    result = mocapress("compress", walk, missing, "--json")
    assert result.exit_code == 1
    done, failed = json.loads(result.stdout)
    assert done["raw_bytes"] == len(AMC)
    assert done["compressed_bytes"] == walk.with_name("walk.amc.mcz").stat().st_size
    assert failed["file"] == str(missing)
    assert failed["error"] == "FileNotFoundError"


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["compress", "missing.amc"], 1, "missing.amc: No such file"),
        (["compress", "walk.amc", "--codec", "lzw"], 2, "unknown codec; expected exact, app"),
        (["compress", "walk.amc", "--codec", "app:t=0"], 2, "app:t; expected 1 to"),
        (["compress", "walk.amc", "--codec", "app", "--level", "3"], 2, "app has no levels"),
        (["compress", "walk.amc", "--level", "10"], 2, "10 is not in the range 1<=x<=9"),
        (["compress", "walk.amc", "--model", "no.mcm"], 1, "no.mcm: No such file"),
        (["compress", "walk.amc", "--model", "walk.amc"], 1, "walk.amc: not a model of mocapress"),
        (["compress", "walk.amc", "--codec", "app", "--model", "v1.mcm"], 2, "takes no model"),
        (["train", "walk.amc", "-o", "x.mcm", "--codec", "app"], 2, "app takes no model"),
        (["train", "walk.amc"], 2, "Missing option '-o'"),
        (["info", "walk.amc", "--model", "no.mcm"], 1, "no.mcm: No such file"),
        (["decompress", "walk.amc"], 2, "-o gives it"),
        (["decompress", "walk.amc", "-o", "x"], 1, "not compressed by mocapress"),
        (["verify", "walk.amc"], 3, "not compressed by mocapress"),
        (["info", "missing"], 1, "No such file"),
        (["convert", "walk.amc", "-o", "x.bvh"], 1, "no skeleton"),
        (["compress", "walk.amc", "--codec", "app", "-o", "x.diffma.json"], 2, "expected diffma"),
        (["compress", "walk.amc", "--target-psnr", "40"], 2, "expected diffma"),
        (["compress", "walk.amc", "--codec", "diffma:levels=8"], 2, "levels are for JSON"),
        (["compress", "broken.bvh", "-o", "x.diffma.json"], 1, "broken.bvh, line 3"),
        (["decompress", "x.diffma.json"], 1, "x.diffma.json: $.channels; expected a value"),
        (["verify", "x.diffma.json"], 3, "$.channels; expected a value; found nothing"),
        (["convert", "walk.amc"], 2, "say what to convert to"),
        (["compress", "empty"], 2, "no .amc or .asf or .bvh or .c3d or .csv"),
        (["info"], 2, "Missing argument"),
        (["squeeze"], 2, "No such command"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_errors_are_one_line_and_an_exit_code(
    walk: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], code: int, says: str
) -> None:
    monkeypatch.chdir(walk.parent)
    Path("empty").mkdir()
    shutil.copy(GOLDEN / "v1_learner.mcm", "v1.mcm")
    Path("broken.bvh").write_bytes(b"HIERARCHY\nROOT x\n")
    if "compress" not in words:
        Path("x.diffma.json").write_bytes(b"{}")
    done = process(*words)
    error = done.stderr.decode()
    assert done.returncode == code
    assert says in " ".join(error.replace("│", " ").split())
    assert "Traceback" not in error
    assert done.stdout == b""


def test_a_model_says_at_which_level_clips_are_coded(tmp_path: Path, samples: Path) -> None:
    clip, model, packed = samples / "freebvh.bvh", tmp_path / "a.mcm", tmp_path / "a.mcz"
    learned = mocapress("train", clip, "-o", model)
    assert (learned.exit_code, learned.stderr) == (0, "")
    assert mocapress("compress", clip, "--model", model, "-o", packed).exit_code == 0
    assert "exact:level=9" in mocapress("info", packed).stdout
    weak = mocapress("train", clip, "-o", tmp_path / "b.mcm", "--codec", "exact:level=3")
    assert weak.exit_code == 0
    assert "exact:level=3 learns nothing" in weak.stderr


@pytest.mark.usefixtures("learner")
def test_models_are_learned_and_used(tmp_path: Path, samples: Path, walk: Path) -> None:
    model, clips = tmp_path / "models/walks.mcm", tmp_path / "clips"
    clips.mkdir()
    shutil.copy(samples / "freebvh.bvh", clips / "a.bvh")
    (clips / "broken.bvh").write_bytes(b"HIERARCHY")
    learn = ("train", clips, "-o", model, "--codec", "learner")
    learned = mocapress(*learn, "--json")
    assert learned.exit_code == 0
    assert "left out" in learned.stderr
    (facts,) = json.loads(learned.stdout)
    assert (facts["clips"], facts["frames"]) == (1, mp.read(clips / "a.bvh").frames)
    assert facts["bytes"] == model.stat().st_size
    again = mocapress(*learn)
    assert again.exit_code == 1
    assert "--force" in again.stderr

    packed = tmp_path / "a.bvh.mcz"
    made = mocapress(
        *("compress", clips / "a.bvh", "-o", packed, "--model", model),
        *("--codec", "learner", "--level", 9),
    )
    assert made.exit_code == 0
    for given in (model, model.parent):
        assert mocapress("verify", packed, "--model", given).exit_code == 0
    for command, code in (("verify", 3), ("decompress", 1)):
        result = mocapress(command, packed)
        assert result.exit_code == code
        assert f"model {facts['sha256']} is needed; expected it in {tmp_path}" in result.stderr
    back = tmp_path / "back.bvh"
    assert mocapress("decompress", packed, "-o", back, "--model", model).exit_code == 0
    assert back.read_bytes() == (clips / "a.bvh").read_bytes()
    converted = mocapress("convert", packed, "-o", tmp_path / "a.amc", "--model", model)
    assert converted.exit_code == 0

    said = mocapress("info", packed, model, "--json")
    assert said.exit_code == 0
    clip, about = json.loads(said.stdout)
    assert (clip["codec"], clip["model"]) == ("learner:level=9", facts["sha256"])
    assert (clip["frames"], clip["model_found"]) == (facts["frames"], False)
    assert (about["format"], about["codec"], about["sha256"]) == ("mcm", "learner", clip["model"])
    (clip,) = json.loads(mocapress("info", packed, "--json", "--model", model).stdout)
    assert clip["model_found"]
    shutil.copy(model, tmp_path)
    assert mocapress("decompress", packed, "-o", back, "--force").exit_code == 0


def test_learning_from_broken_files_alone_fails(tmp_path: Path, learner: str) -> None:
    (tmp_path / "broken.bvh").write_bytes(b"HIERARCHY")
    result = mocapress("train", tmp_path, "-o", tmp_path / "x.mcm", "--codec", learner)
    assert result.exit_code == 2
    assert "nothing to learn from" in result.stderr
    assert not (tmp_path / "x.mcm").exists()


def test_damaged_files_fail_verification(walk: Path) -> None:
    mocapress("compress", walk)
    packed = walk.with_name("walk.amc.mcz")
    data = bytearray(packed.read_bytes())
    data[-3] ^= 4
    packed.write_bytes(data)
    assert mocapress("verify", packed).exit_code == 3
    restored = walk.with_name("restored.amc")
    result = mocapress("decompress", packed, "-o", restored)
    assert result.exit_code == 1
    assert "checksum" in result.stderr
    assert not restored.exists()


def test_what_is_left_of_a_damaged_file_can_be_salvaged(tmp_path: Path) -> None:
    walk = tmp_path / "walk.amc"
    walk.write_bytes(
        AMC[:27] + b"".join(b"%d\nroot %d.5 2 3 4 5 6\n" % (i, i * i) for i in range(1, 2001))
    )
    packed, restored = tmp_path / "walk.amc.mcz", tmp_path / "restored.amc"
    assert mocapress("compress", walk, "--codec", "exact:chunk=500").exit_code == 0
    data = bytearray(packed.read_bytes())
    data[len(data) // 2] ^= 1
    packed.write_bytes(data)
    result = mocapress("verify", packed, "--json")
    assert result.exit_code == 3
    assert "frames 500 to 999" in result.stdout or "frames 1000 to 1499" in result.stdout
    result = mocapress("decompress", packed, "-o", restored)
    assert result.exit_code == 1
    assert "--salvage" in result.stderr
    result = mocapress("decompress", packed, "-o", restored, "--salvage")
    assert result.exit_code == 0
    assert "lost: frames " in result.stderr
    assert restored.read_bytes().count(b"root") == 1500


def test_notes_are_kept(walk: Path) -> None:
    result = mocapress("compress", walk, "--note", "license=CC0", "--note", "source=a=b")
    assert result.exit_code == 0
    facts = json.loads(mocapress("info", f"{walk}.mcz", "--json").stdout)[0]
    assert facts["notes"] == {"license": "CC0", "source": "a=b"}
    assert facts["name"] == "walk.amc"
    assert mocapress("compress", walk, "-f", "--note", "license").exit_code == 2


def test_info_shows_digests_whole_and_names_as_text(tmp_path: Path) -> None:
    file = tmp_path / "walk[bold].amc"
    file.write_bytes(AMC)
    assert mocapress("compress", file, "--note", "license=[/b]").exit_code == 0
    result = mocapress("info", f"{file}.mcz")
    assert result.exit_code == 0
    lines = [line.split(maxsplit=1)[-1] for line in result.stdout.splitlines()]
    assert "walk[bold].amc" in lines
    assert "license: [/b]" in lines
    assert hashlib.sha256(AMC).hexdigest() in lines


def test_an_embedded_skeleton_comes_back(samples: Path, tmp_path: Path) -> None:
    for suffix in ("amc", "asf"):
        shutil.copy(samples / f"cmu_01_01.{suffix}", tmp_path / f"walk.{suffix}")
    assert mocapress("compress", tmp_path / "walk.amc", "--embed-asf", "--level", 1).exit_code == 0
    packed, back = tmp_path / "walk.amc.mcz", tmp_path / "back.amc"
    assert mocapress("decompress", packed, "-o", back, "--with-asf").exit_code == 0
    assert back.with_suffix(".asf").read_bytes() == (samples / "cmu_01_01.asf").read_bytes()


def test_what_is_no_motion_is_stored_with_a_warning(tmp_path: Path) -> None:
    file = tmp_path / "broken.bvh"
    file.write_bytes(b"HIERARCHY\nROOT x\n")
    result = mocapress("compress", file)
    assert result.exit_code == 0
    assert "warning" in result.stderr
    assert "line 3" in result.stderr
    assert mp.decompress(tmp_path / "broken.bvh.mcz") == file.read_bytes()


def test_info_says_what_is_inside(samples: Path, tmp_path: Path) -> None:
    packed = tmp_path / "clip.mcz"
    words = ("compress", samples / "cmu_01_01.amc", "-o", packed, "--codec", "app")
    assert mocapress(*words).exit_code == 0
    asf = samples / "cmu_01_01.asf"
    result = mocapress("info", packed, samples / "freebvh.bvh", "--json", "--asf", asf)
    assert result.exit_code == 0
    inside, bvh = json.loads(result.stdout)
    assert (inside["codec"], inside["frames"], inside["channels"]) == ("app", 2751, 62)
    assert inside["MCR"] > inside["TCR"] > inside["ratio"] > 4
    assert 0 < inside["APE"] < 1
    assert bvh["frame_time"] == "0.0333333"
    assert bvh["unit_suggested"].startswith("cm")
    assert "cm" in mocapress("info", samples / "freebvh.bvh").stdout


def test_convert_writes_a_file_that_others_read(samples: Path, tmp_path: Path) -> None:
    result = mocapress("convert", samples / "cmu_01_01.amc", "-o", tmp_path / "walk.bvh")
    assert result.exit_code == 0
    assert f"{samples / 'cmu_01_01.amc'}: the sampling rate is not known; 120" in result.stderr
    assert mp.read(tmp_path / "walk.bvh").frames == 2751
    result = mocapress("convert", samples / "freebvh.bvh", "--to", "amc", "-o", tmp_path)
    assert result.exit_code == 0
    assert mp.read(tmp_path / "freebvh.amc").skeleton is not None


@pytest.mark.parametrize("ending", ["diffma.json", "diffma.json.xz"])
def test_json_there_and_back(samples: Path, tmp_path: Path, ending: str) -> None:
    source, made = samples / "freebvh.bvh", tmp_path / f"walk.{ending}"
    words = ("compress", source, "--codec", "diffma:max_error=0.01", "-o", made)
    assert mocapress(*words).exit_code == 0
    assert mocapress("verify", made).exit_code == 0
    assert mocapress("decompress", made).exit_code == 0
    assert mocapress("convert", made, "--to", "amc", "-o", tmp_path / "other.amc").exit_code == 0
    error = mp.read(tmp_path / "walk.bvh").values - mp.read(source).values
    assert 0 < abs(error).max() <= 0.01 + 5e-5  # printed with four decimals
    (facts,) = json.loads(mocapress("info", made, "--json").stdout)
    assert (facts["format"], facts["frames"], facts["channels"]) == ("diffma.json", 69, 168)


@pytest.mark.parametrize("ending", ["mcz", "diffma.json"])
def test_a_mean_error_out_of_reach_is_told(samples: Path, tmp_path: Path, ending: str) -> None:
    words = ("compress", samples / "freebvh.bvh", "--codec", "diffma", "--json", "--force")
    for asked in (40, 200):
        made = mocapress(*words, "--target-psnr", asked, "-o", tmp_path / f"walk.{ending}")
        assert made.exit_code == 0
        (facts,) = json.loads(made.stdout)
        if asked == 40:
            assert facts["psnr"] > 39
            assert facts["warning"] is None
        else:
            assert facts["psnr"] < 199
            assert facts["warning"].startswith("a PSNR of 200 dB was asked for")


def test_folders_of_json(samples: Path, tmp_path: Path) -> None:
    for sample in [*samples.glob("cmu*"), *samples.glob("*.bvh")]:
        shutil.copy(sample, tmp_path)
    words = ("--to", "diffma.json.xz", "--target-psnr", "40", "-o", tmp_path / "json", "-j", 2)
    assert mocapress("compress", tmp_path, *words).exit_code == 0
    made = sorted(path.name for path in (tmp_path / "json").iterdir())
    assert made == [f"{s}.diffma.json.xz" for s in ("cmu_01_01", "freebvh", "mocapbank")]
    assert mocapress("decompress", tmp_path / "json", "-o", tmp_path / "back").exit_code == 0
    assert (tmp_path / "back/cmu_01_01.amc").exists()


def test_bench_writes_rows_for_machines(samples: Path, tmp_path: Path) -> None:
    result = mocapress(
        *("bench", "lossless", samples / "freebvh.bvh"),
        *("--only", "app,MPEG-4 DCT,gzip -9", "--json", tmp_path / "rows.json"),
    )
    assert result.exit_code == 0
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert [row["codec"] for row in rows] == ["app", "MPEG-4 DCT", "gzip -9"]
    needed = "clip format frames channels codec raw_bytes compressed_bytes payload_bytes"
    needed += " model_bytes header_bytes encode_us_per_frame decode_us_per_frame exact"
    for row in rows:
        assert set(needed.split()) <= set(row)
        assert row["exact"]
        assert row["compressed_bytes"] == row["payload_bytes"] + row["header_bytes"]
    assert "| gzip -9 |" in result.stdout
    again = mocapress("bench", "lossless", samples, "--json", tmp_path / "rows.json")
    assert again.exit_code == 2
    assert "rows.json: file exists; --force overwrites it" in again.stderr
    assert again.stdout == ""


def test_bench_counts_what_compress_makes(samples: Path, tmp_path: Path) -> None:
    short = tmp_path / "short.bvh"  # so short that a general-purpose compressor makes less of it
    lines = (samples / "freebvh.bvh").read_bytes().splitlines(keepends=True)
    frames = next(i for i, line in enumerate(lines) if line.startswith(b"Frames:"))
    lines[frames] = b"Frames: 1\n"
    short.write_bytes(b"".join(lines[: frames + 3]))
    shutil.copy(samples / "cmu_01_01.asf", tmp_path / "walk.asf")
    amc = (samples / "cmu_01_01.amc").read_bytes()
    (tmp_path / "walk.amc").write_bytes(amc[: amc.index(b"\n40\r\n") + 1])
    files = [short, samples / "freebvh.bvh", tmp_path / "walk.amc"]
    for number, file in enumerate(files):
        rows = tmp_path / f"{number}.json"
        words = ("bench", "lossless", file, "--only", "exact:level=3", "--json", rows)
        assert mocapress(*words).exit_code == 0
        (row,) = json.loads(rows.read_text())
        assert row["compressed_bytes"] == len(mp.compress(file, "exact:level=3"))
        assert (row["payload_bytes"] == 0) == (file == short)


def test_version_and_help() -> None:
    assert process("--version").stdout.decode().strip() == f"mocapress {mp.__version__}"
    helped = mocapress("--help").stdout
    for command in ("compress", "decompress", "train", "info", "verify", "convert", "bench"):
        assert command in helped


@pytest.mark.parametrize(
    "command", ["compress", "decompress", "verify", "info", "convert", "train", "view"]
)
def test_help_loads_nothing_heavy(command: str) -> None:
    code = (
        "import sys\nfrom mocapress.cli.app import app\n"
        "try: app(sys.argv[1:])\n"
        "finally: print({'numpy', 'mocapress.api'} & set(sys.modules), file=sys.stderr)"
    )
    words = [sys.executable, "-c", code, command, "--help"]
    done = subprocess.run(words, capture_output=True, check=True)
    assert b"--help" in done.stdout
    assert done.stderr == b"set()\n"


def test_shells_can_complete(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("_MOCAPRESS_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "mocapress co")
    monkeypatch.setenv("COMP_CWORD", "1")
    assert set(process().stdout.split()) == {b"compress", b"convert", b"compare", b"codecs"}
    monkeypatch.setenv("COMP_WORDS", "mocapress compress --codec ex")
    monkeypatch.setenv("COMP_CWORD", "3")
    assert process().stdout.split() == [b"exact"]


@pytest.mark.parametrize("ending", ["mcz", "diffma.json"])
def test_what_a_lossy_codec_lost_is_measured_and_shown(tmp_path: Path, ending: str) -> None:
    words = ["compress", GOLDEN / "v1_walk.bvh", "--codec=diffma", "-o"]
    shown = mocapress(*words, tmp_path / f"a.{ending}")
    (row,) = json.loads(mocapress(*words, tmp_path / f"b.{ending}", "--json").stdout)
    decoded = mp.load(tmp_path / f"b.{ending}")
    errors = abs(decoded.values - mp.read(GOLDEN / "v1_walk.bvh").values)
    assert row["largest_error"] == errors.max() > 0
    assert 0 < row["psnr"] < 100
    assert f"largest error {errors.max():.3g}, mean {errors.mean():.3g}, PSNR" in shown.stdout
    (facts,) = json.loads(mocapress("info", tmp_path / f"b.{ending}", "--json").stdout)
    assert facts["lossless"] is False


def test_names_that_are_no_utf_8(walk: Path) -> None:
    odd = walk.with_name(os.fsdecode(b"w\xff.bvh"))
    odd.write_bytes((SAMPLES / "mocapbank.bvh").read_bytes())
    page = walk.with_name("page.html")
    assert process("view", odd, "--export", page).returncode == 0
    assert "w\ufffd.bvh" in page.read_text(encoding="utf-8")
    clip = dataclasses.replace(mp.read(odd), name=odd.name, metadata={"skeleton": odd.name})
    assert mp.load(mp.compress(clip)).metadata["skeleton"] == "w\ufffd.bvh"
    done = process("compress", walk, "--note", os.fsdecode(b"actor=\xff"))
    assert done.returncode == 1
    assert b"a text that is not Unicode" in done.stderr


@pytest.mark.parametrize(
    "words",
    [("info", "LONG"), ("compress", "WALK", "-o", "LONG"), ("verify", "--model", "LONG", "WALK")],
    ids=str,
)
def test_a_path_that_cannot_be_looked_at_is_no_defect(walk: Path, words: tuple[str, ...]) -> None:
    paths = {"LONG": walk.with_name(300 * "n"), "WALK": walk}
    done = process(*(paths.get(word, word) for word in words))
    assert done.returncode == 1
    (line,) = done.stderr.decode().splitlines()
    assert line.startswith("mocapress: ")
    assert line.endswith(f" {paths['LONG']}: File name too long")


def test_info_tells_vendor_rates_and_gaps_of_markers() -> None:
    for kind in ("c3d", "trc"):
        (told,) = json.loads(mocapress("info", "--json", SAMPLES / f"markers.{kind}").stdout)
        assert told["markers"] == 16
        assert (told["unit"], told["rate"]) == ("mm", 120)
        assert told["gaps"] == "0.625 % of the points, 1 markers with gaps"
    (told,) = json.loads(mocapress("info", "--json", SAMPLES / "markers.c3d").stdout)
    assert told["encoding"] == "Intel, floats"


def test_markers_are_converted_to_every_kind_and_back(tmp_path: Path) -> None:
    for kind in ("trc", "csv", "npz", "c3d"):
        done = mocapress("convert", SAMPLES / "markers.c3d", "-o", tmp_path / f"a.{kind}")
        assert done.exit_code == 0, done.stderr
        assert (tmp_path / f"a.{kind}").exists()
    mocapress("convert", tmp_path / "a.trc", "-o", tmp_path / "b.c3d")
    back = mp.read(tmp_path / "b.c3d").values
    assert np.array_equal(back, mp.read(SAMPLES / "markers.c3d").values, equal_nan=True)
    refused = mocapress("convert", SAMPLES / "markers.c3d", "-o", tmp_path / "a.bvh")
    assert refused.exit_code == 1
    assert "no skeleton" in refused.stderr


def test_ctrl_c_before_a_command_begins_ends_without_a_traceback(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def interrupted(**_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("mocapress.cli.app.app", interrupted)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 130
