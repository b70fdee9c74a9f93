"""Sharded libraries: what is put in comes out, and every change is seen whole or not at all."""

import json
import multiprocessing
import os
import pickle
import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from running import mocapress
from takes import amc_of

import mocapress as mp
from mocapress.library import schema
from mocapress.library.sharded import building, manifest, open_sharded, publishing
from mocapress.library.sharded.executor import executor
from mocapress.library.sharded.manifest import shard_file
from mocapress.library.sharded.places import joined, last_values
from mocapress.library.sharded.store import Store

pytest.importorskip("pyarrow")
Take = tuple[bytes, list[bytes]]


@pytest.fixture
def raw(tmp_path: Path, samples: Path, take: Take) -> Path:
    """Give a folder of files: takes, one of them a cut of another, a skeleton, another format."""
    folder = tmp_path / "raw"
    (folder / "walks").mkdir(parents=True)
    header, rows = take
    (folder / "walks/01.amc").write_bytes(amc_of(header, rows[:400]))
    (folder / "walks/02.amc").write_bytes(amc_of(header, rows[100:300]))
    (folder / "walks/03.amc").write_bytes(amc_of(header, rows[600:700]))
    shutil.copy(samples / "cmu_01_01.asf", folder / "walks/01.asf")
    shutil.copy(samples / "freebvh.bvh", folder / "z.bvh")
    return folder


@pytest.fixture
def lib(tmp_path: Path, raw: Path) -> str:
    """Give a library of these files in two shards."""
    url = f"{tmp_path / 'lib'}/"
    assert mocapress("library", "create", url, "--shard-size", 68000).exit_code == 0
    done = mocapress("library", "add", url, raw)
    assert done.exit_code == 0, done.output
    return url


def shards_of(url: str) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in Path(url, "shards").iterdir()}


def contents(url: str) -> dict[str, bytes]:
    with mp.open_library(url) as library:
        return {clip.name: clip.read_bytes() for clip in library}


def files(folder: Path) -> dict[str, bytes]:
    found = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".asf")
    return {str(path.relative_to(folder)): path.read_bytes() for path in found}


def test_files_come_back_as_they_were(lib: str, raw: Path, tmp_path: Path) -> None:
    assert contents(lib) == files(raw)
    assert len(shards_of(lib)) == 2
    out = tmp_path / "out"
    assert mocapress("library", "extract", lib, "-o", out).exit_code == 0
    assert {**files(out)} == files(raw)
    assert (out / "walks/01.asf").read_bytes() == (raw / "walks/01.asf").read_bytes()
    for path in out.rglob("*.*"):
        name = path.relative_to(out)
        assert path.stat().st_mtime_ns == (raw / name).stat().st_mtime_ns
    done = mocapress("library", "verify", lib)
    assert (done.exit_code, done.output.splitlines()[-1]) == (0, "4 clips are sound")
    assert mocapress("library", "check", lib).exit_code == 0


def test_commands_say_what_is_there(lib: str) -> None:
    listed = mocapress("library", "list", lib, "walks", "-l").output.splitlines()
    assert listed[0] == "walks/01.amc\tamc\t400\t-\tVICON\t-"
    assert mocapress("library", "label", lib, "walks", "--add", "walk").output == "3 clips\n"
    assert mocapress("library", "list", lib, "--label", "walk").output.count("\n") == 3
    (facts,) = json.loads(mocapress("library", "info", lib, "--json").stdout)
    assert (facts["clips"], facts["frames"], facts["frames_shared"]) == (4, 769, 200)
    assert facts["library_bytes"] == sum(map(len, shards_of(lib).values()))
    done = mocapress("library", "cat", lib, "nothing")
    assert (done.exit_code, done.output.strip()) == (
        1,
        f"mocapress: {lib}: no such clip; found 'nothing'",
    )


