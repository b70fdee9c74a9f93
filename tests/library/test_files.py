"""What goes into a library comes out: every byte, the names, the times."""

import os
import shutil
import tarfile
from pathlib import Path

import numpy as np
import pytest
from running import mocapress, process

import mocapress as mp
from mocapress.library import Library

AMC, BVH = "cmu_01_01.amc", "freebvh.bvh"


@pytest.fixture
def clips(samples: Path, tmp_path: Path) -> Path:
    """Folders with AMC and ASF, BVH, what cannot be read as motion, and no motion at all."""
    folder = tmp_path / "clips"
    (folder / "01").mkdir(parents=True)
    (folder / "bvh" / "deep").mkdir(parents=True)
    for name in (AMC, "cmu_01_01.asf"):
        shutil.copy(samples / name, folder / "01")
    shutil.copy(samples / BVH, folder / "bvh" / "deep")
    (folder / "bvh" / "cut off.bvh").write_bytes((samples / BVH).read_bytes()[:3000])
    (folder / "bvh" / "none.bvh").write_bytes(b"no motion at all")
    (folder / "bvh" / "empty.bvh").write_bytes(b"")
    (folder / "bvh" / "one number.amc").write_bytes(b":FULLY-SPECIFIED\n1\nroot 1 2 3\n")
    os.utime(folder / "01" / AMC, ns=(1, 1_234_567_890_123_456_789))
    return folder


