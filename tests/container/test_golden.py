"""Files of every version stay readable: tests/golden/README.md."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

import mocapress as mp
from mocapress.api import Opened
from mocapress.codecs import codec_ids
from mocapress.source import Source

GOLDEN = Path(__file__).parents[1] / "golden"
FILES = sorted(GOLDEN.glob("*.mcz"))
ORIGINALS = [path for path in FILES if path.with_suffix("").exists()]
RECORDED = [path for path in FILES if path not in ORIGINALS]


def values(path: Path) -> bytes:
    """Give the numbers of all streams."""
    streams = mp.load(path, strict=False).streams.values()
    return b"".join(stream.values.tobytes() for stream in streams)


@pytest.mark.parametrize("path", ORIGINALS, ids=lambda path: path.name)
def test_originals_come_back(path: Path) -> None:
    back = path.with_suffix(".back")
    original = back if back.exists() else path.with_suffix("")
    assert mp.decompress(path) == original.read_bytes()
    assert not mp.verify(path).damage


@pytest.mark.filterwarnings("ignore:.*not closed:mocapress.MotionWarning")
@pytest.mark.parametrize("path", RECORDED, ids=lambda path: path.name)
def test_numbers_come_back(path: Path) -> None:
    assert values(path) == path.with_suffix(".f64").read_bytes()
    with pytest.raises(mp.UnsupportedError, match="no original file"):
        mp.decompress(path)


def test_companions_and_notes_come_back() -> None:
    (companion,) = Opened(Source(GOLDEN / "v1_embedded.amc.mcz")).mcz.companions
    assert companion.data == (GOLDEN / "v1_embedded.companion").read_bytes()
    assert mp.load(GOLDEN / "v1_walk_lf.amc.mcz").metadata["license"] == "Apache-2.0"


def test_there_is_a_file_of_everything() -> None:
    opened = [Opened(Source(path)) for path in FILES]
    codecs = {stream.codec.id for one in opened for stream in one.streams}
    assert codecs == set(codec_ids())
    originals = [one.mcz.original for one in opened if one.mcz.original]
    kinds = {"amc", "bvh", "c3d", "csv", "npy", "npz", "trc", ""}
    assert {original.format for original in originals} == kinds
    assert any(original.problems for original in originals)
    assert any(one.mcz.notes for one in opened)
    assert any(one.mcz.companions for one in opened)
    assert any(stream.model for one in opened for stream in one.streams)
    assert any(len(one.streams) > 1 for one in opened)
    assert any(entry.own_header for one in opened for entry in one.mcz.entries)
    assert {one.mcz.closed for one in opened} == {True, False}
    in_chunks = [one for one in opened if one.streams and len(one.mcz.of_stream[0]) >= 3]
    assert {one.streams[0].codec.id for one in in_chunks} == set(codec_ids())


@pytest.mark.skipif(shutil.which("file") is None, reason="needs file(1)")
def test_file_knows_them(tmp_path: Path) -> None:
    page = (GOLDEN.parents[1] / "docs/format.md").read_text()
    (magic,) = re.findall(r"```\n(0\tstring.*?)```", page, re.DOTALL)
    (tmp_path / "magic").write_text(magic)
    for name, kind in (
        ("v1_walk.bvh.mcz", "mocapress motion capture, version 1"),
        ("v1_learner.mcm", "mocapress model, version 1"),
    ):
        command = ["file", "-b", "-m", str(tmp_path / "magic"), str(GOLDEN / name)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert done.stdout.strip() == kind
