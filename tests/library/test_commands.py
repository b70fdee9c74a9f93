"""The commands of a library."""

import io
import json
import os
import shutil
import signal
import tarfile
from pathlib import Path
from typing import Any

import pytest
from running import mocapress, process, started
from takes import amc_of

import mocapress as mp

AMC, ASF, BVH = "cmu_01_01.amc", "cmu_01_01.asf", "freebvh.bvh"


@pytest.fixture
def filled(samples: Path, tmp_path: Path) -> Path:
    path = tmp_path / "library.mocapdb"
    with mp.open_library(path, "a") as library:
        library.add(samples / AMC, "cmu/01.amc", codec="exact:level=1")
        library.add(samples / BVH, "other/free.bvh")
    return path


def test_create_makes_a_library_once(tmp_path: Path) -> None:
    path = tmp_path / "lib.mocapdb"
    assert mocapress("library", "create", path).exit_code == 0
    again = mocapress("library", "create", path)
    assert again.exit_code == 1
    assert "file exists" in again.output
    assert mocapress("library", "list", path).output == ""


def test_list_info_cat_label_remove(filled: Path, samples: Path) -> None:
    assert mocapress("library", "list", filled).output == "cmu/01.amc\nother/free.bvh\n"
    assert mocapress("library", "list", filled, "other").output == "other/free.bvh\n"
    assert mocapress("library", "list", filled, "cmu", "-l").output == (
        "cmu/01.amc\tamc\t2751\t-\tVICON\t-\n"
    )
    rows = json.loads(mocapress("library", "list", filled, "--json").stdout)
    assert [row["frames"] for row in rows] == [2751, 69]
    (facts,) = json.loads(mocapress("library", "info", filled, "--json").stdout)
    assert (facts["clips"], facts["frames"], facts["companions"]) == (2, 2820, 1)
    (facts,) = json.loads(mocapress("library", "info", filled, "*.bvh", "--json").stdout)
    assert (facts["file"], facts["codec"]) == ("other/free.bvh", "exact")
    assert process("library", "cat", filled, "cmu/01.amc").stdout == (samples / AMC).read_bytes()
    assert mocapress("library", "label", filled, "cmu", "--add", "walk").exit_code == 0
    assert mocapress("library", "label", filled).output == "walk\t1\n"
    assert mocapress("library", "list", filled, "--label", "walk").output == "cmu/01.amc\n"
    assert mocapress("library", "label", filled, "cmu", "--remove", "walk").exit_code == 0
    assert mocapress("library", "label", filled).output == ""
    for command in ("list", "extract", "verify", "remove", "cat", "info", "export", "recompress"):
        done = mocapress("library", command, filled, "nothing")
        assert done.exit_code == 1, command
        assert "no such clip" in done.output
    assert mocapress("library", "recompress", filled, "--level", "6").exit_code == 0
    assert mocapress("library", "verify", filled, "-j", "2").exit_code == 0
    assert mocapress("library", "remove", filled, "cmu").output == "cmu/01.amc: removed\n"
    assert mocapress("library", "list", filled).output == "other/free.bvh\n"
    assert mocapress("library", "check", filled).output == f"{filled}: 1 clips, sound\n"
    assert not Path(f"{filled}-wal").exists()


def test_export_and_import_code_nothing_again(filled: Path, tmp_path: Path) -> None:
    out, second = tmp_path / "out", tmp_path / "second.mocapdb"
    assert mocapress("library", "export", filled, "-o", out).exit_code == 0
    assert mocapress("verify", out).exit_code == 0
    assert mocapress("library", "import", second, out).exit_code == 0
    assert mocapress("library", "export", second, "-o", tmp_path / "again").exit_code == 0
    for path in out.rglob("*.mcz"):
        assert (tmp_path / "again" / path.relative_to(out)).read_bytes() == path.read_bytes()
    again = mocapress("library", "import", second, out)
    assert "2 unchanged" in again.output
    (out / "no.mcz").write_bytes(b"no mcz")
    assert mocapress("library", "import", second, out).exit_code == 1