def contents(folder: Path) -> dict[str, tuple[bytes, int]]:
    return {
        str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.parametrize("jobs", [1, 3])
def test_folders_come_back_with_names_bytes_and_times(
    clips: Path, tmp_path: Path, jobs: int
) -> None:
    library, out = tmp_path / "library.mocapdb", tmp_path / "out"
    assert mocapress("library", "add", library, clips, "-j", jobs).exit_code == 0
    assert mocapress("library", "extract", library, "-o", out, "-j", jobs).exit_code == 0
    assert contents(out) == contents(clips)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["clips", "library.mocapdb", "out"]


def test_a_second_add_adds_what_is_new_or_changed(clips: Path, tmp_path: Path) -> None:
    library = tmp_path / "library.mocapdb"
    mocapress("library", "add", library, clips)
    before = library.stat().st_size
    again = mocapress("library", "add", library, clips)
    assert again.output == f"{library}: 7 unchanged; {again.output.split('; ')[1]}"
    assert library.stat().st_size == before
    changed = clips / "bvh" / "none.bvh"
    changed.write_bytes(b"still no motion")
    (clips / "new.bvh").write_bytes((clips / "bvh" / "deep" / BVH).read_bytes() + b"\n")
    third = mocapress("library", "add", library, clips)
    assert "1 added, 1 replaced, 6 unchanged" in third.output
    with mp.open_library(library) as found:
        assert found.read_bytes("bvh/none.bvh") == b"still no motion"
        assert not found.verify()


def test_a_clip_whose_skeleton_has_changed_is_added_again(clips: Path, tmp_path: Path) -> None:
    library, asf = tmp_path / "library.mocapdb", clips / "01" / "cmu_01_01.asf"
    mocapress("library", "add", library, clips)
    mocapress("library", "label", library, "01", "--add", "kept")
    asf.write_bytes(asf.read_bytes().replace(b"length 0.45", b"length 0.5", 1))
    second = mocapress("library", "add", library, clips)
    assert f"{AMC}: replaced" in second.output
    with mp.open_library(library) as found:
        assert mp.positions(found.load(f"01/{AMC}")).tobytes() == (
            mp.positions(mp.read(clips / "01" / AMC)).tobytes()
        )
        assert found[f"01/{AMC}"].labels == ("kept",)
        assert not found.verify()
    assert "7 unchanged" in mocapress("library", "add", library, clips).output
    asf.write_bytes(b"broken")  # nothing to be had from that
    third = mocapress("library", "add", library, clips / "01" / AMC, "--into", "01")
    assert (third.exit_code, third.output) == (0, "")  # as it is


def test_two_archives_with_files_of_one_name(clips: Path, tmp_path: Path) -> None:
    library = tmp_path / "library.mocapdb"
    archives = [tmp_path / "one.tar", tmp_path / "two.tar.gz"]
    for archive, text in zip(archives, (b"", b"\n"), strict=True):
        (clips / "bvh" / "deep" / BVH).write_bytes(
            (clips / "bvh" / "deep" / BVH).read_bytes() + text
        )
        with tarfile.open(archive, "w:gz" if archive.suffix == ".gz" else "w") as made:
            made.add(clips / "bvh" / "deep" / BVH, "free.bvh")
    first = (clips / "bvh" / "deep" / BVH).read_bytes()[:-1]
    done = mocapress("library", "add", library, *archives)
    assert done.exit_code == 2
    assert "two.tar.gz: free.bvh" in done.output
    assert "--into" in done.output
    with mp.open_library(library) as found:
        assert found.read_bytes("free.bvh") == first
    assert mocapress("library", "add", library, archives[1]).exit_code == 0
    with mp.open_library(library) as found:
        assert found.read_bytes("free.bvh") == first + b"\n"


def test_only_the_time_has_changed(clips: Path, tmp_path: Path) -> None:
    library = tmp_path / "library.mocapdb"
    mocapress("library", "add", library, clips)
    os.utime(clips / "01" / AMC, ns=(5, 5_000_000_000))
    assert "7 unchanged" in mocapress("library", "add", library, clips).output
    with mp.open_library(library) as found:
        assert found[f"01/{AMC}"].modified == 5_000_000_000


def test_names_need_not_be_utf_8(clips: Path, tmp_path: Path) -> None:
    odd = os.fsdecode(os.fsencode(clips) + b"/caf\xe9 \xff[1]*.bvh")
    Path(odd).write_bytes((clips / "bvh" / "deep" / BVH).read_bytes())
    library, out = tmp_path / "library.mocapdb", tmp_path / "out"
    assert process("library", "add", library, clips).returncode == 0
    assert process("library", "extract", library, "-o", out).returncode == 0
    assert contents(out) == contents(clips)
    listed = process("library", "list", library).stdout.splitlines()
    assert os.fsencode(Path(odd).name) in listed
    with mp.open_library(library) as found:
        assert len(found.clips(Path(odd).name)) == 1


@pytest.mark.parametrize("name", ["", "/a", "a/../b", "..", "a//b", "a/", "./a", "a\0b"])
def test_names_lead_nowhere_else(library: Library, name: str) -> None:
    with pytest.raises(mp.ParameterError, match="name"):
        library.add(b"some bytes", name)
    library.close()


def test_a_name_that_leads_elsewhere_is_not_extracted(clips: Path, tmp_path: Path) -> None:
    file = tmp_path / "library.mocapdb"
    with mp.open_library(file, "a") as library:
        library.add(clips / "bvh" / "deep" / BVH, "x")
        with library.db.writing() as connection:
            connection.execute("UPDATE clips SET name = '../x'")
    done = mocapress("library", "extract", file, "-o", tmp_path / "out")
    assert done.exit_code == 1
    assert "not a name for a clip" in done.output
    assert not (tmp_path / "x").exists()


def test_mcz_files_come_back_as_they_were(samples: Path, library: Library, tmp_path: Path) -> None:
    blobs = {
        "amc": mp.compress(samples / AMC, embed_asf=True),
        "bare": mp.compress(samples / AMC, "exact:level=1"),
        "bvh": mp.compress(samples / BVH, "app", notes={"license": "CC0"}),
        "lossy": mp.compress(samples / BVH, "diffma:max_error=0.5"),
        "bytes": mp.compress(b"1 2 3"),
        "clip": mp.compress(mp.read(samples / BVH)),
    }
    with mp.writer(tmp_path / "recording.mcz", mp.read(samples / BVH).columns, 30) as recording:
        recording.append(mp.read(samples / BVH).values)
    blobs["recording"] = (tmp_path / "recording.mcz").read_bytes()
    for name, blob in blobs.items():
        library.add(blob, name)
    for name, blob in blobs.items():
        assert library.read_mcz(name) == blob, name
        if name not in ("bytes",):
            assert library.load(name).values.tobytes() == mp.load(blob).values.tobytes()
    assert not library.verify()
    assert not library.check()
    library.close()


def test_a_clip_needs_the_model_that_the_library_keeps(
    samples: Path, library: Library, learner: str
) -> None:
    model = mp.train([samples / BVH], learner)
    library.add(samples / BVH, codec=learner, model=model)
    blob = library.read_mcz(BVH)
    library.close()
    with mp.open_library(library.path) as found:
        assert found.read_bytes(BVH) == (samples / BVH).read_bytes()
    with pytest.raises(mp.MissingModelError):
        mp.decompress(blob)
    assert mp.decompress(blob, models=[model]) == (samples / BVH).read_bytes()


def test_clips_of_numbers_have_no_file(samples: Path, library: Library) -> None:
    clip = mp.read(samples / BVH)
    library.add(clip)
    assert np.array_equal(library.load(clip.name).values, clip.values)
    assert library.load(clip.name).skeleton == clip.skeleton
    with pytest.raises(mp.UnsupportedError, match="no original file"):
        library.read_bytes(clip.name)
    library.close()


def test_a_skeleton_is_kept_once_and_used(samples: Path, library: Library) -> None:
    library.add(samples / AMC, "a/1.amc")
    library.add(samples / AMC, "a/2.amc")
    clip = library.load("a/2.amc", slice(10, 20))
    assert np.array_equal(mp.positions(clip), mp.positions(mp.read(samples / AMC)[10:20]))
    with library.db.reading() as connection:
        assert connection.execute("SELECT count(*) FROM skeletons").fetchone() == (1,)
        assert connection.execute("SELECT name FROM companions").fetchall() == [
            ("a/cmu_01_01.asf",)
        ]
    library.remove("a/1.amc")
    assert library.load("a/2.amc").skeleton is not None
    library.remove("a/2.amc")
    with library.db.reading() as connection:
        for table in ("clips", "chunks", "texts", "skeletons", "companions", "runs", "anchors"):
            assert connection.execute(f"SELECT count(*) FROM {table}").fetchone() == (0,)
    library.close()


@pytest.mark.corpus
def test_a_sample_of_the_corpus_comes_back(
    corpus: Path, corpus_clips: list[Path], library: Library
) -> None:
    names = [str(path.relative_to(corpus)) for path in corpus_clips][::12]
    for name in names:
        library.add(corpus / name, name, codec="exact:level=1")
    for name in names:
        assert library.read_bytes(name) == (corpus / name).read_bytes()
    assert not library.verify()
    library.close()
