"""What sharded libraries are made of: archives, .mcz files, files that were only touched."""

import gzip
import io
import json
import os
import shutil
import tarfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from running import mocapress
from takes import amc_of

import mocapress as mp
from mocapress import api
from mocapress.library.sharded import manifest
from mocapress.library.sharded.store import Store

pytest.importorskip("pyarrow")
Take = tuple[bytes, list[bytes]]


@pytest.fixture
def raw(tmp_path: Path, samples: Path, take: Take) -> Path:
    folder = tmp_path / "raw"
    (folder / "walks").mkdir(parents=True)
    header, rows = take
    for number in range(4):
        begin = 60 * number
        (folder / f"walks/0{number}.amc").write_bytes(amc_of(header, rows[begin : begin + 60]))
    shutil.copy(samples / "cmu_01_01.asf", folder / "walks/01.asf")
    shutil.copy(samples / "freebvh.bvh", folder / "z.bvh")
    return folder


@pytest.fixture
def lib(tmp_path: Path) -> str:
    return created(tmp_path / "lib")


def created(path: Path) -> str:
    """Make a library whose shards have a clip or two."""
    assert mocapress("library", "create", f"{path}/", "--shard-size", 3000).exit_code == 0
    return f"{path}/"


def added(url: str, *words: object) -> str:
    done = mocapress("library", "add", url, *words)
    assert done.exit_code == 0, done.output
    return str(done.stdout)


def shards_of(url: str) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in Path(url, "shards").iterdir()}


def files_of(url: str) -> dict[str, bytes]:
    with mp.open_library(url) as library:
        return {clip.name: clip.read_bytes() for clip in library}


def motion(folder: Path) -> dict[str, bytes]:
    found = (path for path in folder.rglob("*") if path.suffix in (".amc", ".bvh"))
    return {str(path.relative_to(folder)): path.read_bytes() for path in found}


def archive(path: Path, folder: Path, names: list[str] | None = None, mode: str = "w") -> Path:
    with tarfile.open(path, mode) as made:  # type: ignore[call-overload]
        for name in names or sorted(str(p.relative_to(folder)) for p in folder.rglob("*.*")):
            made.add(folder / name, f"./{name}")
    return path


@pytest.mark.parametrize(("ending", "mode"), [("tar", "w"), ("tar.gz", "w:gz"), ("txz", "w:xz")])
def test_an_archive_makes_the_shards_of_its_files(
    tmp_path: Path, lib: str, raw: Path, ending: str, mode: str
) -> None:
    of_folder = created(tmp_path / "of_folder")
    for path in raw.rglob("*.*"):  # an archive has whole seconds here
        os.utime(path, (10**9, 10**9))
    added(of_folder, raw)
    path = archive(tmp_path / f"raw.{ending}", raw, mode=mode)
    assert "5 added, 0 unchanged" in added(lib, path)
    assert shards_of(lib) == shards_of(of_folder)
    assert len(shards_of(lib)) > 2
    assert files_of(lib) == motion(raw)
    assert added(lib, path).strip() == f"{lib}: 6 unchanged"
    assert added(lib, raw).strip() == f"{lib}: 6 unchanged"  # whichever way they come
    with mp.open_library(lib) as library:
        assert {clip.skeleton for clip in library.clips("walks")} == {"VICON"}


def test_an_archive_is_added_by_several_processes(tmp_path: Path, lib: str, raw: Path) -> None:
    serial = created(tmp_path / "serial")
    path = archive(tmp_path / "raw.tar", raw)
    added(serial, path)
    added(lib, path, "-j", 2)
    assert shards_of(lib) == shards_of(serial)


def test_a_skeleton_may_come_behind_the_clips_of_an_archive(
    tmp_path: Path, lib: str, raw: Path
) -> None:
    names = ["walks/03.amc", "z.bvh", "walks/00.amc", "walks/01.amc", "walks/01.asf"]
    added(lib, archive(tmp_path / "raw.tar", raw, names), "--into", "in/side")
    with mp.open_library(lib) as library:
        assert {clip.skeleton for clip in library.clips("in/side/walks")} == {"VICON"}
        assert len(library) == 4
    (raw / "walks/00.amc").write_bytes((raw / "walks/02.amc").read_bytes())
    told = added(lib, archive(tmp_path / "new.tar", raw, names), "--into", "in/side")
    assert "1 files" in told  # only what is new


