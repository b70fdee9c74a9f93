"""Figures of a clip at moments, and the contact sheet of a library."""

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from running import mocapress

import mocapress as mp
from mocapress import figures


def ink(picture: Image.Image) -> NDArray[np.bool_]:
    """Say which pixels are those of a figure: bluer than red."""
    pixels = np.asarray(picture).astype(int)
    found: NDArray[np.bool_] = pixels[..., 2] - pixels[..., 0] > 40
    return found


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "markers.c3d", "markers.trc"])
def test_each_moment_has_its_place(samples: Path, name: str) -> None:
    clip = mp.read(samples / name)
    picture = figures.strip(clip, figures.moments(clip.frames, 4), (400, 120))
    assert picture.size == (400, 120)
    cells = np.split(ink(picture), 4, axis=1)
    assert all(cell.sum() > 20 for cell in cells)
    assert not any(cell[:, [0, -1]].any() for cell in cells)  # none reaches into the next


def test_a_figure_stands_upright_and_moves(samples: Path) -> None:
    clip = mp.read(samples / "mocapbank.bvh")
    standing = ink(figures.strip(clip, [0], (100, 100)))
    rows, columns = np.nonzero(standing)
    assert np.ptp(rows) > 1.5 * np.ptp(columns)
    assert rows.max() < 97  # on the floor
    both = ink(figures.strip(clip, [0, clip.frames // 2], (200, 100)))
    assert (both[:, :100] != both[:, 100:]).sum() > 50


def test_files_with_z_up_stand_too(samples: Path) -> None:
    clip = mp.read(samples / "markers.c3d")
    rows, columns = np.nonzero(ink(figures.strip(clip, [100], (120, 120))))
    assert np.ptp(rows) > np.ptp(columns)


def test_moments_lie_within_the_clip() -> None:
    assert figures.moments(0, 5) == []
    assert figures.moments(2, 5) == [0, 1]
    assert figures.moments(100, 4) == [12, 37, 62, 87]


def test_what_cannot_be_drawn(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clip = mp.read(samples / "cmu_01_01.amc", asf_path=samples / "cmu_01_01.asf")
    bare = mp.load(mp.compress((samples / "cmu_01_01.amc").read_bytes()))
    with pytest.raises(mp.UnsupportedError, match="neither a skeleton nor markers"):
        figures.strip(bare, [0], (50, 50))
    with pytest.raises(mp.UnsupportedError, match="no place is known"):
        figures.strip(clip.with_values(np.full(clip.values.shape, np.nan)), [0], (50, 50))
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(mp.UnsupportedError, match=r"mocapress\[pictures\]"):
        figures.strip(clip, [0], (50, 50))


def test_a_sheet_shows_every_clip(tmp_path: Path, samples: Path) -> None:
    path, sheet = tmp_path / "lib.mocapdb", tmp_path / "sheet.png"
    clip = mp.read(samples / "freebvh.bvh")
    with mp.open_library(path, "a") as library:
        library.add(samples / "cmu_01_01.amc", "cmu.amc", codec="exact:level=1", labels=["walk"])
        rows = np.resize(np.arange(clip.frames), 5000)
        long = clip.with_frames(clip.values[rows], clip.frame_time)
        library.add(long, "long", codec="exact:level=1")
        library.add(samples / "markers.trc", "markers.trc", codec="exact:level=1")
        library.add(b"no motion", "read.me")
    done = mocapress("library", "sheet", path, "-o", sheet, "--columns", 2)
    assert done.exit_code == 0, done.output
    assert done.stdout == f"{sheet}: 3 clips, 1008 x 400 pixels\n"
    picture = ink(Image.open(sheet))
    for top, left in ((0, 0), (0, 500), (200, 0)):
        assert picture[top : top + 160, left : left + 500].sum() > 200
    assert picture[200:, 520:].sum() == 0
    assert mocapress("library", "sheet", path, "-o", sheet).exit_code == 1  # it is there
    done = mocapress("library", "sheet", path, "--label", "walk", "-o", sheet, "--force")
    assert done.stdout.startswith(f"{sheet}: 1 clips, 512 x")
    done = mocapress("library", "sheet", path, "--most", 2, "-o", sheet, "--force")
    assert done.stdout.startswith(f"{sheet}: 2 clips of 3 (--most)")
    assert mocapress("library", "sheet", path, "read.me", "-o", sheet, "-f").exit_code == 1
    assert mocapress("library", "sheet", path, "-o", tmp_path / "sheet.gif").exit_code == 2


def test_a_damaged_clip_costs_its_place_only(tmp_path: Path, samples: Path) -> None:
    path, sheet = tmp_path / "lib.mocapdb", tmp_path / "sheet.jpg"
    with mp.open_library(path, "a") as library:
        for name in ("a", "b"):
            library.add(mp.read(samples / "freebvh.bvh")[ord(name) - 97 : 60], name)
        with library.db.writing() as connection:
            connection.execute("UPDATE chunks SET sections = zeroblob(9) WHERE clip = 1")
    done = mocapress("library", "sheet", path, "-o", sheet)
    assert done.exit_code == 1
    assert "a: " in done.output
    picture = ink(Image.open(io.BytesIO(sheet.read_bytes())))
    assert picture[:, 500:].sum() > 200