def test_what_is_imported_is_stored_once(samples: Path, tmp_path: Path) -> None:
    packed, path = tmp_path / "packed", tmp_path / "lib.mocapdb"
    names = [BVH, AMC, "markers.c3d"]
    for folder, level in (("a", 1), ("b", 6)):
        for name in names:
            (packed / folder).mkdir(parents=True, exist_ok=True)
            blob = mp.compress(samples / name, codec=f"exact:level={level}", notes={"by": folder})
            (packed / folder / f"{name}.mcz").write_bytes(blob)
    done = mocapress("library", "import", path, packed, "--json")
    rows = {row["file"]: row for row in json.loads(done.output)}
    for file, row in rows.items():
        assert row["frames_shared"] == ("/b/" in file) * row["frames"]
        assert (row["stored_bytes"] == 0) == ("/b/" in file)
    assert path.stat().st_size < 0.6 * sum(p.stat().st_size for p in packed.rglob("*.mcz")) + 60_000
    with mp.open_library(path, "a") as library:
        for name in names:
            data = (samples / name).read_bytes()
            assert library.read_bytes(f"b/{name}") == data
            assert library[f"b/{name}"].notes["by"] == "b"
            # What has lost its source is coded anew, and what is exported needs nobody.
            library.remove(f"a/{name}")
            assert library.read_bytes(f"b/{name}") == data
            assert mp.decompress(library.read_mcz(f"b/{name}")) == data
        assert not library.verify()


