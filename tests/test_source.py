"""Whatever a user names is read alike: a path, bytes, a stream; whole or in ranges."""

import gc
import io
import os
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

import mocapress as mp
from mocapress.source import Source

GOLDEN = Path(__file__).parent / "golden"


def through_fifo(path: Path) -> Path:
    """Give a FIFO into which the file's bytes are written."""
    fifo = path.with_suffix(".fifo")
    os.mkfifo(fifo)
    threading.Thread(target=lambda: fifo.write_bytes(path.read_bytes())).start()
    return fifo


WAYS: dict[str, Callable[[Path], object]] = {
    "path": lambda path: path,
    "text": str,
    "bytes": Path.read_bytes,
    "bytearray": lambda path: bytearray(path.read_bytes()),
    "memoryview": lambda path: memoryview(path.read_bytes()),
    "stream": lambda path: io.BytesIO(path.read_bytes()),
    "fifo": through_fifo,
}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_all_ways_to_name_a_file_give_the_same(
    samples: Path, tmp_path: Path, way: Callable[[Path], object]
) -> None:
    data = (samples / "freebvh.bvh").read_bytes()
    files = {"motion": tmp_path / "walk.bvh", "packed": tmp_path / "walk.mcz"}
    files["motion"].write_bytes(data)
    files["packed"].write_bytes(mp.compress(data))
    motion = mp.read(way(files["motion"]))  # type: ignore[arg-type]
    assert motion.values.tobytes() == mp.read(data).values.tobytes()
    files["motion"].with_suffix(".fifo").unlink(missing_ok=True)
    assert mp.decompress(mp.compress(way(files["motion"]))) == data  # type: ignore[arg-type]
    files["motion"].with_suffix(".fifo").unlink(missing_ok=True)
    assert mp.decompress(way(files["packed"])) == data  # type: ignore[arg-type]
    files["packed"].with_suffix(".fifo").unlink(missing_ok=True)
    loaded = mp.load(way(files["packed"]))  # type: ignore[arg-type]
    assert loaded.values.tobytes() == motion.values.tobytes()


def test_an_open_file_is_known_by_its_name(tmp_path: Path) -> None:
    file = tmp_path / "no_keywords.amc"
    file.write_bytes(b"1\nroot 1 2 3 4 5 6\n")
    with file.open("rb") as stream:
        clip = mp.read(stream)
    assert (clip.frames, clip.name) == (1, "no_keywords")


def test_a_stream_of_text_is_refused(samples: Path) -> None:
    with (
        (samples / "freebvh.bvh").open() as stream,
        pytest.raises(mp.ParameterError, match="bytes"),
    ):
        mp.read(stream)  # type: ignore[arg-type]


def test_a_folder_is_refused_by_its_name(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError) as caught:
        mp.read(tmp_path)
    assert caught.value.filename == str(tmp_path)


def test_ranges_are_read_alone(tmp_path: Path) -> None:
    file = tmp_path / "digits"
    file.write_bytes(b"0123456789")
    for source in (Source(file), Source(b"0123456789")):
        assert source.size == 10
        assert source.read(2, 5) == b"234"
        assert source.read(8) == b"89"
        assert source.read(8, 20) == b"89"
        assert source.read(3, 3) == b""
        assert source.read() == source.data == b"0123456789"


def test_a_file_that_is_cut_while_it_is_read_is_an_error(samples: Path, tmp_path: Path) -> None:
    file = tmp_path / "walk.mcz"
    file.write_bytes(mp.compress(samples / "freebvh.bvh"))
    source = Source(file)
    assert source.kind == "mcz"
    with file.open("r+b") as cut:
        cut.truncate(file.stat().st_size // 2)
    with pytest.raises(mp.CorruptError):
        mp.decompress(source)


def test_a_file_that_is_replaced_meanwhile_is_read_as_it_was(tmp_path: Path) -> None:
    file, other = tmp_path / "a", tmp_path / "b"
    file.write_bytes(b"old")
    other.write_bytes(b"new")
    source = Source(file)
    other.replace(file)
    assert source.read() == b"old"


def test_no_file_stays_open(tmp_path: Path) -> None:
    file = tmp_path / "walk.bvh"
    file.write_bytes((GOLDEN / "v1_walk.bvh").read_bytes())
    gc.collect()
    before = len(list(Path("/proc/self/fd").iterdir()))
    for _ in range(3):
        mp.compress(file)
        with pytest.raises(mp.MocapressError):
            mp.load(file)
    assert len(list(Path("/proc/self/fd").iterdir())) <= before


@pytest.mark.parametrize(
    ("data", "name", "kind"),
    [
        (b"HIERARCHY\n", "", "bvh"),
        (b"\xef\xbb\xbf\r\n hierarchy\n", "x.amc", "bvh"),
        (b":version 1.10\n", "", "asf"),
        (b"# made by\n:DEGREES\n1\n", "", "amc"),
        (b"1\nroot 1\n", "walk.AMC", "amc"),
        (b'{"channels":[]}', "", "diffma.json"),
        (b"anything", "walk.diffma.json.xz", "diffma.json"),
        (b"anything", "walk.txt", ""),
        (b"", "", ""),
    ],
)
def test_the_kind_follows_from_contents_then_from_the_name(
    data: bytes, name: str, kind: str
) -> None:
    assert Source(data, name).kind == kind


def test_files_of_our_own_are_known_by_their_contents(samples: Path) -> None:
    assert Source(mp.compress(b"1 2 3")).kind == "mcz"
    assert Source((GOLDEN / "v1_learner.mcm").read_bytes(), "x.bvh").kind == "mcm"
