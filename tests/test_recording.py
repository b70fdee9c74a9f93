"""Recordings: what was appended is in the file, whatever happens to the process."""

import os
import signal
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress.storage import ExistsError

COLUMNS = ("root.tx", "root.ty", "root.rz", "knee.rx")


def wave(frames: int) -> NDArray[np.float64]:
    times = np.arange(frames)[:, None]
    rounded: NDArray[np.float64] = np.round(40 * np.sin(0.07 * times + np.arange(4)), 3)
    return rounded


@pytest.mark.parametrize("codec", ["exact:chunk=50", "exact:level=1,chunk=64", "app:chunk=45"])
def test_what_was_appended_is_there(tmp_path: Path, codec: str) -> None:
    path, values = tmp_path / "take.mcz", wave(333)
    with mp.writer(path, COLUMNS, 120, codec=codec, notes={"actor": "nobody"}) as recording:
        recording.append(values[:1])
        recording.append(values[1])
        recording.append(values[2:200])
        recording.append(values[200:])
    clip = mp.load(path)
    assert clip.values.tobytes() == values.tobytes()
    assert [column.name for column in clip.columns] == list(COLUMNS)
    assert [column.joint for column in clip.columns] == [0, 0, 0, 1]
    assert clip.frame_time == Fraction(1, 120)
    assert clip.metadata == {"actor": "nobody"}
    for frames in (slice(70, 71), slice(40, 120), slice(None, None, -40)):
        assert mp.load(path, frames).values.tobytes() == values[frames].tobytes()
    assert not mp.verify(path).damage


def test_a_lossy_recording_gives_what_the_codec_decodes(tmp_path: Path) -> None:
    path, values = tmp_path / "take.mcz", wave(300)
    with mp.writer(path, COLUMNS, None, codec="diffma:max_error=0.01,chunk=64") as recording:
        recording.append(values)
    loaded = mp.load(path)
    assert np.abs(loaded.values - values).max() <= 0.01
    assert loaded.frame_time is None
    assert not mp.verify(path).damage


def test_a_skeleton_is_kept(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "mocapbank.bvh")
    path = tmp_path / "take.mcz"
    with mp.writer(path, clip.columns, Fraction(2997, 100), clip.skeleton) as recording:
        recording.append(clip.values)
    loaded = mp.load(path)
    assert loaded.skeleton == clip.skeleton
    assert loaded.columns == clip.columns
    mp.write(loaded, tmp_path / "take.bvh")
    assert mp.read(tmp_path / "take.bvh").values.tobytes() == clip.values.tobytes()


def test_there_is_no_file_to_restore(tmp_path: Path) -> None:
    with mp.writer(tmp_path / "take.mcz", COLUMNS, 120) as recording:
        recording.append(wave(3))
    with pytest.raises(mp.UnsupportedError, match=r"no original file.*convert"):
        mp.decompress(tmp_path / "take.mcz")


def test_an_empty_recording_is_a_clip_without_frames(tmp_path: Path) -> None:
    mp.writer(tmp_path / "take.mcz", COLUMNS, 120).close()
    assert mp.load(tmp_path / "take.mcz").values.shape == (0, 4)


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "take.mcz").write_bytes(b"mine")
    with pytest.raises(ExistsError):
        mp.writer(tmp_path / "take.mcz", COLUMNS, 120)
    assert (tmp_path / "take.mcz").read_bytes() == b"mine"


@pytest.mark.parametrize(
    "wrong",
    [
        {"rate": 0},
        {"rate": -1},
        {"rate": float("nan")},
        {"rate": 1e300},
        {"rate": 1e-300},
        {"codec": "none"},
        {"notes": {"actor": "\udcff"}},
    ],
    ids=ascii,
)
def test_wrong_parameters_leave_no_file(tmp_path: Path, wrong: dict[str, object]) -> None:
    arguments = {"rate": 120, "codec": "exact"} | wrong
    with pytest.raises((mp.ParameterError, mp.UnsupportedError)):
        mp.writer(tmp_path / "take.mcz", COLUMNS, **arguments)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_rows_of_another_shape_are_refused(tmp_path: Path) -> None:
    with mp.writer(tmp_path / "take.mcz", COLUMNS, 120) as recording:
        recording.append(wave(10))
        for rows in (np.zeros((2, 3)), np.zeros(5), np.zeros((2, 2, 4)), 1.0):
            with pytest.raises(mp.ParameterError, match="rows"):
                recording.append(rows)
    with pytest.raises(mp.ParameterError, match="closed"):
        recording.append(wave(1))
    assert mp.load(tmp_path / "take.mcz").frames == 10


def test_an_error_in_the_middle_keeps_what_was_there(tmp_path: Path) -> None:
    def capture() -> None:
        with mp.writer(tmp_path / "take.mcz", COLUMNS, 120) as recording:
            recording.append(wave(70))
            raise RuntimeError

    with pytest.raises(RuntimeError):
        capture()
    assert mp.load(tmp_path / "take.mcz").values.tobytes() == wave(70).tobytes()


def test_a_full_disk_loses_nothing_that_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was half written is taken back, and the rows are written with the next."""
    write, free = os.write, [3]

    def full(file: int, data: bytes) -> int:
        if free[0] == 0:
            raise OSError(28, "No space left on device")
        free[0] -= 1
        return write(file, data[:40])

    with mp.writer(tmp_path / "take.mcz", COLUMNS, 120, codec="exact:chunk=50") as recording:
        recording.append(wave(50))
        monkeypatch.setattr(os, "write", full)
        with pytest.raises(OSError, match="No space"):
            recording.append(wave(110)[50:])
        monkeypatch.setattr(os, "write", write)
        recording.append(wave(120)[110:])
    assert mp.load(tmp_path / "take.mcz").values.tobytes() == wave(120).tobytes()


@pytest.mark.filterwarnings("ignore:.*not closed:mocapress.MotionWarning")
def test_killed_it_opens_with_all_whole_chunks(tmp_path: Path) -> None:
    path = tmp_path / "take.mcz"
    code = (
        "import numpy as np, mocapress as mp\n"
        f"with mp.writer({str(path)!r}, {COLUMNS!r}, 120, codec='exact:level=1,chunk=20') as out:\n"
        "  for i in range(100_000):\n"
        "    out.append(np.round(40 * np.sin(0.07 * i + np.arange(4)), 3))\n"
        "    if i % 20 == 19: print(i + 1, flush=True)\n"
    )
    for rows in (20, 60, 300):
        path.unlink(missing_ok=True)
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as child:
            assert child.stdout is not None
            for line in child.stdout:
                if int(line) >= rows:
                    child.send_signal(signal.SIGKILL)
                    break
        clip = mp.load(path)
        assert clip.frames >= rows
        assert clip.frames % 20 == 0
        assert np.allclose(clip.values, wave(clip.frames), atol=1e-9)


def test_a_recording_that_was_not_closed_says_so(tmp_path: Path) -> None:
    recording = mp.writer(tmp_path / "take.mcz", COLUMNS, 120, codec="exact:chunk=50")
    recording.append(wave(120))
    with pytest.warns(mp.MotionWarning, match="not closed") as caught:
        clip = mp.load(tmp_path / "take.mcz")
    assert clip.values.tobytes() == wave(100).tobytes()
    messages = [warning.message for warning in caught]
    assert [m.name for m in messages if isinstance(m, mp.MotionWarning)] == ["unfinished-recording"]
    recording.flush()
    with pytest.warns(mp.MotionWarning):
        assert mp.load(tmp_path / "take.mcz").frames == 120
    recording.close()
    assert mp.load(tmp_path / "take.mcz").frames == 120