def test_the_last_member_of_a_name_counts(tmp_path: Path, lib: str, raw: Path) -> None:
    path = archive(tmp_path / "raw.tar", raw, ["z.bvh", "walks/00.amc"])
    newer = (raw / "walks/01.amc").read_bytes()
    with tarfile.open(path, "a") as made:
        entry = tarfile.TarInfo("walks/00.amc")
        entry.size = len(newer)
        made.addfile(entry, io.BytesIO(newer))
    added(lib, path)
    assert files_of(lib) == {"z.bvh": (raw / "z.bvh").read_bytes(), "walks/00.amc": newer}


def test_what_of_an_archive_cannot_be_read_is_told(tmp_path: Path, lib: str, raw: Path) -> None:
    path = archive(tmp_path / "raw.tar", raw)
    whole = path.read_bytes()
    path.write_bytes(whole[: whole.index(b"./walks/03.amc") + 2000])
    done = mocapress("library", "add", lib, path)
    assert done.exit_code == 1
    assert "raw.tar: the archive cannot be read to its end" in done.stderr
    left = motion(raw)
    del left["walks/03.amc"], left["z.bvh"]
    assert files_of(lib) == left  # what came before it is there

    packed = tmp_path / "raw.tar.gz"
    packed.write_bytes(gzip.compress(whole, mtime=0)[:-3000])
    assert mocapress("library", "add", lib, packed).exit_code == 1
    (tmp_path / "no.tar").write_bytes(b"no archive" * 100)
    done = mocapress("library", "add", lib, tmp_path / "no.tar")
    assert done.exit_code == 1
    (line,) = done.stderr.splitlines()
    assert "no.tar: the archive cannot be read to its end" in line


@pytest.mark.parametrize("name", ["../out.bvh", "/tmp/out.bvh", "a/../../out.bvh"])
def test_no_member_leads_elsewhere(tmp_path: Path, lib: str, raw: Path, name: str) -> None:
    data = (raw / "z.bvh").read_bytes()
    with tarfile.open(tmp_path / "raw.tar", "w") as made:
        for own in (name, "good.bvh"):
            entry = tarfile.TarInfo(own)
            entry.size = len(data)
            made.addfile(entry, io.BytesIO(data))
    done = mocapress("library", "add", lib, tmp_path / "raw.tar")
    assert done.exit_code == 2
    assert "not a name for a clip" in done.stderr
    assert files_of(lib) == {"good.bvh": data}
    assert not [*tmp_path.rglob("out.bvh")]


def test_touched_files_are_not_coded_again(lib: str, raw: Path) -> None:
    added(lib, raw)
    before = shards_of(lib)
    for path in raw.rglob("*.*"):
        os.utime(path, ns=(10**18, 10**18))
    told = added(lib, raw, "--label", "walk")
    assert "0 added, 5 unchanged" in told
    assert shards_of(lib) == before
    with mp.open_library(lib) as library:
        assert {clip.modified for clip in library} == {10**18}
        assert library.labels == {"walk": 5}
    versions = [*Path(lib, "manifest").iterdir()]
    assert added(lib, raw).strip() == f"{lib}: 6 unchanged"
    assert [*Path(lib, "manifest").iterdir()] == versions  # their times are known now
    (raw / "walks/01.asf").write_bytes(
        (raw / "walks/01.asf").read_bytes().replace(b"VICON", b"OTHER")
    )
    added(lib, raw)
    with mp.open_library(lib) as library:
        assert {clip.skeleton for clip in library.clips("walks")} == {"OTHER"}


def test_mcz_files_are_taken_as_they_are_coded(tmp_path: Path, lib: str, raw: Path) -> None:
    packed = tmp_path / "packed"
    done = mocapress("compress", raw, "-o", f"{packed}/", "--codec", "exact:level=9")
    assert done.exit_code == 0, done.output
    recorded = api.compress_clip(mp.read(raw / "z.bvh")[:20], "exact")
    (packed / "recorded.mcz").write_bytes(recorded.blob)
    done = mocapress("library", "import", lib, packed, "--into", "own", "-j", 2)
    assert done.exit_code == 0, done.output
    with mp.open_library(lib) as library:
        others = {"own/recorded", "own/walks/01.asf"}
        assert {clip.name for clip in library} == {f"own/{name}" for name in motion(raw)} | others
        for name, data in motion(raw).items():
            assert library.read_bytes(f"own/{name}") == data
        assert library.load("own/recorded").frames == 20
        rows = library.manifest.rows.to_pylist()  # type: ignore[attr-defined]
        codings = {row["coding"] for row in rows if row["kind"] == "clip"}
        assert codings == {"imported:exact", None}
    before = shards_of(lib)
    done = mocapress("library", "import", lib, packed, "--into", "own")
    assert done.exit_code == 0, done.output
    assert shards_of(lib) == before
    (packed / "no.mcz").write_bytes(b"no mcz")
    done = mocapress("library", "import", lib, packed / "no.mcz")
    assert (done.exit_code, "not compressed by mocapress" in done.stderr) == (1, True)


