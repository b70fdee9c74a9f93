"""The Python interface as a user has it: read, write, compress, decompress, load."""

from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.api import compress_source
from mocapress.source import Source

BROKEN = {
    "empty": b"",
    "junk": bytes(range(256)) * 8,
    "AMC without frames": b":FULLY-SPECIFIED\n:DEGREES\n",
    "AMC with text for a number": b":DEGREES\n1\nroot 1 2 three 4 5 6\n",
    "AMC with NaN": b":DEGREES\n1\nroot 1 2 nan 4 5 6\n",
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
    "BVH with infinity": (
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\n"
        b"Frames: 1\nFrame Time: 0.1\ninf\n"
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
