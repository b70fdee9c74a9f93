"""What the page reads in the browser is what mocapress reads: values, places, and errors."""

import json
import os
import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mocapress as mp
from mocapress.motion.columns import skeleton_columns

SCRIPT = Path(__file__).with_name("positions.mjs")
SAMPLES = Path(__file__).parents[2] / "samples"


def read_by_page(*paths: Path) -> Any:
    node = shutil.which("node")
    if node is None:
        reason = "no node (Debian: apt-get install nodejs); `make browser` installs it as root"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    done = subprocess.run([node, SCRIPT, *paths], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def check(path: Path) -> None:
    clip = mp.read(path)
    beside = clip.metadata.get("skeleton")
    (made,) = read_by_page(path, *([Path(beside)] if beside else []))["clips"]
    assert made["names"] == [column.name for column in clip.columns]
    assert made["length"] == clip.frames
    assert made["frameTime"] == (float(clip.frame_time) if clip.frame_time is not None else None)
    np.testing.assert_array_equal(np.array(made["values"]).T, clip.values[made["frames"]])
    if clip.skeleton:
        some = clip.with_frames(clip.values[made["frames"]], clip.frame_time)
        places = mp.positions(some, end_sites=True)
        np.testing.assert_allclose(
            np.array(made["positions"]).reshape(places.shape), places, rtol=0, atol=1e-9
        )


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_samples(samples: Path, name: str) -> None:
    check(samples / name)


@pytest.mark.corpus
def test_clips_of_all_kinds(corpus_clips: list[Path]) -> None:
    for path in corpus_clips[::12]:
        try:
            mp.read(path)
        except mp.MocapressError:
            assert read_by_page(path)["errors"]
        else:
            check(path)


BVH = (SAMPLES / "mocapbank.bvh").read_bytes()
BROKEN = {
    "no_motion.bvh": BVH[: BVH.index(b"MOTION")],
    "number.bvh": BVH[:-40] + b" x" + BVH[-38:],
    "short_row.bvh": BVH.rstrip()[:-30],
    "brace.bvh": BVH.replace(b"}", b"", 1),
    "channels.bvh": BVH.replace(b"CHANNELS 3", b"CHANNELS 4", 1),
    "offset.bvh": BVH.replace(b"OFFSET ", b"OFFSET x", 1),
    "frames.bvh": re.sub(rb"Frames:\s+455", b"Frames: 45500", BVH),
    "a_row_missing.bvh": re.sub(rb"Frames:\s+455", b"Frames: 456", BVH),
    "frame_time.bvh": BVH.replace(b"Frame Time:", b"Frame Tim:"),
    "empty.bvh": b"",
    "empty.amc": b"",
    "bone.amc": b"1\nroot 1 2 3 4 5 6\nhip 1\n2\nroot 1 2 3 4 5 6\nhip 1\nhip 1\n",
    "few.amc": b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5\n",
    "infinite.amc": b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5 1e999\n",
}


@pytest.mark.parametrize("name", BROKEN)
def test_errors_name_the_same_place(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(BROKEN[name])
    with pytest.raises(mp.MocapressError) as error:
        mp.read(file)
    made = read_by_page(file)
    assert made["clips"] == []
    (message,) = made["errors"]
    place = f"{name}, line {error.value.line}: " if error.value.line else f"{name}: "
    assert message.startswith(f"{place}{error.value.what}"), (message, str(error.value))


@pytest.mark.parametrize("stated", ["60", "30.0", "0", "x"])
def test_an_amc_that_states_its_rate(tmp_path: Path, stated: str) -> None:
    file = tmp_path / "a.amc"
    file.write_text(
        f":DEGREES\n:SAMPLES-PER-SECOND {stated}\n-1\nroot 1 2 3 4 5 6\n0\nroot 1 2 3 4 5 6\n"
    )
    check(file)


def test_a_bone_first_seen_later(tmp_path: Path) -> None:
    file = tmp_path / "a.amc"
    file.write_text(
        "1\nroot 1 2 3 4 5 6\nhip 7\n2\nroot 1 2 3 4 5 6\nneck 8 9\nhip 7\n3\nneck 1 2\n"
    )
    check(file)


@pytest.mark.parametrize("kind", ["bvh", "amc"])
def test_odd_names(tmp_path: Path, kind: str) -> None:
    called = ["Hips", "a b", "Hüfteà", "Å", "End", "begin", "root", "#{}", "", "%41", "a b", "\xa0"]
    joints = tuple(
        mp.Joint(name, i - 1, channels=("rz", "ry", "rx"), ends=((0.0, 1.0, 0.0),) * (i == 11))
        for i, name in enumerate(called)
    )
    skeleton = mp.Skeleton(joints)
    columns = skeleton_columns(skeleton)
    clip = mp.Clip.of(np.ones((2, len(columns))), columns, Fraction(1, 30), skeleton)
    mp.write(clip, tmp_path / f"a.{kind}")
    check(tmp_path / f"a.{kind}")


ODD = {
    "more_rows.bvh": re.sub(rb"Frames:\s+455", b"Frames: 4", BVH),
    "undeclared.bvh": re.sub(rb"Frames:\s+455", b"Frames: 0", BVH),
    "nul.bvh": BVH + b"\0\0",
    "ctrl_z.bvh": BVH + b"\r\n\x1a",
    "text.bvh": BVH + b"end\n",
    "half_a_row.bvh": BVH + b"1 2 3",
    "nul.amc": b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5 6\n\0\0",
    "ctrl_z.amc": b"-1\nroot 1 2 3 4 5 6\n\x1a\r\n",
}


@pytest.mark.parametrize("name", ODD)
def test_what_loses_nothing_is_played_and_said(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(ODD[name])
    with pytest.warns(mp.MotionWarning) as caught:
        clip = mp.read(file)
    (made,) = read_by_page(file)["clips"]
    assert made["length"] == clip.frames
    notes = [note for note in made["notes"] if "no skeleton" not in note]
    for note, warning in zip(notes, caught, strict=True):
        assert isinstance(warning.message, mp.MotionWarning)
        fact = warning.message.fact
        assert note.startswith(f"line {fact.line}: {fact.what}; expected ")
