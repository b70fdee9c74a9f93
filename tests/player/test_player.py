"""libmocapress, tried by a C program (`make player`): what C is told is what Python is told."""

import os
import random
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mocapress as mp
from mocapress.api.opening import Opened
from mocapress.motion.kinematics import local_rotations, positions, rotations, translations
from mocapress.source import Source

ROOT = Path(__file__).parents[2]
PLAY = ROOT / "build/player/play"
GOLDEN = sorted((ROOT / "tests/golden").glob("v1_*.mcz"))
KNOWN = ("exact", "near", "patterns", "qssd")
OK, CANNOT_READ, CORRUPT, UNSUPPORTED, BAD_ARGUMENT, NO_RATE = 0, 1, 2, 3, 5, 6


def play(*arguments: object) -> str:
    if not PLAY.exists() and os.environ.get("CI"):
        pytest.fail("make player")
    if not PLAY.exists():
        pytest.skip("make player")
    done = subprocess.run([PLAY, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def rows(text: str) -> list[np.ndarray]:
    return [np.array(line.split(), float) for line in text.splitlines()]


def stored(file: Path) -> mp.Clip | None:
    """Give the first stream as it is stored, where libmocapress knows its codec."""
    opened = Opened(Source(file), [])
    head = opened.mcz.head
    if head is None or head.streams[0].codec.id not in KNOWN or head.streams[0].model:
        return None
    columns = head.streams[0].columns
    return mp.Clip.of(opened.rows().values, columns, skeleton=head.skeleton)


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    """Give four chunks of the sample, of which an ASF is a part."""
    path = tmp_path / "walk.mcz"
    clip = mp.read(ROOT / "samples/cmu_01_01.amc")[:300]
    path.write_bytes(mp.compress(clip, "exact:level=1,chunk=90"))
    return path


def test_golden_files_have_the_values_and_places_that_python_finds() -> None:
    known = placed = 0
    for file in GOLDEN:
        clip = stored(file)
        if clip is None:
            continue
        known += 1
        found = np.array(rows(play("values", file, *range(clip.frames))))
        assert found.tobytes() == clip.values.tobytes(), file
        if clip.skeleton is None or not clip.frames:
            continue
        middle = clip.frames // 2
        place, turn = rows(play("poses", file, 1, "world", middle))
        ours = positions(clip, end_sites=True)[middle]
        assert place == pytest.approx(ours.ravel(), rel=1e-9, abs=1e-9, nan_ok=True), file
        assert _same_turns(turn, rotations(clip)[middle]), file
        placed += 1
    assert known > 30
    assert placed > 10


def _same_turns(found: np.ndarray, ours: np.ndarray) -> bool:
    cosines = np.abs((found.reshape(-1, 4) * ours).sum(axis=1))
    return bool(np.all(cosines > 1 - 1e-12))


@pytest.mark.parametrize("codec", ["exact:chunk=90", "near:max=0.1cm,chunk=64"])
def test_poses_of_all_frames(codec: str, tmp_path: Path) -> None:
    path = tmp_path / "walk.mcz"
    path.write_bytes(mp.compress(mp.read(ROOT / "samples/cmu_01_01.amc")[:200], codec))
    clip = mp.load(path)
    frames = range(0, 200, 3)
    found = rows(play("poses", path, 120, "world", *(frame / 120 for frame in frames)))
    ours = positions(clip, end_sites=True)
    for frame, place in zip(frames, found[::2], strict=True):
        assert place == pytest.approx(ours[frame].ravel(), abs=1e-8)
    local = rows(play("poses", path, 120, "local", *(frame / 120 for frame in frames)))
    for frame, place, turn in zip(frames, local[::2], local[1::2], strict=True):
        count = 3 * translations(clip).shape[1]
        assert place[:count] == pytest.approx(translations(clip)[frame].ravel(), abs=1e-8)
        assert _same_turns(turn, local_rotations(clip)[frame])


def test_between_frames_joints_turn_at_constant_speed(walk: Path) -> None:
    from scipy.spatial.transform import Rotation, Slerp

    clip = mp.load(walk)
    turns, places = local_rotations(clip), translations(clip)
    # Frame 89 and 90 lie in different chunks.
    for before, part in ((5, 0.25), (89, 0.5), (200, 0.9), (298, 0.999)):
        place, turn = rows(play("poses", walk, 120, "local", (before + part) / 120))
        mixed = places[before] * (1 - part) + places[before + 1] * part
        assert place[: mixed.size] == pytest.approx(mixed.ravel(), abs=1e-7)
        for joint, found in enumerate(turn.reshape(-1, 4)):
            pair = Rotation.from_quat(np.roll(turns[before : before + 2, joint], -1, axis=1))
            ours = Slerp([0, 1], pair)(part)
            assert (Rotation.from_quat(np.roll(found, -1)) * ours.inv()).magnitude() < 2e-7


def test_times_outside_the_clip_show_its_ends(walk: Path) -> None:
    ends = rows(play("poses", walk, 120, "world", 0, 299 / 120))
    outside = rows(play("poses", walk, 120, "world", -5, 1e30))
    for inner, outer in zip(ends, outside, strict=True):
        assert outer == pytest.approx(inner, abs=1e-9)


def test_facts(walk: Path) -> None:
    clip: Any = mp.load(walk)
    sizes, times, *points = play("facts", walk).splitlines()
    assert sizes.split() == ["300", "62", "31", str(31 + 7)]
    assert [float(number) for number in times.split()] == [0, pytest.approx(2.54 / 0.45)]
    told = [line.split(" ", 1) for line in points]
    assert [name for _, name in told[:31]] == list(clip.skeleton.names)
    assert [int(parent) for parent, _ in told[:31]] == list(clip.skeleton.parents)


def test_nothing_is_allocated_for_poses_of_a_chunk(tmp_path: Path) -> None:
    for codec in ("exact:level=1", "near:max=1cm"):
        path = tmp_path / "walk.mcz"
        path.write_bytes(mp.compress(mp.read(ROOT / "samples/cmu_01_01.amc")[:256], codec))
        assert play("allocations", path, 120, 500).split() == ["0", "1"]


def test_what_cannot_be_played_is_said(tmp_path: Path, walk: Path) -> None:
    clip = mp.read(ROOT / "samples/cmu_01_01.amc")[:40]
    other, plain = tmp_path / "app.mcz", tmp_path / "plain.mcz"
    other.write_bytes(mp.compress(clip, "app"))
    plain.write_bytes(mp.compress(b"no motion"))
    files = [other, plain, tmp_path / "none.mcz", tmp_path, ROOT / "README.md"]
    found = [line.split(" ", 1) for line in play("open", *files).splitlines()]
    assert [int(status) for status, _ in found] == [
        UNSUPPORTED,
        UNSUPPORTED,
        CANNOT_READ,
        CANNOT_READ,
        CORRUPT,
    ]
    assert found[0][1] == "coded by app, not by exact, near, patterns or qssd"
    done = subprocess.run([PLAY, "poses", walk, "0", "world", "1"], capture_output=True, text=True)
    assert f"status {NO_RATE}" in done.stderr
    done = subprocess.run([PLAY, "values", walk, "300"], capture_output=True, text=True)
    assert f"status {BAD_ARGUMENT}" in done.stderr


def test_damage_is_found(tmp_path: Path, walk: Path) -> None:
    data = walk.read_bytes()
    picked = random.Random(3)
    cuts = [data[:size] for size in picked.sample(range(len(data)), 60)]
    flipped = [
        data[:at] + bytes([data[at] ^ 1 << picked.randrange(8)]) + data[at + 1 :]
        for at in picked.sample(range(len(data)), 140)
    ]
    files = []
    for i, content in enumerate(cuts + flipped):
        files.append(tmp_path / f"{i}.mcz")
        files[-1].write_bytes(content)
    found = [int(line.split()[0]) for line in play("open", *files).splitlines()]
    assert set(found) <= {CORRUPT, UNSUPPORTED}, [files[i] for i, s in enumerate(found) if not s]


def test_the_header_is_c_and_cpp(tmp_path: Path) -> None:
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("no g++")
    for language, standard in (("c", "c99"), ("c++", "c++11")):
        command: list[object] = [
            compiler,
            "-x",
            language,
            f"-std={standard}",
            "-pedantic-errors",
            "-Wall",
        ]
        command += ["-Werror", "-fsyntax-only", ROOT / "include/mocapress.h"]
        subprocess.run([str(part) for part in command], check=True)


def test_the_example_of_the_guide_runs(tmp_path: Path, walk: Path) -> None:
    guide = (ROOT / "docs/guide/c.md").read_text()
    (tmp_path / "example.c").write_text(re.findall(r"```c\n(.*?)```", guide, re.DOTALL)[0])
    play("facts", walk)  # it is built
    folder = next((ROOT / "build/player/prefix").glob("lib*"))
    command: list[object] = [
        "gcc",
        tmp_path / "example.c",
        f"-I{folder.parent}/include",
        f"-L{folder}",
    ]
    command += [f"-Wl,-rpath,{folder}", "-lmocapress", "-o", tmp_path / "example"]
    subprocess.run([str(part) for part in command], check=True)
    done = subprocess.run([tmp_path / "example", walk], capture_output=True, text=True, check=True)
    clip: Any = mp.load(walk)
    lines = [line.rsplit(" ", 3) for line in done.stdout.splitlines()]
    assert [line[0] for line in lines] == list(clip.skeleton.names)
    found = np.array([line[1:] for line in lines], float)
    assert found == pytest.approx(positions(clip)[60], abs=1e-3)
