"""The Python interface of a library."""

import os
import pickle
import shutil
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.library import Library

AMC, BVH, BANK = "cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"


@pytest.fixture
def three(samples: Path, library: Library) -> Library:
    library.add(samples / AMC, "cmu/01.amc", labels=["walk"], notes={"license": "free"})
    library.add(samples / BVH, "other/free.bvh", labels=["walk", "odd"])
    library.add(samples / BANK, "other/bank.bvh")
    return library


def test_clips_are_found(three: Library) -> None:
    def names(*args: str, **more: object) -> list[str]:
        return [clip.name for clip in three.clips(*args, **more)]  # type: ignore[arg-type]

    every = ["cmu/01.amc", "other/bank.bvh", "other/free.bvh"]
    assert names() == every == [clip.name for clip in three]
    assert names("other") == names("other/*") == names("other/") == every[1:]
    assert names("*.bvh") == every[1:]
    assert names("cmu/01.amc") == every[:1]
    assert names("cmu/0") == []
    assert names(label="walk") == ["cmu/01.amc", "other/free.bvh"]
    assert names(min_duration=10) == ["other/bank.bvh"]
    assert names(skeleton="VIC*") == ["cmu/01.amc"]
    assert [clip.name for clip in three.clips(["cmu", "*bank*"])] == every[:2]
    assert three.labels == {"odd": 1, "walk": 2}
    assert len(three) == 3
    assert three[0].name == every[0]
    assert three[-1].name == every[-1]
    assert [clip.name for clip in three[1:]] == every[1:]
    assert "cmu/01.amc" in three
    assert "cmu" not in three
    with pytest.raises(KeyError):
        three["cmu"]
    with pytest.raises(IndexError):
        three[3]
    three.close()


def test_a_clip_says_what_it_is(three: Library, samples: Path) -> None:
    clip = three["other/bank.bvh"]
    assert (clip.frames, clip.channels, clip.format, clip.codec) == (455, 60, "bvh", "exact")
    assert clip.duration == pytest.approx(455 * 0.033333)
    assert clip.size == (samples / BANK).stat().st_size
    assert three["cmu/01.amc"].notes == {"license": "free"}
    assert three["cmu/01.amc"].skeleton == "VICON"
    assert clip.read_bytes() == (samples / BANK).read_bytes()
    three.label(clip, "slow", "odd", remove=["walk"])
    assert three["other/bank.bvh"].labels == ("odd", "slow")
    with pytest.raises(mp.ParameterError, match="label"):
        three.label(clip, "a,b")
    three.close()


def test_loading_frames_and_columns(three: Library, samples: Path) -> None:
    whole = mp.read(samples / AMC)
    for frames in (slice(0, 1), slice(500, 530), slice(2750, None), slice(100, 0, -7)):
        part = three.load("cmu/01.amc", frames)
        assert np.array_equal(part.values, whole[frames].values)
    some = three.load("cmu/01.amc", slice(5, 9), columns=["lfemur.*", "root.tx"])
    assert [column.name for column in some.columns] == [
        *("lfemur.rx", "lfemur.ry", "lfemur.rz", "root.tx")
    ]
    places = [[c.name for c in whole.columns].index(column.name) for column in some.columns]
    assert np.array_equal(some.values, whole.values[5:9, places])
    with pytest.raises(mp.ParameterError, match="no such column"):
        three.load("cmu/01.amc", columns=["nose"])
    with pytest.raises(mp.ParameterError, match="no such clip"):
        three.load("cmu/02.amc")
    three.close()


def test_loading_some_frames_reads_only_their_chunks(three: Library) -> None:
    with three.db.writing() as connection:
        connection.execute(
            "UPDATE chunks SET sections = CAST(substr(sections, 1, length(sections) - 40000) "
            "|| zeroblob(40000) AS BLOB) WHERE clip = 1"
        )
    assert three.load("cmu/01.amc", slice(0, 1000)).frames == 1000
    with pytest.raises(mp.CorruptError):
        three.load("cmu/01.amc")
    three.close()


def test_modes(tmp_path: Path, samples: Path) -> None:
    path = tmp_path / "lib.mocapdb"
    with pytest.raises(FileNotFoundError):
        mp.open_library(path)
    with pytest.raises(mp.ParameterError, match="mode"):
        mp.open_library(path, "w")
    with mp.open_library(path, "a") as library:
        library.add(samples / BVH)
    with mp.open_library(path) as library:
        with pytest.raises(mp.ParameterError, match="reading only"):
            library.add(samples / BANK)
        with pytest.raises(mp.ParameterError, match="reading only"):
            library.remove(BVH)
    with pytest.raises(mp.ParameterError, match="closed"):
        len(library)
    path.write_bytes(b"SQLite format 3\0" + bytes(1000))
    with pytest.raises(mp.CorruptError):
        mp.open_library(path)
    path.write_bytes((samples / BVH).read_bytes())
    with pytest.raises(mp.CorruptError, match="damaged"):
        mp.open_library(path, "a")
    assert path.read_bytes() == (samples / BVH).read_bytes()


def test_other_databases_and_later_versions_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "lib.mocapdb"
    with mp.open_library(path, "a") as library:
        connection = library.db.connection
        connection.execute("PRAGMA user_version = 99")
    with pytest.raises(mp.UnsupportedError, match="expected 5; found 99"):
        mp.open_library(path)
    path.unlink()
    with mp.open_library(path, "a") as library:
        library.db.connection.execute("CREATE TRIGGER t AFTER INSERT ON clips BEGIN SELECT 1; END")
    with pytest.raises(mp.CorruptError, match="trigger t"):
        mp.open_library(path)
    path.unlink()
    with mp.open_library(path, "a") as library:
        library.db.connection.execute("PRAGMA application_id = 1")
    with pytest.raises(mp.CorruptError, match="not a library"):
        mp.open_library(path)