def test_python_reads_as_of_one_file(lib: str, raw: Path) -> None:
    with mp.open_library(lib) as library:
        whole = mp.read(raw / "walks/01.amc", asf_path=raw / "walks/01.asf")
        assert np.array_equal(
            library.load("walks/01.amc", slice(50, 60)).values, whole.values[50:60]
        )
        assert [clip.name for clip in library.clips(skeleton="VICON")] == [
            *("walks/01.amc", "walks/02.amc", "walks/03.amc")
        ]
        assert (
            mp.decompress(library.read_mcz("walks/02.amc")) == (raw / "walks/02.amc").read_bytes()
        )
        with pytest.raises(mp.ParameterError, match="no such clip"):
            library.load(12345)
        assert library.windows(50, glob="walks")[3].shape == (50, 62)
        again = pickle.loads(pickle.dumps(library))
        assert again.read_bytes("z.bvh") == (raw / "z.bvh").read_bytes()
        again.close()
        table = library.to_pandas().set_index("name")
        assert table.loc["walks/01.amc", "stored"] > table.loc["walks/02.amc", "stored"] == 0


def test_only_what_is_new_is_added(lib: str, raw: Path, take: Take) -> None:
    before = shards_of(lib)
    assert mocapress("library", "add", lib, raw).output.strip() == f"{lib}: 5 unchanged"
    assert shards_of(lib) == before
    header, rows = take
    (raw / "walks/03.amc").write_bytes(amc_of(header, rows[900:1000]))
    assert "1 files" in mocapress("library", "add", lib, raw).output
    assert contents(lib) == files(raw)
    (raw / "walks/01.asf").write_bytes(
        (raw / "walks/01.asf").read_bytes().replace(b"VICON", b"OTHER")
    )
    mocapress("library", "add", lib, raw)
    with mp.open_library(lib) as library:
        assert {clip.skeleton for clip in library.clips("walks")} == {"OTHER"}


def test_equal_files_make_equal_shards(lib: str, raw: Path, tmp_path: Path) -> None:
    url = f"{tmp_path / 'again'}/"
    mocapress("library", "create", url, "--shard-size", 68000)
    assert mocapress("library", "add", url, raw, "-j", 2).exit_code == 0
    assert shards_of(url) == shards_of(lib)


def test_a_run_that_was_ended_is_gone_on_with(raw: Path, tmp_path: Path) -> None:
    whole, ended = f"{tmp_path / 'whole'}/", f"{tmp_path / 'ended'}/"
    for url in (whole, ended):
        mocapress("library", "create", url, "--shard-size", 20000)
    assert mocapress("library", "add", whole, raw).exit_code == 0
    with open_sharded(ended, "a") as library:
        first, *_, last = library.plan(str(raw)).tasks
        library.publish(building.add(last))
        building.add(first)  # written, but ended before it was published
        names = [clip.name for clip in library]
        assert "z.bvh" in names
        assert "walks/01.amc" not in names
    assert mocapress("library", "add", ended, raw).exit_code == 0
    assert shards_of(ended) == shards_of(whole)
    assert contents(ended) == files(raw)


def test_what_others_share_with_a_removed_clip_stays(lib: str, raw: Path) -> None:
    assert mocapress("library", "remove", lib, "walks/01.amc").exit_code == 0
    left = files(raw)
    del left["walks/01.amc"]
    assert contents(lib) == left
    mocapress("library", "remove", lib, "*")
    assert contents(lib) == {}
    assert shards_of(lib) == {}


def test_recompressing_keeps_files_and_labels(lib: str, raw: Path) -> None:
    with mp.open_library(lib, "a") as library:
        library.label("z.bvh", "odd")
        library.remove("walks/02.amc")
    before = shards_of(lib)
    done = mocapress("library", "recompress", lib, "--level", 9)
    assert done.exit_code == 0, done.output
    assert not before.keys() & shards_of(lib).keys()
    left = files(raw)
    del left["walks/02.amc"]
    assert contents(lib) == left
    again = mocapress("library", "recompress", lib, "--level", 9)
    assert again.output.strip() == f"{lib}: all are coded in this way already"
    with mp.open_library(lib) as library:
        assert library.labels == {"odd": 1}
        assert library.verify() == []


