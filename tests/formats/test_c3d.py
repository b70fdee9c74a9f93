"""C3D files of every encoding come back byte for byte, and say what they hold."""

import contextlib
import json
import os
import time
import tracemalloc
import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from c3d_files import DEC, INTEL, MIPS, c3d, swapped, walk

import mocapress as mp
from mocapress.formats.c3d import split
from mocapress.formats.c3d_layout import C3dLayout, read_layout
from mocapress.formats.c3d_parameters import described
from mocapress.motion import Clip, Stream
from mocapress.source import Source

ENCODINGS = [(processor, floats) for processor in (INTEL, DEC, MIPS) for floats in (True, False)]


def again(data: bytes) -> bytes:
    """Take a file apart and put it together again, by way of the stored layout."""
    parts = split(data, None, None)
    assert parts.stored is not None
    streams = [stream.values for stream in parts.clip.streams.values()]
    return read_layout(parts.stored.record()).join(streams)


@pytest.mark.parametrize(("processor", "floats"), ENCODINGS)
def test_every_encoding_comes_back_and_says_the_same(processor: int, floats: bool) -> None:
    points, words, analog = walk(floats=floats)
    data = c3d(points, words, analog, processor=processor, floats=floats, samples=4)
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    for clip in (mp.read(data), mp.load(blob)):
        found = clip.streams["points"]
        expected = points if floats else points * np.float32(0.1)
        valid = words != -1
        places = found.values.reshape(points.shape)
        assert np.isnan(places[~valid]).all()
        assert np.allclose(places[valid], expected[valid], rtol=1e-6)
        assert [column.name for column in found.columns[:4]] == ["M0.x", "M0.y", "M0.z", "M1.x"]
        assert {column.unit for column in found.columns} == {"mm"}
        assert found.frame_time == 1 / Fraction("119.88")
        forces = clip.streams["analog"]
        assert forces.frame_time == 1 / (4 * Fraction("119.88"))
        assert np.allclose(forces.values, (analog - 7) * 0.5 * np.arange(1, 4))
        assert [column.name for column in forces.columns] == ["A0", "A1", "A2"]
        stored = 256 * clip.streams["cameras"].values + clip.streams["residuals"].values
        assert np.array_equal(stored, words)


def test_what_floats_can_be_comes_back() -> None:
    points, words, analog = walk()
    points[3, 0] = np.nan
    points[4, 0, 1] = -0.0
    points[5, 0, 2] = np.inf
    words[6, 0] = -0.0
    words[7, 0] = 1.5
    words[8, 0] = 1e9
    analog[9, 1] = np.nan
    for processor in (INTEL, DEC, MIPS):
        data = bytearray(c3d(points, words, analog, processor=processor, samples=4))
        data[-8:-4] = b"\xff\x7f\xff\x7f" if processor == DEC else b"\x01\x00\x80\x7f"
        data[-12:-8] = b"\x01\x00\x00\x80"
        assert again(bytes(data)) == bytes(data)
        assert mp.decompress(mp.compress(bytes(data))) == bytes(data)


def test_missing_points_may_be_nan() -> None:
    points, words, analog = walk()
    points[words == -1] = np.nan
    data = c3d(points, words, analog, samples=4)
    assert again(data) == data
    stored = split(data, None, None).stored
    assert isinstance(stored, C3dLayout)
    assert not stored.differing.size


def test_rotations_stand_in_a_part_of_their_own() -> None:
    points, words, analog = walk()
    turned = np.random.default_rng(1).normal(size=(40, 2, 17))
    data = c3d(points, words, analog, samples=4, rotations=turned, tail=b"between")
    clip = mp.read(data)
    assert clip.streams["rotations"].values.shape == (40, 34)
    assert np.allclose(clip.streams["rotations"].values, turned.reshape(40, -1), atol=1e-6)
    assert mp.decompress(mp.compress(data)) == data
    alone = c3d(points[:, :0], words[:, :0], analog[:, :0], rotations=turned)
    assert list(mp.read(alone).streams) == ["rotations"]
    assert mp.decompress(mp.compress(alone)) == alone


def test_headers_that_are_wrong_are_seen_through() -> None:
    points, words, analog = walk()
    data = c3d(points, words, analog, samples=4)
    # Analog channels where the numbers of a frame belong; one point more; another beginning.
    for at, number in ((4, 3), (2, 4), (16, 9)):
        wrong = swapped(data, at, number)
        assert mp.read(wrong).streams["analog"].values.shape == (160, 3)
        assert again(wrong) == wrong