def test_a_folder_is_added_by_one_call(tmp_path: Path, lib: str, raw: Path) -> None:
    other = created(tmp_path / "other")
    added(other, raw)
    (raw / "bad.mcz").write_bytes(b"no mcz")
    with mp.open_library(lib, "a") as library:
        assert isinstance(library, mp.library.sharded.ShardedLibrary)
        done = library.add_files(raw)
        assert (done.added, done.unchanged, done.failed) == (5, [], [])
        assert len(library) == 5
        again = library.add_files(archive(tmp_path / "raw.tar", raw), labels=["again"])
        assert again.added == 0
        assert len(again.unchanged) == 6
        assert library.labels == {"again": 5}
        failed = library.add_files(raw, compressed=True).failed
        assert [name for name, _ in failed] == ["bad.mcz"]
    assert shards_of(lib) == shards_of(other)


def test_the_index_is_made_anew_by_shards(tmp_path: Path, raw: Path) -> None:
    indexed = created(tmp_path / "indexed")
    added(indexed, raw)
    without = f"{tmp_path / 'without'}/"
    mocapress("library", "create", without, "--shard-size", 3000, "--no-index")
    added(without, raw)
    with mp.open_library(without) as library:
        assert library.lacking() == 5
    done = mocapress("library", "reindex", without, "-j", 2)
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[-1] == f"{without}: 5 clips indexed"
    assert shards_of(without) == shards_of(indexed)
    again = mocapress("library", "reindex", without)
    assert again.exit_code == 0, again.output
    assert shards_of(without) == shards_of(indexed)
    assert files_of(without) == motion(raw)
    with mp.open_library(without, "a") as library:
        assert library.reindex()[:2] == (5, 0)
        assert library.add(raw / "z.bvh", "more.bvh").frames == 69
        assert library.lacking() == 1
        assert library.add(raw / "z.bvh", "most.bvh", index=True).frames == 69
        assert library.lacking() == 1


def test_no_more_is_restored_than_allowed(lib: str, raw: Path) -> None:
    added(lib, raw)
    for command in ("verify", "recompress", "reindex"):
        more = ("--level", 1) if command == "recompress" else ()
        done = mocapress("library", command, lib, *more, "--limit", "1K")
        assert done.exit_code in (1, 3), (command, done.output)
        assert "limit" in done.stderr
        assert "defect" not in done.stderr
    packed = raw / "z.bvh.mcz"
    packed.write_bytes(mp.compress(raw / "z.bvh"))
    done = mocapress("library", "import", lib, packed, "--into", "more", "--limit", "1K")
    assert done.exit_code == 1
    assert "limit" in done.stderr
    assert len(files_of(lib)) == 5


def test_older_manifests_are_read(lib: str, raw: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A manifest says by which version it is written; what that did not have is as it was then."""
    added(lib, raw)
    newest = max(Path(lib, "manifest").iterdir())
    found = manifest.load(Store(lib))

    def written(version: int, **others: Any) -> None:
        monkeypatch.setattr(manifest, "_VERSION", version)
        data = replace(found, **others).data
        monkeypatch.undo()
        newest.write_bytes(data)

    written(1, indexed=False)
    assert manifest.load(Store(lib)).indexed  # version 1 could not say so
    assert files_of(lib) == motion(raw)
    assert mocapress("library", "label", lib, "*", "--add", "x").exit_code == 0
    (facts,) = json.loads(mocapress("library", "info", lib, "--json").stdout)
    assert facts["clips"] == 5
    newest = max(Path(lib, "manifest").iterdir())
    written(3)
    done = mocapress("library", "list", lib)
    assert done.exit_code == 1
    assert "version of the manifest; expected 1 to 2; found 3" in done.stderr
    written(2, rows=found.rows.drop_columns(["coding"]))
    assert "the manifest is damaged" in mocapress("library", "list", lib).stderr


def test_quiet_commands_print_errors_only(lib: str, raw: Path) -> None:
    for words in (
        ("add", lib, raw),
        ("add", lib, raw),
        ("verify", lib),
        ("recompress", lib, "--level", 1),
        ("reindex", lib),
        ("label", lib, "*", "--add", "x"),
        ("check", lib),
        ("remove", lib, "z.bvh"),
    ):
        done = mocapress("library", *words, "-q")
        assert (done.exit_code, done.output) == (0, ""), words
    done = mocapress("library", "verify", lib, "nothing", "-q")
    assert (done.exit_code, "no such clip" in done.stderr) == (1, True)