def test_one_clip_is_added_in_python(tmp_path: Path, samples: Path) -> None:
    with mp.open_library(f"{tmp_path / 'lib'}/", "a") as library:
        clip = library.add(samples / "freebvh.bvh", "a.bvh", labels=["x"])
        assert (clip.frames, clip.labels) == (69, ("x",))
        assert library.add(samples / "freebvh.bvh", "a.bvh") == clip
        with pytest.raises(mp.MocapressError, match="clip of this name"):
            library.add(samples / "mocapbank.bvh", "a.bvh")
        assert library.add(samples / "mocapbank.bvh", "a.bvh", replace=True).frames == 455
        assert library["a.bvh"].read_bytes() == (samples / "mocapbank.bvh").read_bytes()
    with (
        pytest.raises(mp.ParameterError, match="reading only"),
        mp.open_library(tmp_path / "lib") as library,
    ):
        library.remove("a.bvh")


def test_no_change_is_lost_where_two_make_one(lib: str) -> None:
    store = Store(lib)
    label = publishing.with_labels(["z.bvh"], ["first"], ())
    tries: list[int] = []
    newest = manifest.newest(store)

    def late(before: manifest.Manifest) -> manifest.Manifest | None:
        if not tries:
            manifest.publish(store, label)
        tries.append(before.number)
        return publishing.with_labels(["z.bvh"], ["second"], ())(before)

    manifest.publish(store, late)
    assert tries == [newest, newest + 1]
    with mp.open_library(lib) as library:
        assert library["z.bvh"].labels == ("first", "second")


def test_a_missing_shard_costs_its_clips(lib: str) -> None:
    with open_sharded(lib) as library:
        (task,) = library.reading_tasks([library["z.bvh"]])
    file = shard_file(task.shard)
    Path(lib, file).unlink()
    for command, code in (("cat", 1), ("verify", 3)):
        done = mocapress("library", command, lib, "z.bvh")
        assert done.exit_code == code
        (line,) = done.stderr.splitlines()
        assert "the shard is missing" in line
        assert file in line
    assert contents_that_are_left(lib) == ["walks/01.amc", "walks/02.amc", "walks/03.amc"]


def contents_that_are_left(url: str) -> list[str]:
    left = []
    with mp.open_library(url) as library:
        for clip in library:
            try:
                clip.read_bytes()
            except mp.CorruptError:
                continue
            left.append(clip.name)
    return left


def test_damage_is_found(lib: str) -> None:
    (path, *_) = sorted(Path(lib, "shards").iterdir())
    data = bytearray(path.read_bytes())
    data[-200] ^= 1
    path.write_bytes(data)
    done = mocapress("library", "verify", lib)
    assert done.exit_code == 3
    assert "the shard is damaged" in done.stderr
    newest = max(Path(lib, "manifest").iterdir())
    newest.write_bytes(newest.read_bytes()[:-9])
    done = mocapress("library", "list", lib)
    assert done.exit_code == 1
    assert len(done.stderr.splitlines()) == 1
    assert "the manifest is damaged" in done.stderr


def test_a_folder_without_a_manifest_is_no_library(tmp_path: Path) -> None:
    done = mocapress("library", "list", tmp_path)
    assert (done.exit_code, done.stderr.count("\n")) == (1, 1)
    assert "there is no manifest" in done.stderr
    again = mocapress("library", "create", f"{tmp_path}/")
    assert again.exit_code == 0
    again = mocapress("library", "create", f"{tmp_path}/")
    assert "there is a library already" in again.stderr
    assert mocapress("library", "list", f"{tmp_path}/").output == ""


@pytest.mark.parametrize("size", [0, 1, 900, 989, 990, 1100, 2020, 5000, 40000])
def test_parts_of_a_database_give_its_values(tmp_path: Path, size: int) -> None:
    path = tmp_path / "db"
    path.write_bytes(schema.empty())
    values = {number: bytes([number]) * (size + number) for number in range(1, 60)}
    with closing(sqlite3.connect(path)) as connection:
        connection.executemany(
            "INSERT INTO texts VALUES(?, ?, ?)",
            [(number, number**9, value) for number, value in values.items()],
        )
        connection.commit()
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        sizes = {number: len(value) for number, value in values.items()}
        places = last_values(connection, path, "texts", sizes)
    data = path.read_bytes()
    for number, value in values.items():
        parts = [data[place.begin : place.begin + place.size] for place in places[number]]
        assert joined(parts, places[number], len(value), schema.PAGE) == value
        assert len(parts) <= 2


OPEN: list[mp.Library] = []


def inherited(name: str) -> bytes:
    return OPEN[0].read_bytes(name)