@pytest.mark.parametrize("stated", [65535, 66000 - 65536])
@pytest.mark.parametrize("channels", [0, 2])
def test_a_count_of_16_bits_may_be_too_small(stated: int, channels: int) -> None:
    random = np.random.default_rng(3)
    points = random.normal(size=(66000, 1, 3)).astype(np.float32).astype(np.float64)
    analog = random.normal(size=(132000, channels // 2)).astype(np.float32).astype(np.float64)
    data = c3d(points, np.zeros((66000, 1)), analog, samples=2, announced=stated)
    data += b"\0" * (-len(data) % 512)
    clip = Source(data, "a.c3d").split().clip
    assert np.array_equal(clip.streams["points"].values, points.reshape(-1, 3))
    if channels:
        assert np.array_equal(clip.streams["analog"].values, analog)


def test_last_frames_of_zeros_are_frames_where_a_parameter_counts_them() -> None:
    points = np.random.default_rng(3).normal(size=(70016, 1, 3)).astype(np.float32)
    points[-10:] = 0
    words, analog = np.zeros((70016, 1)), np.zeros((70016, 0))
    data = c3d(points.astype(np.float64), words, analog, announced=65535, stated=70016)
    data += b"\0" * (-len(data) % 512)
    assert mp.read(data).frames == 70016


def test_frames_that_are_missing_or_too_many_are_named() -> None:
    points, words, analog = walk()
    short = c3d(points, words, analog, samples=4, announced=60)
    with pytest.raises(mp.FormatError, match="ends before its last frame"):
        mp.read(short)
    with pytest.warns(mp.MotionWarning, match="60 frames"):
        assert mp.read(short, strict=False).frames == 40
    assert mp.decompress(mp.compress(short)) == short
    long = c3d(points, words, analog, samples=4, announced=30)
    with pytest.warns(mp.MotionWarning, match="more frames than the header announces"):
        assert mp.read(long).frames == 40
    assert mp.decompress(mp.compress(long)) == long


def test_one_frame_and_points_that_never_appear() -> None:
    points, words, analog = walk(1)
    points[:], words[:] = 0, -1
    data = c3d(points, words, analog, samples=4)
    clip = mp.read(data)
    assert clip.frames == 1
    assert np.isnan(clip.values).all()
    assert mp.decompress(mp.compress(data)) == data


def test_every_truncation_is_read_or_refused_and_comes_back() -> None:
    points, words, analog = walk(3)
    data = c3d(points, words, analog, samples=4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        for size in range(len(data)):
            cut = data[:size]
            try:
                assert again(cut) == cut
            except mp.FormatError:
                assert size < 2048 + 4 * (4 * 5 + 12)  # not one whole frame is there
    assert mp.decompress(mp.compress(data[:1000])) == data[:1000]


def test_absurd_counts_cost_little() -> None:
    points, words, analog = walk()
    data = c3d(points, words, analog, samples=4)
    for at in range(0, 24, 2):
        for number in (0, 1, 255, 32767, 32768, 65535):
            wrong = swapped(data, at, number)
            tracemalloc.start()
            begun = time.process_time()
            with contextlib.suppress(mp.FormatError):
                assert again(wrong) == wrong
            assert time.process_time() - begun < 1
            assert tracemalloc.get_traced_memory()[1] < 40 * len(data)
            tracemalloc.stop()


def test_every_byte_of_header_and_parameters_may_be_wrong() -> None:
    points, words, analog = walk(3)
    data = c3d(points, words, analog, samples=4)
    for at in range(1200):
        for wrong in (data[at] ^ 0x80, data[at] ^ 1, 255):
            changed = data[:at] + bytes([wrong]) + data[at + 1 :]
            with contextlib.suppress(mp.FormatError):
                assert again(changed) == changed
                parts = split(changed, None, None)
                assert isinstance(parts.stored, C3dLayout)
                described(parts.stored.head, parts.clip)


def test_what_is_no_c3d_goes_the_general_way() -> None:
    with pytest.raises(mp.FormatError, match="frames cannot be found"):
        mp.read(b"\x02\x50".ljust(512, b"\0") + bytes([1, 0x50, 1, 84]).ljust(512, b"\0"))
    plain = b"\x02\x50".ljust(512, b"\0") + bytes([1, 0x50, 1, 84]) + os.urandom(2000)
    assert mp.decompress(mp.compress(plain)) == plain


def test_clips_are_written_and_read_by_others(tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    points, words, analog = walk()
    clip = mp.read(c3d(points, words, analog, samples=4))
    mp.write(clip, tmp_path / "written.c3d")
    mine = mp.read(tmp_path / "written.c3d")
    for name, stream in clip.streams.items():
        same = np.float32(stream.values), np.float32(mine.streams[name].values)
        assert np.array_equal(*same, equal_nan=True)
        assert [c.name for c in stream.columns] == [c.name for c in mine.streams[name].columns]
        assert stream.frame_time == mine.streams[name].frame_time
    theirs = ezc3d.c3d(str(tmp_path / "written.c3d"))
    found = theirs["data"]["points"][:3].transpose(2, 1, 0).reshape(40, -1)
    assert np.allclose(found, clip.values, equal_nan=True)
    assert theirs["parameters"]["POINT"]["LABELS"]["value"] == ["M0", "M1", "M2", "M3", "M4"]
    assert np.allclose(theirs["data"]["analogs"][0].T, clip.streams["analog"].values)


def test_events_and_first_frames_are_written(tmp_path: Path) -> None:
    points, words, analog = walk()
    clip = mp.read(c3d(points, words, analog, samples=4))
    events = [{"seconds": 61.5, "label": "Foot Strike", "context": "Left"}]
    told = {**clip.metadata, "first_frame": "70000", "events": json.dumps(events)}
    mp.write(Clip(clip.streams, None, "", told), tmp_path / "written.c3d")
    found = mp.read(tmp_path / "written.c3d").metadata
    assert found["first_frame"] == "70000"
    assert json.loads(found["events"]) == events


def test_joints_become_points(tmp_path: Path) -> None:
    bvh = Path(__file__).parents[2] / "samples/freebvh.bvh"
    clip = mp.read(bvh)
    mp.write(clip, tmp_path / "joints.c3d")
    found = mp.read(tmp_path / "joints.c3d")
    assert found.values.shape == (clip.frames, 3 * len(clip.skeleton.joints))  # type: ignore[union-attr]
    assert np.allclose(found.values, mp.positions(clip).reshape(clip.frames, -1), rtol=1e-5)


def test_a_clip_without_points_is_refused(tmp_path: Path) -> None:
    columns = (mp.Column("a", -1, "v"),)
    with pytest.raises(mp.UnsupportedError, match="needs points"):
        mp.write(
            Clip({"motion": Stream(np.zeros((2, 1)), columns, Fraction(1))}), tmp_path / "none.c3d"
        )
