"""The Python interface as a user has it: read, write, compress, decompress, load."""

import os
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.api import Opened, compress_source
from mocapress.container import MczWriter
from mocapress.source import Source

BROKEN = {
    "empty": b"",
    "junk": bytes(range(256)) * 8,
    "AMC without frames": b":FULLY-SPECIFIED\n:DEGREES\n",
    "AMC with text for a number": b":DEGREES\n1\nroot 1 2 three 4 5 6\n",
    "AMC with a number missing later": b":DEGREES\n1\nroot 1 2\n2\nroot 1\n",
    "AMC with a bone twice later": b":DEGREES\n1\nroot 1 2\n2\nroot 1 2\nroot 1 2\n",
    "BVH without motion": b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n",
    "BVH never closed": b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nMOTION\n",
    "BVH of another column count": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 2 Xrotation Yrotation\n}\nMOTION\n"
        b"Frames: 2\nFrame Time: 0.1\n1 2\n3\n"
    ),
    "BVH of absurdly many frames": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\n"
        b"Frames: 99999999999999\nFrame Time: 0.1\n1\n2\n"
    ),
    "BVH of negative frames": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\n"
        b"Frames: -3\nFrame Time: 0.1\n1\n2\n"
    ),
    "BVH with an unknown channel": b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Wrotation\n}\n",
    "BVH of a frame time without end": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\n"
        b"Frames: 1\nFrame Time: 1e100000000\n1\n"
    ),
    "BVH of a frame time of many digits": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\n"
        b"Frames: 1\nFrame Time: 0." + 5000 * b"1" + b"\n1\n"
    ),
    "BVH of more channels than can be counted": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS " + 5000 * b"1" + b" Xrotation\n}\n"
    ),
    "deep nesting": b"HIERARCHY\nROOT a\n{\n" + b"JOINT b\n{\n" * 100_000,
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_errors_to_read_and_still_compress(name: str, tmp_path: Path) -> None:
    file = tmp_path / f"broken.{'bvh' if 'BVH' in name or 'deep' in name else 'amc'}"
    file.write_bytes(BROKEN[name])
    with pytest.raises(mp.FormatError) as caught:
        mp.read(file)
    assert str(file) in str(caught.value)
    assert caught.value.expected
    made = compress_source(Source(BROKEN[name], str(file)))
    assert made.warning
    assert mp.decompress(made.blob) == BROKEN[name]


def test_counts_may_have_zeros_before_them() -> None:
    bvh = (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS %s1 Xrotation\n}\nMOTION\n"
        b"Frames: %s1\nFrame Time: 0.1\n1\n"
    )
    assert mp.read(bvh % (5000 * b"0", 5000 * b"0")).frames == 1


@pytest.mark.parametrize("stated", [b"0", b"-1", b"inf", b"nan", b"1e999"])
def test_a_unit_of_length_is_a_number_above_0(samples: Path, stated: bytes) -> None:
    asf = (samples / "cmu_01_01.asf").read_bytes()
    assert asf.count(b"length 0.45") == 1
    with pytest.raises(mp.FormatError, match="unit of length; expected a number above 0"):
        mp.read(asf.replace(b"length 0.45", b"length " + stated))


def test_an_amc_without_frames_is_not_written(samples: Path, tmp_path: Path) -> None:
    with pytest.raises(mp.UnsupportedError, match="an AMC needs frames"):
        mp.write(mp.read(samples / "cmu_01_01.asf"), tmp_path / "a.amc")
    assert not list(tmp_path.iterdir())


def test_errors_say_where_and_what(tmp_path: Path) -> None:
    file = tmp_path / "walk.amc"
    file.write_bytes(BROKEN["AMC with text for a number"])
    with pytest.raises(mp.FormatError) as caught:
        mp.read(file)
    assert str(caught.value) == (
        f"{file}, line 3, byte 20: frame 1 cannot be read; "
        "expected 6 numbers for bone root; found 'three'"
    )


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh", "cmu_01_01.asf"])
@pytest.mark.parametrize("codec", ["app", "app:mantissa_limit=53"])
def test_samples_come_back(samples: Path, name: str, codec: str) -> None:
    blob = mp.compress(samples / name, codec)
    assert mp.decompress(blob) == (samples / name).read_bytes()


def test_bytes_and_paths_are_alike(samples: Path, tmp_path: Path) -> None:
    blob = mp.compress((samples / "freebvh.bvh").read_bytes())
    named = mp.compress(samples / "freebvh.bvh")
    assert len(named) == len(blob) + len("freebvh.bvh")
    (tmp_path / "x.mcz").write_bytes(blob)
    assert mp.decompress(tmp_path / "x.mcz") == mp.decompress(blob) == mp.decompress(named)
    assert (mp.load(named).name, mp.load(blob).name) == ("freebvh", "")


def test_loading_gives_what_reading_gives(samples: Path, tmp_path: Path) -> None:
    for name in ("cmu_01_01.amc", "mocapbank.bvh"):
        clip = mp.read(samples / name)
        file = tmp_path / f"{name}.mcz"
        file.write_bytes(mp.compress(samples / name, embed_asf=True))
        loaded = mp.load(file)
        assert loaded.values.tobytes() == clip.values.tobytes()
        assert loaded.columns == clip.columns
        assert loaded.skeleton == clip.skeleton
        assert loaded.frame_time == clip.frame_time


