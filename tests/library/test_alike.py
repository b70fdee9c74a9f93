"""Clips that are alike: what their heads and layouts have in common stands in the library once."""

import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from older import make_older

import mocapress as mp
from mocapress.errors import CorruptError

ASF = """:version 1.10
:name made_up
:units
  mass 1.0
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name bone
    direction 0 1 0
    length 2
    axis 0 0 0 XYZ
    dof rx ry rz
  end
:hierarchy
  begin
    root bone
  end
"""
CLIPS = 12


def amc(seed: int) -> bytes:
    """Give a motion of nine channels, each printed with other numbers of digits."""
    values = np.cumsum(np.random.default_rng(seed).normal(0, 1, (20, 9)), axis=0)
    lines = ["#!OML:ASF made_up.asf", ":FULLY-SPECIFIED", ":DEGREES"]
    for frame, row in enumerate(values, 1):
        told = [f"{value:.6g}" for value in row]
        told[seed % 9] = "0.50" if frame == 7 + seed else told[seed % 9]
        lines += [str(frame), "root " + " ".join(told[:6]), "bone " + " ".join(told[6:])]
    return ("\r\n".join(lines) + "\r\n").encode()


@pytest.fixture
def files(tmp_path: Path) -> dict[str, bytes]:
    (tmp_path / "made_up.asf").write_text(ASF)
    made = {f"{n}.amc": amc(n) for n in range(CLIPS)}
    for name, data in made.items():
        (tmp_path / name).write_bytes(data)
    return made


@pytest.fixture
def path(files: dict[str, bytes], tmp_path: Path) -> Path:
    file, asf = tmp_path / "alike.mocapdb", tmp_path / "made_up.asf"
    with mp.open_library(file, "a") as library:
        for name in files:
            library.add(tmp_path / name, name, codec="exact:level=1", asf_path=asf, index=False)
    return file


def sound(file: Path, files: dict[str, bytes]) -> None:
    with mp.open_library(file) as library:
        assert {clip.name: library.read_bytes(clip) for clip in library} == files
        assert library.verify() == library.check() == []


def told(file: Path, query: str) -> list[tuple[int, ...]]:
    with closing(sqlite3.connect(file)) as connection:
        return connection.execute(query).fetchall()


def test_heads_and_layouts_are_short_and_everything_comes_back(
    path: Path, files: dict[str, bytes]
) -> None:
    sound(path, files)
    ((heads, layouts, texts),) = told(
        path, "SELECT avg(length(head)), avg(length(layout)), count(text) FROM clips"
    )
    with mp.open_library(path) as library:
        size = min(len(library.read_mcz(name)) for name in files)
        (name, *_) = files
        assert mp.decompress(library.read_mcz(name)) == files[name]
        alone = mp.compress(
            path.parent / name, "exact:level=1", asf_path=path.parent / "made_up.asf"
        )
        assert len(library.read_mcz(name)) <= len(alone) + len(ASF)
    assert texts == 0
    assert heads + layouts < size / 4


def test_an_older_library_is_read_and_taken_over(
    path: Path, files: dict[str, bytes], tmp_path: Path
) -> None:
    make_older(path, 4)
    assert told(path, "SELECT count(text) FROM clips") == [(CLIPS,)]
    sound(path, files)
    with mp.open_library(path, "a") as library:
        library.add(tmp_path / "0.amc", "again.amc", asf_path=tmp_path / "made_up.asf")
        library.recompress("1.amc", codec="exact:level=2")
        library.remove("0.amc")
    assert told(path, "PRAGMA user_version") == [(5,)]
    files["again.amc"] = files.pop("0.amc")
    sound(path, files)


def test_a_damaged_sample_is_found(path: Path, files: dict[str, bytes]) -> None:
    with closing(sqlite3.connect(path)) as connection, connection:
        (sample,) = connection.execute("SELECT sample FROM skeletons").fetchone()
        broken = sample[:9] + bytes([sample[9] ^ 1]) + sample[10:]
        connection.execute("UPDATE skeletons SET sample = ?", [broken])
    with mp.open_library(path) as library:
        with pytest.raises(CorruptError, match=r"0\.amc.*row 1 of skeletons"):
            library.load("0.amc")
        assert {fault.name for fault in library.check()} == {*files}
