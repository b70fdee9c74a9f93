"""Damaged files: what is not damaged comes back, and what is lost is named."""

from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.api import Opened
from mocapress.container import MczWriter
from mocapress.source import Source

AMC = b":FULLY-SPECIFIED\n:DEGREES\n" + b"".join(
    b"%d\nroot %.3f %.3f 3 4 5 6\nhip %.2f -0.125\n" % (i, 0.5 * i, i % 7, np.sin(0.1 * i))
    for i in range(1, 401)
)
CODEC = "exact:chunk=100"
HURT = 137


def entries(blob: bytes) -> list[tuple[int, int]]:
    return [(entry.begin, entry.end) for entry in Opened(Source(blob)).mcz.entries]


@pytest.fixture(scope="module")
def blob(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("walk") / "walk.amc"
    path.write_bytes(AMC)
    made = mp.compress(path, CODEC)
    assert len(entries(made)) == 4
    return made


def damaged(blob: bytes, chunk: int, *, cut: bool = False) -> bytes:
    """Flip a bit in the middle of a chunk, or take the chunk out."""
    begin, end = entries(blob)[chunk]
    if cut:
        return blob[:begin] + blob[end:]
    hurt = bytearray(blob)
    hurt[(begin + end) // 2] ^= 4
    return bytes(hurt)


@pytest.mark.parametrize("chunk", range(4))
def test_only_the_damaged_chunk_is_lost(blob: bytes, chunk: int) -> None:
    hurt, whole = damaged(blob, chunk), mp.load(blob)
    with pytest.raises(mp.CorruptError, match=f"frames {100 * chunk} to {100 * chunk + 99}"):
        mp.load(hurt)
    with pytest.warns(mp.MotionWarning, match=f"frames {100 * chunk} to {100 * chunk + 99}"):
        clip = mp.load(hurt, errors="skip")
    lost = np.isnan(clip.values).all(axis=1)
    assert np.flatnonzero(lost).tolist() == list(range(100 * chunk, 100 * chunk + 100))
    assert clip.values[~lost].tobytes() == whole.values[~lost].tobytes()
    part = slice(100 * chunk + 100, 400) if chunk < 3 else slice(0, 300)
    assert mp.load(hurt, part).values.tobytes() == whole.values[part].tobytes()


@pytest.mark.parametrize("chunk", range(4))
def test_a_salvaged_file_leaves_the_lost_rows_out(blob: bytes, chunk: int, tmp_path: Path) -> None:
    hurt = damaged(blob, chunk)
    with pytest.raises(mp.CorruptError):
        mp.decompress(hurt)
    with pytest.warns(mp.MotionWarning, match=f"frames {100 * chunk} to {100 * chunk + 99}"):
        text = mp.decompress(hurt, salvage=True)
    begin, end = AMC.index(b"\n%d\n" % (100 * chunk + 1)) + 1, len(AMC)
    if chunk < 3:
        end = AMC.index(b"\n%d\n" % (100 * chunk + 101)) + 1
    assert text == AMC[:begin] + AMC[end:]


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
def test_a_salvaged_lossy_file_leaves_the_lost_rows_out(tmp_path: Path) -> None:
    path = tmp_path / "walk.amc"
    path.write_bytes(AMC)
    blob = mp.compress(path, "near:max=0.1deg,chunk=100")
    rows = mp.decompress(blob).split(b"\nroot ")
    found = mp.decompress(damaged(blob, 1), salvage=True).split(b"\nroot ")
    assert (len(rows), len(found)) == (401, 301)
    assert found[101:] == rows[201:]
    assert b"nan" not in b"".join(found)


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
def test_a_chunk_that_is_gone_is_found(blob: bytes) -> None:
    """The end says where it stood: then nothing fits, and the file is walked."""
    hurt = damaged(blob, 1, cut=True)
    with pytest.raises(mp.CorruptError):
        mp.load(hurt)
    with pytest.warns(mp.MotionWarning, match="frames 100 to 199"):
        clip = mp.load(hurt, errors="skip")
    assert np.flatnonzero(np.isnan(clip.values[:, 0])).tolist() == list(range(100, 200))


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
def test_of_a_file_cut_off_the_chunks_before_are_left(blob: bytes) -> None:
    whole, places = mp.load(blob).values, entries(blob)
    for length in range(places[0][0], len(blob), 7):
        with pytest.raises(mp.CorruptError):
            mp.load(blob[:length])
        clip = mp.load(blob[:length], errors="skip")
        kept = 100 * sum(end <= length for _, end in places)
        assert clip.values[:kept].tobytes() == whole[:kept].tobytes()
        assert np.isnan(clip.values[kept:]).all()


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
def test_whatever_bit_flips_nothing_wrong_comes_out(blob: bytes) -> None:
    whole = mp.load(blob).values
    for bit in range(0, 8 * len(blob), HURT):
        hurt = bytearray(blob)
        hurt[bit // 8] ^= 1 << bit % 8
        try:
            clip = mp.load(bytes(hurt), errors="skip")
        except mp.MocapressError:
            continue
        lost = np.isnan(clip.values).any(axis=1)
        assert clip.values[~lost].tobytes() == whole[~lost].tobytes()
        assert lost.sum() <= 100


def test_without_its_layout_the_numbers_are_left(blob: bytes) -> None:
    opened = Opened(Source(blob))
    assert opened.mcz.original is not None
    place = blob.index(opened.mcz.original.digest)
    hurt = blob[:place] + bytes(32) + blob[place + 32 :]
    with pytest.warns(mp.MotionWarning, match="section file"):
        assert mp.load(hurt, errors="skip").values.tobytes() == mp.load(blob).values.tobytes()
    with pytest.raises(mp.CorruptError, match="layout is damaged"):
        mp.decompress(hurt, salvage=True)


def test_values_that_are_not_those_that_were_coded_are_found(blob: bytes) -> None:
    """A digest that does not fit what is decoded, behind right checksums, costs its chunk."""
    opened = Opened(Source(blob))
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    assert opened.mcz.head is not None
    assert opened.mcz.original is not None
    writer.head(opened.mcz.head)
    writer.original(opened.mcz.original)
    for index, entry in enumerate(opened.mcz.entries):
        chunk = opened.mcz.read_chunk(entry)
        writer.chunk(chunk._replace(digest=chunk.digest ^ (index == 2)))
    writer.end()
    forged = b"".join(parts)
    with pytest.raises(mp.CorruptError, match="frames 200 to 299: wrong digest"):
        mp.decompress(forged)
    with pytest.warns(mp.MotionWarning, match="wrong digest"):
        assert np.isnan(mp.load(forged, errors="skip").values[200:300]).all()


def test_verify_says_which(blob: bytes) -> None:
    assert mp.verify(blob).damage == ()
    (damage,) = mp.verify(damaged(blob, 2)).damage
    assert damage.where == "frames 200 to 299 of stream motion"
    assert "checksum" in damage.error.what
    with pytest.raises(mp.CorruptError):
        mp.verify(b"no such file")