@pytest.mark.parametrize(
    "frames",
    [
        slice(100, 200),
        slice(0, 1),
        slice(-5, None),
        slice(None, None, 500),
        slice(950, 970),
        slice(50, 40),
        slice(2000, 1000, -250),
        slice(479, 481),
    ],
    ids=str,
)
def test_some_frames_are_those_frames(samples: Path, frames: slice) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")
    loaded = mp.load(mp.compress(samples / "cmu_01_01.amc"), frames=frames)
    assert loaded.values.tobytes() == clip.values[frames].tobytes()


def test_some_frames_need_only_their_chunks(samples: Path) -> None:
    blob = bytearray(mp.compress(samples / "cmu_01_01.amc"))
    blob[-100] ^= 1  # in the last chunk
    assert mp.load(bytes(blob), frames=slice(100, 200)).frames == 100
    with pytest.raises(mp.CorruptError, match="frames 2560 to 2750: wrong checksum"):
        mp.load(bytes(blob))


def test_an_amc_without_its_asf_still_compresses(samples: Path, tmp_path: Path) -> None:
    alone = tmp_path / "cmu_01_01.amc"
    alone.write_bytes((samples / "cmu_01_01.amc").read_bytes())
    blob = mp.compress(alone)
    assert mp.decompress(blob) == alone.read_bytes()
    assert mp.load(blob).skeleton is None
    # Whom the columns belong to helps APP; `exact` finds out by itself.
    with_asf = mp.compress(alone, "app", asf_path=samples / "cmu_01_01.asf")
    assert len(with_asf) < len(mp.compress(alone, "app"))


def test_a_skeleton_of_another_is_left_away(samples: Path, tmp_path: Path) -> None:
    data = (samples / "cmu_01_01.amc").read_bytes()
    (tmp_path / "x.amc").write_bytes(data)
    other = b":root\norder TX TY TZ RX RY RZ\n:bonedata\n:hierarchy\n"
    (tmp_path / "x.asf").write_bytes(other)
    with pytest.warns(
        mp.MotionWarning,
        match=r"x\.asf: is of another figure, so x\.amc is taken without a skeleton: .*bone",
    ):
        blob = mp.compress(tmp_path / "x.amc")
    assert mp.decompress(blob) == data
    assert len(blob) < len(data) / 8


def test_the_skeleton_is_found_beside(tmp_path: Path) -> None:
    amc = tmp_path / "02_05.amc"
    amc.write_bytes(b":DEGREES\n1\nroot 1 2 3 4 5 6\n")
    asf = b":root\norder TX TY TZ RX RY RZ\n:bonedata\n:hierarchy\n"
    for name in ("02.asf", "03.asf"):
        (tmp_path / name).write_bytes(asf.replace(b":bone", b":name %s\n:bone" % name.encode()))
    skeleton = mp.read(amc).skeleton
    assert skeleton is not None
    assert skeleton.name == "02.asf"


