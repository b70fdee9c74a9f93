"""What users of zstd and xz type."""

import os
import shutil
from pathlib import Path

import pytest
from running import mocapress, process

from mocapress.cli.shorthand import spelled

SAMPLES = Path(__file__).parents[2] / "samples"
COMMANDS = ("compress", "decompress", "list", "verify", "info", "library")
ASF = b""":version 1.10
:units
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name hip
     direction 0 1 0
     length 1
     axis 0 0 0 XYZ
    dof rx ry
  end
:hierarchy
  begin
    root hip
  end
"""
AMC = b":FULLY-SPECIFIED\n:DEGREES\n" + b"".join(
    b"%d\nroot %d.5 2 3 4 5 6\nhip 1.25 -0.125\n" % (i, i) for i in range(1, 9)
)


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    (tmp_path / "walk.asf").write_bytes(ASF)
    file = tmp_path / "walk.amc"
    file.write_bytes(AMC)
    return file


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("walk.amc", "compress walk.amc"),
        ("-9 walk.amc", "compress --level=9 walk.amc"),
        ("-9kfowalk.mcz walk.amc", "compress --level=9 -f -owalk.mcz walk.amc"),
        ("-T0 -r folder.d", "compress -T0 folder.d"),
        ("--best -c walk.amc", "compress --level=9 --output=- walk.amc"),
        ("-", "compress -"),
        ("-d walk.amc.mcz", "decompress walk.amc.mcz"),
        ("-dc walk.amc.mcz", "decompress --output=- walk.amc.mcz"),
        ("walk.amc.mcz -d", "decompress walk.amc.mcz"),
        ("-l a.mcz b.mcz", "list a.mcz b.mcz"),
        ("-tq a.mcz", "verify -q a.mcz"),
        ("--debug -d a.mcz", "--debug decompress a.mcz"),
        ("compress -9k walk.amc", "compress --level=9 walk.amc"),
        ("compress -d walk.amc", "compress -d walk.amc"),
        ("-19 walk.amc", "compress --level=19 walk.amc"),
        ("-- -9", "compress -- -9"),
        ("info -l x.amc", "info -l x.amc"),
        ("library list -l lib.mocapdb", "library list -l lib.mocapdb"),
        ("compres walk.amc", "compres walk.amc"),
        ("-V", "-V"),
        ("--help", "--help"),
        ("--debug", "--debug"),
        ("", ""),
    ],
)
def test_short_ways_are_spelled_out(typed: str, meant: str) -> None:
    assert spelled(typed.split(), COMMANDS.__contains__) == meant.split()


def test_a_command_comes_before_a_file_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "info").touch()
    (tmp_path / "walks").mkdir()
    assert spelled(["info"], COMMANDS.__contains__) == ["info"]
    assert spelled(["./info"], COMMANDS.__contains__) == ["compress", "./info"]
    assert spelled(["walks"], COMMANDS.__contains__) == ["compress", "walks"]


def test_there_and_back(walk: Path) -> None:
    original = walk.read_bytes()
    assert mocapress("-9", "--rm", walk).exit_code == 0
    packed = walk.with_name(f"{walk.name}.mcz")
    assert not walk.exists()
    assert packed.exists()
    listed = mocapress("-l", packed).stdout
    assert "general-purpose" in listed
    assert str(len(original)) in listed
    result = mocapress("-dqk", packed)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    assert walk.read_bytes() == original
    assert packed.exists()


def test_a_lossy_codec_does_not_remove(walk: Path) -> None:
    result = mocapress("--rm", "--codec", "diffma", walk)
    assert result.exit_code == 2
    assert "lossy" in result.stderr
    assert walk.exists()


def test_what_was_changed_meanwhile_or_is_a_link_is_not_removed(walk: Path) -> None:
    link = walk.with_name("link.amc")
    link.symlink_to(walk)
    result = mocapress("--rm", link)
    assert "not removed" in result.stderr
    assert link.is_symlink()
    assert walk.exists()
    assert link.with_name("link.amc.mcz").exists()


def test_a_companion_that_was_not_restored_keeps_its_file(walk: Path) -> None:
    for ending in ("amc", "asf"):
        shutil.copy(SAMPLES / f"cmu_01_01.{ending}", walk.with_suffix(f".{ending}"))
    packed = walk.with_name("walk.mcz")
    assert mocapress("-1", "--embed-asf", walk, "-o", packed).exit_code == 0
    result = mocapress("-d", "--rm", packed, "-o", walk.with_name("again.amc"))
    assert "not removed" in result.stderr
    assert packed.exists()
    assert mocapress("-df", "--rm", "--with-asf", packed, "-o", walk).exit_code == 0
    assert not packed.exists()


def test_a_second_run_goes_on(walk: Path) -> None:
    other, packed = walk.with_name("other.amc"), walk.with_name(f"{walk.name}.mcz")
    mocapress(walk)
    other.write_bytes(walk.read_bytes())
    result = mocapress("--skip-existing", walk.parent)
    assert result.exit_code == 0
    assert "left out: their outputs exist" in result.stderr
    assert other.with_name("other.amc.mcz").exists()
    before = packed.read_bytes()
    assert mocapress("--update", walk).stdout == ""
    walk.write_bytes(b"not motion")
    os.utime(walk, ns=(0, packed.stat().st_mtime_ns + 10**9))
    assert mocapress("--update", walk).exit_code == 0
    assert packed.read_bytes() != before
    assert mocapress("--update", "--force", walk).exit_code == 2


def test_only_the_last_folder_is_made_unasked(walk: Path) -> None:
    deep = walk.parent / "a" / "b" / "walk.mcz"
    result = mocapress(walk, "-o", deep)
    assert result.exit_code == 2
    assert "-p makes it" in result.stderr
    assert mocapress(walk, "-p", "-o", deep).exit_code == 0
    assert mocapress(walk, "-o", f"{walk.parent}/c/").exit_code == 0


def test_hidden_files_are_counted_and_left_out(walk: Path) -> None:
    (walk.parent / ".trash").mkdir()
    (walk.parent / ".trash" / "old.amc").write_bytes(walk.read_bytes())
    (walk.parent / "._walk.amc").write_bytes(b"a resource fork")
    result = mocapress(walk.parent)
    assert "hidden, left out: " in result.stderr
    assert not (walk.parent / "._walk.amc.mcz").exists()
    assert not (walk.parent / ".trash" / "old.amc.mcz").exists()


def test_archives_are_no_targets(walk: Path) -> None:
    result = mocapress(walk, "-o", walk.with_suffix(".zip"))
    assert result.exit_code == 2
    assert not walk.with_suffix(".zip").exists()


def test_codecs_are_listed_with_their_parameters() -> None:
    listed = mocapress("codecs").stdout
    assert "exact: " in listed
    assert "level=" in listed
    assert '"id": "diffma"' in mocapress("codecs", "--json").stdout


def test_the_help_names_short_ways_exit_codes_and_debug() -> None:
    shown = mocapress("--help").output
    for promised in ("-d restores", "-1 to -9", "Exit codes:", "130: Ctrl-C", "--debug"):
        assert promised in shown


def test_without_inputs_a_pipe_is_read(tmp_path: Path) -> None:
    data = (SAMPLES / "freebvh.bvh").read_bytes()
    packed = process("-1", "-c", data=data)
    assert packed.returncode == 0
    assert process("-d", data=packed.stdout).stdout == data
    (tmp_path / "a.mcz").write_bytes(packed.stdout)
    quiet = mocapress("-tq", tmp_path / "a.mcz")
    assert (quiet.exit_code, quiet.output) == (0, "")
