"""Frames that are coded as they come: ``mp.encoder`` and ``compress --stream``."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from running import COMMAND, process

import mocapress as mp
from mocapress.errors import ParameterError

NAMES = [f"m{i}.{axis}" for i in range(6) for axis in "xyz"]


def motion(frames: int) -> np.ndarray:
    time = np.arange(frames)[:, None] / 40
    return 300 * np.sin(time + np.arange(18)) + 50 * np.arange(18)


def test_frames_come_out_after_a_chunk_of_them() -> None:
    values = motion(150)
    learned = mp.train([mp.from_array(motion(400), NAMES, fps=120)], "patterns")
    coder = mp.encoder(NAMES, 120, codec="patterns:chunk=60", model=learned)
    sizes = [len(coder.push(row)) for row in values]
    # The head is there at once; then nothing until a chunk is full.
    assert [i for i, size in enumerate(sizes) if size] == [0, 59, 119]
    assert sum(sizes[1:]) < 1000


def test_what_was_pushed_is_a_file() -> None:
    values = motion(150)
    model = mp.train([mp.from_array(motion(400), NAMES, fps=120)], "patterns")
    coder = mp.encoder(NAMES, 120, codec="patterns:chunk=60", model=model)
    parts = [coder.push(values[:70]), coder.push(values[70:]), coder.finish()]
    loaded = mp.load(b"".join(parts), models=[model])
    assert loaded.values.shape == values.shape
    assert loaded.fps == 120
    assert np.abs(loaded.values - values).max() < 60
    # Also what came until now is one.
    with pytest.warns(mp.MotionWarning):  # it has no end
        assert mp.load(parts[0] + parts[1], models=[model]).frames == 120
    with pytest.raises(ParameterError, match="closed"):
        coder.push(values[:1])


def test_a_stream_through_a_pipe(tmp_path: Path) -> None:
    values = np.round(motion(90), 3)
    lines = [",".join(NAMES), *(",".join(f"{v:.3f}" for v in row) for row in values)]
    text = "\n".join([*lines, ""]).encode()
    words = ["compress", "--stream", "-", "--rate", "120", "--codec", "exact:chunk=30"]
    made = process(*words, data=text)
    assert made.stderr == b""
    assert np.array_equal(mp.load(made.stdout).values, values)
    target = tmp_path / "take.mcz"
    assert process(*words, "-o", target, data=text).returncode == 0
    assert np.array_equal(mp.load(target).values, values)
    again = process(*words, "-o", target, data=text)
    assert again.returncode == 1
    assert b"exists" in again.stderr


def test_bytes_come_before_the_input_ends() -> None:
    words = ["compress", "--stream", "-", "--rate", "60", "--codec", "exact:chunk=2"]
    with subprocess.Popen(
        [*COMMAND, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
    ) as process_:
        assert process_.stdin is not None
        assert process_.stdout is not None
        process_.stdin.write(b"a b\n1 2\n3 4\n")
        first = process_.stdout.read(1)
        process_.stdin.write(b"5 6\n")
        whole = first + process_.communicate()[0]
    assert mp.load(whole).values.tolist() == [[1, 2], [3, 4], [5, 6]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"", b"no names"),
        (b"1,2\n3,4\n", b"no names"),
        (b"a,b\n1\n", b"line 2: no frame; expected 2 numbers"),
        (b"a,b\n1,2\n1,x\n", b"line 3: no frame"),
    ],
)
def test_what_is_no_stream_is_refused(text: bytes, said: bytes) -> None:
    made = process("compress", "--stream", "-", data=text)
    assert made.returncode == 1
    assert said in made.stderr