def test_a_fork_reads_on_its_own(lib: str, raw: Path) -> None:
    context = multiprocessing.get_context("fork")
    with mp.open_library(lib) as library:
        OPEN[:] = [library]
        with context.Pool(2) as pool:
            found = pool.map(inherited, ["walks/01.amc", "walks/02.amc", "walks/01.amc"])
        wanted = [(raw / f"walks/0{n}.amc").read_bytes() for n in (1, 2, 1)]
        assert found == wanted
        assert library.read_bytes("walks/01.amc") == wanted[0]


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("index_version", None),
        ("index_version", -(2**63)),
        ("signature", b"short"),
        ("features_size", -1),
        ("features_size", None),
        ("features_places", [1]),
        ("features_places", [0, 100, 0]),
        ("features_checksum", None),
    ],
)
def test_a_forged_index_is_not_used(tmp_path: Path, samples: Path, column: str, value: Any) -> None:
    url = f"{tmp_path / 'lib'}/"
    with mp.open_library(url, "a") as library:
        library.add(samples / "freebvh.bvh")
        rows = library.manifest.rows.to_pylist()  # type: ignore[attr-defined]
        forged = replace(
            library.manifest,  # type: ignore[attr-defined]
            rows=manifest.table_of([row | {column: value} for row in rows]),
        )
    max(Path(url, "manifest").iterdir()).write_bytes(forged.data)
    done = mocapress("search", url, samples / "freebvh.bvh")
    assert done.exit_code in (0, 1)
    assert "defect" not in done.stderr
    assert "freebvh.bvh" in (done.stderr if done.exit_code else done.stdout)


def test_a_search_reads_no_motion(tmp_path: Path, samples: Path) -> None:
    pytest.importorskip("pyarrow")
    url = f"{tmp_path / 'lib'}/"
    with mp.open_library(url, "a") as library:
        for name in ("mocapbank.bvh", "freebvh.bvh"):
            library.add(samples / name, codec="exact:level=1")
        library.add(mp.read(samples / "mocapbank.bvh")[200:], "later", index=False)
    one = tmp_path / "one.mocapdb"
    with mp.open_library(one, "a") as library:
        for name in ("mocapbank.bvh", "freebvh.bvh"):
            library.add(samples / name, codec="exact:level=1")
    query = mp.read(samples / "mocapbank.bvh")[100:200]
    with mp.open_library(url, "a") as library, mp.open_library(one) as expected:
        assert library.lacking() == 1
        assert library.search(query, within=True)[0].name == "mocapbank.bvh"  # "later" is read
        library.remove("later")
        assert library.lacking() == 0
        for within, mirror in ((True, False), (False, False), (False, True)):
            found = library.search(query, within=within, mirror=mirror)
            assert found == expected.search(query, within=within, mirror=mirror)
        count = library.db.connection.execute("SELECT count(*) FROM chunks").fetchone()[0]
        assert count == 0


def test_a_process_that_dies_is_told(lib: str) -> None:
    with executor(jobs=2) as where, pytest.raises(OSError, match="died"):
        where.call(os._exit, 1)


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("size", -1),
        ("id", 2**63 - 1),
        ("runs", [[1, 2]]),
        ("value_size", -1),
        ("value_places", [2**60, 2**60, 1]),
        ("value_places", [1]),
        ("skeleton_record", b"no skeleton"),
        ("head", b""),
        ("chunk_list", b"x"),
    ],
)
def test_a_forged_manifest_is_told(tmp_path: Path, samples: Path, column: str, value: Any) -> None:
    url = f"{tmp_path / 'lib'}/"
    with mp.open_library(url, "a") as library:
        library.add(samples / "freebvh.bvh")
        rows = library.manifest.rows.to_pylist()  # type: ignore[attr-defined]
        forged = replace(
            library.manifest,  # type: ignore[attr-defined]
            rows=manifest.table_of([row | {column: value} for row in rows]),
        )
    max(Path(url, "manifest").iterdir()).write_bytes(forged.data)
    done = mocapress("library", "cat", url, "freebvh.bvh")
    assert done.exit_code == 1
    assert len(done.stderr.splitlines()) == 1
    assert "defect" not in done.stderr