def test_newer_versions_take_older_files_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, samples: Path
) -> None:
    from mocapress.library import schema

    path = tmp_path / "lib.mocapdb"
    with mp.open_library(path, "a") as library:
        library.add(samples / BVH)
    later = [*schema.MIGRATIONS, schema.Migration("more", ["CREATE TABLE more(a TEXT) STRICT"])]
    monkeypatch.setattr(schema, "MIGRATIONS", later)
    with mp.open_library(path) as library:
        assert library.read_bytes(BVH)
    with mp.open_library(path, "a") as library:
        assert library.db.connection.execute(
            "SELECT version, name FROM migrations ORDER BY 1"
        ).fetchall() == [
            (1, "create"),
            (2, "needs"),
            (3, "search"),
            (4, "settings"),
            (5, "alike"),
            (6, "more"),
        ]
        assert library.read_bytes(BVH)


def test_threads_and_processes_share_a_library(three: Library, samples: Path) -> None:
    expected = {
        "cmu/01.amc": (samples / AMC).read_bytes(),
        "other/free.bvh": (samples / BVH).read_bytes(),
        "other/bank.bvh": (samples / BANK).read_bytes(),
    }
    with ThreadPoolExecutor(4) as pool:
        for name, data in zip(expected, pool.map(three.read_bytes, expected), strict=True):
            assert data == expected[name]
    copy = pickle.loads(pickle.dumps(three))
    assert copy.read_bytes("other/bank.bvh") == expected["other/bank.bvh"]
    copy.close()
    child = os.fork()
    if not child:
        os._exit(three.read_bytes("other/bank.bvh") != expected["other/bank.bvh"])
    assert os.waitpid(child, 0)[1] == 0
    assert three.read_bytes("cmu/01.amc") == expected["cmu/01.amc"]
    three.close()
    assert not Path(f"{three.path}-wal").exists()


def test_readers_go_on_while_one_writes(three: Library, samples: Path) -> None:
    with three.db.writing() as connection:
        connection.execute("DELETE FROM chunks WHERE clip = 2")
        with mp.open_library(three.path) as reader:
            assert reader.read_bytes("other/free.bvh") == (samples / BVH).read_bytes()
        connection.execute("ROLLBACK")
        connection.execute("BEGIN")
    with three.db.reading():
        assert len(three) == 3
        with mp.open_library(three.path, "a") as writer:
            writer.remove("other/free.bvh")
        assert len(three) == 3  # as it was when reading began
    assert len(three) == 2
    three.close()


def test_a_second_writer_waits_and_then_gets_an_error(three: Library, samples: Path) -> None:
    begun, end = threading.Event(), threading.Event()

    def write() -> None:
        with three.db.writing():
            begun.set()
            end.wait()

    writer = threading.Thread(target=write)
    writer.start()
    begun.wait()
    with mp.open_library(three.path, "a", wait=0.2) as second:
        with pytest.raises(mp.BusyError, match=r"another process.*done within 0\.2 s"):
            second.remove("other/free.bvh")
        waiting = threading.Timer(0.3, end.set)
        waiting.start()
        second.db.wait = 20
        second.db.connection.execute("PRAGMA busy_timeout = 20000")
        second.remove("other/free.bvh")
    writer.join()
    assert len(three) == 2
    three.close()


def test_read_only_media(three: Library, samples: Path, tmp_path: Path) -> None:
    three.close()
    folder = tmp_path / "disc"
    folder.mkdir()
    shutil.copy(three.path, folder / "lib.mocapdb")
    (folder / "lib.mocapdb").chmod(0o444)
    folder.chmod(0o555)
    # What is imported lazily is imported before the rights are given away.
    code = (
        "import os, sys\nimport mocapress as mp\n"
        "with mp.open_library(sys.argv[1]) as lib: lib.read_bytes('other/free.bvh')\n"
        "if os.getuid() == 0: os.setgid(65534); os.setuid(65534)\n"
        "with mp.open_library(sys.argv[1]) as lib: print(len(lib.read_bytes('other/free.bvh')))\n"
        "try: mp.open_library(sys.argv[1], 'a')\nexcept PermissionError as error: print(error)\n"
    )
    if os.getuid() == 0:  # another user must be able to come here, and to import
        place = Path("/tmp") / f"mocapress-disc-{os.getpid()}"
        shutil.move(folder, place)
        folder = place
    try:
        done = subprocess.run(
            [sys.executable, "-c", code, folder / "lib.mocapdb"],
            capture_output=True,
            text=True,
            check=False,
        )
        size, denied = done.stdout.splitlines()
        assert int(size) == (samples / BVH).stat().st_size, done.stderr
        assert "Permission denied" in denied
        assert [path.name for path in folder.iterdir()] == ["lib.mocapdb"]
    finally:
        folder.chmod(0o755)
        shutil.rmtree(folder)


def test_any_sqlite_tool_reads_it(three: Library) -> None:
    import sqlite3

    three.close()
    connection = sqlite3.connect(f"file:{three.path}?mode=ro&immutable=1", uri=True)
    rows = connection.execute(
        "SELECT name, format, frames, skeleton, labels, size FROM catalogue ORDER BY name"
    ).fetchall()
    connection.close()
    assert rows[0] == ("cmu/01.amc", "amc", 2751, "VICON", "walk", 2198779)
    assert rows[2][4] == "odd,walk"


def test_to_pandas(three: Library) -> None:
    pandas = pytest.importorskip("pandas")
    table = three.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    assert list(table["frames"]) == [2751, 455, 69]
    three.close()