def test_extracting_overwrites_nothing_unasked(filled: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    mocapress("library", "extract", filled, "-o", out)
    (out / "cmu" / "01.amc").write_bytes(b"mine")
    again = mocapress("library", "extract", filled, "cmu/01.amc", "-o", out)
    assert again.exit_code == 1
    assert "file exists" in again.output
    assert (out / "cmu" / "01.amc").read_bytes() == b"mine"
    assert mocapress("library", "extract", filled, "-o", out, "--force").exit_code == 0


def archive(path: Path, members: list[tuple[str, bytes]], mode: str) -> None:
    kind: Any = f"w:{mode}"
    with tarfile.open(path, kind) as made:
        for name, data in members:
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime = len(data), 1_234_567_890
            made.addfile(entry, io.BytesIO(data))


@pytest.mark.parametrize("mode", ["", "gz", "bz2", "xz"])
def test_archives_are_read_as_streams(samples: Path, tmp_path: Path, mode: str) -> None:
    files = {name: (samples / name).read_bytes() for name in (AMC, ASF, BVH)}
    # The skeleton comes behind the clip that needs it.
    members = [
        ("set/01/a.amc", files[AMC]),
        ("./set/read.me", b"no motion"),
        ("set/01/only.asf", files[ASF]),
        ("./set/b.bvh", files[BVH]),
    ]
    tar, path = tmp_path / f"set.tar{mode and '.'}{mode}", tmp_path / "lib.mocapdb"
    archive(tar, members, mode)
    done = mocapress("library", "add", path, tar, "-j", "2", "--into", "big")
    assert done.exit_code == 0, done.output
    with mp.open_library(path) as library:
        assert [clip.name for clip in library] == ["big/set/01/a.amc", "big/set/b.bvh"]
        assert library.read_bytes("big/set/01/a.amc") == files[AMC]
        assert library.load("big/set/01/a.amc", slice(1)).skeleton is not None
        assert not library.verify()
    assert mocapress("library", "extract", path, "-o", tmp_path / "out").exit_code == 0
    skeleton = tmp_path / "out" / "big" / "set" / "01" / "only.asf"
    assert skeleton.read_bytes() == files[ASF]
    assert skeleton.stat().st_mtime == 1_234_567_890
    again = process("library", "add", path, "-", "--into", "big", data=tar.read_bytes())
    assert again.returncode == 0
    assert b"replaced" not in again.stdout


def test_a_broken_archive_keeps_what_came_before(samples: Path, tmp_path: Path) -> None:
    tar, path = tmp_path / "set.tgz", tmp_path / "lib.mocapdb"
    members = [("a.bvh", (samples / BVH).read_bytes()), ("b.bvh", os.urandom(200_000))]
    archive(tar, members, "gz")
    tar.write_bytes(tar.read_bytes()[:-100_000])
    done = mocapress("library", "add", path, tar)
    assert done.exit_code == 1
    assert "cannot be read to its end" in done.output
    assert mocapress("library", "list", path).output == "a.bvh\n"


def test_members_lead_nowhere_else(samples: Path, tmp_path: Path) -> None:
    tar, path = tmp_path / "set.tar", tmp_path / "lib.mocapdb"
    archive(tar, [("../a.bvh", b"1"), ("/b.bvh", b"2"), ("c.bvh", b"3")], "")
    done = mocapress("library", "add", path, tar)
    assert done.exit_code == 2
    assert done.output.count("not a name for a clip") == 2
    assert mocapress("library", "list", path).output == "c.bvh\n"


def test_files_that_would_have_one_name_are_refused(samples: Path, tmp_path: Path) -> None:
    for folder in "ab":
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.bvh").write_bytes((samples / BVH).read_bytes())
    path = tmp_path / "lib.mocapdb"
    done = mocapress("library", "add", path, tmp_path / "a", tmp_path / "b")
    assert done.exit_code == 2
    assert "would both be x.bvh" in done.output
    assert mocapress("library", "add", path, tmp_path / "a").exit_code == 0
    assert mocapress("library", "add", path, tmp_path / "b", "--into", "b").exit_code == 0


def test_ctrl_c_keeps_what_is_done(tmp_path: Path, take: tuple[bytes, list[bytes]]) -> None:
    header, rows = take
    (tmp_path / "clips").mkdir()
    for i in range(60):
        part = rows[i * 35 : i * 35 + 600]
        piece = amc_of(header, [row.replace(b"1", b"%d" % (i % 10)) for row in part])
        (tmp_path / "clips" / f"{i:02}.amc").write_bytes(piece)
    path = tmp_path / "lib.mocapdb"
    running = started("library", "add", path, tmp_path / "clips", "--codec", "exact:level=9")
    assert running.stdout is not None
    first = running.stdout.readline()
    running.send_signal(signal.SIGINT)
    out, err = running.communicate()
    assert running.returncode == 130
    done = [first, *out.splitlines()]
    assert f"interrupted; {len(done)} of 60 files done" in err.decode()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["clips", "lib.mocapdb"]
    with mp.open_library(path) as library:
        assert len(done) <= len(library) < 60
        assert not library.verify()
    assert mocapress("library", "add", path, tmp_path / "clips", "-j", "2").exit_code == 0
    with mp.open_library(path) as library:
        assert len(library) == 60
        assert not library.verify()


def test_progress_needs_no_terminal(filled: Path, samples: Path, tmp_path: Path) -> None:
    shutil.copy(samples / BVH, tmp_path / "x.bvh")
    done = process("library", "add", filled, tmp_path / "x.bvh", "--json")
    (row,) = json.loads(done.stdout)
    assert (row["state"], row["frames"], row["frames_shared"]) == ("added", 69, 69)
    assert done.stderr == b""


def test_frames_are_those_of_the_first_stream(samples: Path, tmp_path: Path) -> None:
    path = tmp_path / "lib.mocapdb"
    for folder in ("a", "b"):  # points, and analog channels at another rate
        done = mocapress("library", "add", path, samples / "markers.c3d", "--into", folder)
    assert "300 of 300 frames were there" in done.output
    for words in ([], ["b/markers.c3d"]):
        (told,) = json.loads(mocapress("library", "info", path, *words, "--json").output)
        assert told["frames_shared"] == 300


def test_what_a_clip_is_warned_of_is_one_line(samples: Path, tmp_path: Path) -> None:
    lines = (samples / BVH).read_text().splitlines()
    lines[-1] = "nan " + lines[-1].split(maxsplit=1)[1]
    (tmp_path / "odd.bvh").write_text("\n".join(lines))
    path = tmp_path / "lib.mocapdb"
    mocapress("library", "add", path, tmp_path / "odd.bvh", samples / BVH)
    done = process("search", path, tmp_path / "odd.bvh", "--frames", "0:40")
    assert done.returncode == 0
    told = done.stderr.decode().splitlines()
    assert len(told) == 1
    assert told[0].startswith("mocapress: warning: ")


def test_a_reader_that_has_seen_enough_is_no_fault(filled: Path) -> None:
    for words in (["library", "list", filled], ["search", filled, "cmu/01.amc"]):
        running = started(*words, env={**os.environ, "PYTHONUNBUFFERED": "1"})
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.close()
        assert running.stderr.read() == b""
        running.stderr.close()
        assert running.wait() in (0, 1)


def test_a_library_may_go_without_an_index(tmp_path: Path, samples: Path) -> None:
    path = tmp_path / "lib.mocapdb"
    assert mocapress("library", "create", path, "--no-index").exit_code == 0
    mocapress("library", "add", path, samples / BVH)
    packed = tmp_path / "packed.bvh.mcz"
    packed.write_bytes(mp.compress(samples / BVH))
    mocapress("library", "import", path, packed)
    with mp.open_library(path, "a") as library:
        library.add(samples / BVH, "third.bvh")
        assert library.lacking() == 3
        assert {hit.name for hit in library.search("third.bvh")} == {BVH, "packed.bvh"}
    without = path.stat().st_size
    assert mocapress("library", "reindex", path).exit_code == 0
    mocapress("library", "add", path, samples / BVH, "--into", "more", "--index")
    mocapress("library", "add", path, samples / BVH, "--into", "most")
    with mp.open_library(path) as library:
        assert library.lacking() == 1
    assert path.stat().st_size >= without


def test_quiet_commands_print_errors_only(filled: Path, samples: Path, tmp_path: Path) -> None:
    with mp.open_library(filled) as library:
        (tmp_path / "free.bvh.mcz").write_bytes(library.read_mcz("other/free.bvh"))
    (tmp_path / "notes.bvh").write_bytes(b"no motion")
    for words in (
        ("add", filled, samples / BVH, "--into", "more"),
        ("import", filled, tmp_path / "free.bvh.mcz"),
        ("verify", filled),
        ("check", filled),
        ("recompress", filled, "--level", 2),
        ("reindex", filled),
        ("label", filled, "*", "--add", "x"),
        ("extract", filled, "-o", tmp_path / "out"),
        ("export", filled, "-o", tmp_path / "out"),
        ("remove", filled, "free.bvh"),
        ("add", filled, tmp_path / "notes.bvh"),  # with a warning, were it not for -q
    ):
        done = mocapress("library", *words, "-q")
        assert (done.exit_code, done.output) == (0, ""), words
    done = mocapress("library", "add", filled, tmp_path / "none.bvh", "-q")
    assert done.exit_code == 1
    assert "No such file" in done.stderr


def test_no_more_is_restored_than_allowed(filled: Path, samples: Path, tmp_path: Path) -> None:
    """Also by commands that write or draw: a clip of more is an error of its own.

    Of a motion file that is added nothing is restored, so no limit counts.
    """
    before = filled.read_bytes()
    for words in (
        ("recompress", filled, "--level", 2),
        ("reindex", filled),
        ("sheet", filled, "-o", tmp_path / "sheet.png"),
        ("import", filled, packed_of(samples / BVH, tmp_path)),
    ):
        done = mocapress("library", *words, "--limit", "2K")
        assert done.exit_code in (1, 2), (words, done.output)
        assert "limit" in done.stderr, words
        assert "defect" not in done.stderr
    with mp.open_library(filled) as library:
        assert [clip.name for clip in library] == ["cmu/01.amc", "other/free.bvh"]
        assert library["cmu/01.amc"].read_bytes() == (samples / AMC).read_bytes()
    assert len(filled.read_bytes()) == len(before)


def packed_of(path: Path, folder: Path) -> Path:
    target = folder / f"{path.name}.mcz"
    target.write_bytes(mp.compress(path))
    return target