def test_writing_and_reading_keeps_numbers_as_they_were(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")
    mp.write(clip, tmp_path / "again.amc")
    again = mp.read(tmp_path / "again.amc")
    assert again.values.tobytes() == clip.values.tobytes()
    assert [c.name for c in again.columns] == [c.name for c in clip.columns]
    np.testing.assert_allclose(mp.positions(again)[::100], mp.positions(clip)[::100], atol=1e-6)


def test_a_clip_of_several_streams_comes_back(samples: Path) -> None:
    motion = mp.read(samples / "freebvh.bvh")
    force = mp.Stream(
        np.arange(621.0).reshape(207, 3) / 8,
        tuple(mp.Column(f"plate.{axis}", 0, axis, "N") for axis in ("fx", "fy", "fz")),
        Fraction(1, 90),
    )
    clip = replace(
        motion,
        streams={**motion.streams, "force": force, "none": mp.Stream(np.empty((0, 0)), ())},
        metadata={"actor": "nobody"},
        name="take 3",
    )
    blob = mp.compress(clip, notes={"license": "CC0"})
    back = mp.load(blob)
    assert list(back.streams) == ["motion", "force", "none"]
    for name, stream in clip.streams.items():
        assert back.streams[name].values.tobytes() == stream.values.tobytes()
        assert back.streams[name].columns == stream.columns
        assert back.streams[name].frame_time == stream.frame_time
    assert (back.skeleton, back.name) == (clip.skeleton, "take 3")
    assert back.metadata == {"actor": "nobody", "license": "CC0"}
    part = mp.load(blob, slice(100, 150), stream="force")
    assert list(part.streams) == ["force"]
    assert part.values.tobytes() == force.values[100:150].tobytes()
    assert mp.load(blob, slice(3, 5)).values.tobytes() == motion.values[3:5].tobytes()
    with pytest.raises(mp.ParameterError, match="expected motion, force, none"):
        mp.load(blob, stream="face")
    assert not mp.verify(blob).damage


def test_a_lossy_clip_of_streams_keeps_its_bound(samples: Path) -> None:
    clip = mp.read(samples / "mocapbank.bvh")
    loaded = mp.load(mp.compress(clip, "diffma:max_error=0.05"))
    assert 0 < np.abs(loaded.values - clip.values).max() <= 0.05


@pytest.mark.parametrize("cut", [0.6, 0.97])
def test_what_was_missing_before_is_reported_after(
    samples: Path, tmp_path: Path, cut: float
) -> None:
    """A compressed file says of the original what reading the original says."""
    data = (samples / "mocapbank.bvh").read_bytes()
    file = tmp_path / "cut.bvh"
    file.write_bytes(data[: int(cut * len(data))])
    packed = mp.compress(file)
    assert mp.decompress(packed) == file.read_bytes()
    with pytest.raises(mp.FormatError) as read:
        mp.read(file)
    with pytest.raises(mp.FormatError) as loaded:
        mp.load(packed)
    facts = [(e.value.what, e.value.line, e.value.expected, e.value.found) for e in (read, loaded)]
    assert facts[0] == facts[1]
    with pytest.warns(mp.MotionWarning) as of_reading:
        clip = mp.read(file, strict=False)
    with pytest.warns(mp.MotionWarning) as of_loading:
        again = mp.load(packed, strict=False)
    assert again.values.tobytes() == clip.values.tobytes()
    names = [
        [w.message.name for w in caught if isinstance(w.message, mp.MotionWarning)]
        for caught in (of_reading, of_loading)
    ]
    assert names[0] == names[1]


def test_decoding_needs_no_parser(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a later reader of BVH refuses, old files open."""
    from mocapress import _core

    data = (samples / "freebvh.bvh").read_bytes()
    blob, clip = mp.compress(data), mp.read(samples / "freebvh.bvh")

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("text was parsed")

    monkeypatch.setattr(_core, "read_bvh", refuse)
    loaded = mp.load(blob)
    assert (loaded.columns, loaded.skeleton) == (clip.columns, clip.skeleton)
    assert mp.decompress(blob) == data


def test_a_file_that_shrinks_while_it_is_read_is_an_error(samples: Path, tmp_path: Path) -> None:
    packed = tmp_path / "walk.mcz"
    packed.write_bytes(mp.compress(samples / "cmu_01_01.amc", "app"))
    opened = Opened(Source(packed))
    os.truncate(packed, packed.stat().st_size // 2)
    with pytest.raises(mp.CorruptError, match="became shorter"):
        opened.rows()


def test_numbers_that_do_not_fit_the_announced_text_are_refused(samples: Path) -> None:
    """What a lossy file may restore is bounded by what it announces."""
    blob = mp.compress((samples / "mocapbank.bvh").read_bytes(), "diffma")
    opened = Opened(Source(blob))
    assert opened.mcz.head is not None
    assert opened.mcz.original is not None
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.head(opened.mcz.head)
    writer.original(replace(opened.mcz.original, size=10))
    for entry in opened.mcz.entries:
        writer.chunk(opened.mcz.read_chunk(entry))
    writer.end()
    assert len(mp.decompress(b"".join(parts))) <= 10 + 32 * opened.rows().values.size + 2**16
    values = opened.rows().values.copy()
    values[:] = 1e300
    huge = mp.compress(mp.load(blob).with_values(values), "exact")
    other = Opened(Source(huge))
    parts = []
    writer = MczWriter(parts.append)
    assert other.mcz.head is not None
    columns = opened.streams[0].columns
    writer.head(replace(other.mcz.head, streams=(replace(other.streams[0], columns=columns),)))
    writer.original(opened.mcz.original)
    for entry in other.mcz.entries:
        writer.chunk(other.mcz.read_chunk(entry))
    writer.end()
    with pytest.raises(mp.CorruptError, match="longer"):
        mp.decompress(b"".join(parts))


def test_a_clip_is_written_as_mcz(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    mp.write(clip, tmp_path / "walk.mcz")
    loaded = mp.load(tmp_path / "walk.mcz")
    assert loaded.values.tobytes() == clip.values.tobytes()
    assert (loaded.skeleton, loaded.columns, loaded.name) == (
        clip.skeleton,
        clip.columns,
        clip.name,
    )


def test_one_frame_needs_a_part_of_the_file(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    packed = tmp_path / "walk.mcz"
    packed.write_bytes(mp.compress(samples / "cmu_01_01.amc", "exact:level=1,chunk=200"))
    pread, taken = os.pread, []

    def counted(file: int, count: int, offset: int) -> bytes:
        data = pread(file, count, offset)
        taken.append(len(data))
        return data

    monkeypatch.setattr(os, "pread", counted)
    assert mp.load(packed, slice(1500, 1501)).frames == 1
    # 14 chunks, of which one is read, and up to 80 KiB at the front to see what the file is.
    assert sum(taken) < packed.stat().st_size / 10 + 80 * 1024
    assert sum(taken) < packed.stat().st_size / 2
