"""A format from another package is as good as ours: every command and function takes it."""

import json
import shutil
import sys
from collections.abc import Iterator
from math import sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import mocapress as mp
from mocapress import formats
from mocapress.cli.app import app

TABLE = b"TABLE 50\n" + b"".join(
    b"%.4f\n" % (3 * sin(i / 9) + sin(i * i / 7000)) for i in range(1500)
)


@pytest.fixture(autouse=True)
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Lay a package with the format where Python finds it, as pip would."""
    place = tmp_path / "site"
    about = place / "tables_for_mocapress-1.0.dist-info"
    about.mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("table_format.py"), place / "tables_for_mocapress.py")
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: tables-for-mocapress\n")
    (about / "entry_points.txt").write_text(
        "[mocapress.formats]\ntable = tables_for_mocapress:FORMAT\n"
    )
    formats._others.cache_clear()
    monkeypatch.syspath_prepend(place)
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    Path("heights.tbl").write_bytes(TABLE)
    yield
    formats._others.cache_clear()
    sys.modules.pop("tables_for_mocapress", None)


def mocapress(*words: object) -> Result:
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result


def row(*words: object) -> dict[str, Any]:
    (found,) = json.loads(mocapress(*words, "--json").stdout)
    return dict(found)


def test_reading_writing_and_loading() -> None:
    clip = mp.read("heights.tbl")
    assert (clip.frames, clip.channels, clip.frame_time) == (1500, 1, clip.frame_time)
    assert mp.read(TABLE).values.tobytes() == clip.values.tobytes()  # known by its contents
    assert mp.read(b"TABLE 50\n1.5\n").values.tolist() == [[1.5]]
    mp.write(clip, "again.tbl")
    assert Path("again.tbl").read_bytes() == TABLE
    blob = mp.compress("heights.tbl")
    assert len(blob) < len(TABLE) / 2
    assert mp.decompress(blob) == TABLE
    loaded = mp.load(blob, frames=slice(100, 200))
    assert loaded.values.tobytes() == clip.values[100:200].tobytes()
    assert loaded.frame_time == clip.frame_time


def test_broken_tables_are_refused_as_other_files_are() -> None:
    Path("short.tbl").write_bytes(TABLE + b"oh\n")
    with pytest.raises(mp.FormatError, match=r"short\.tbl"):
        mp.read("short.tbl")
    Path("headless.tbl").write_bytes(b"1.25\n")
    with pytest.raises(mp.FormatError, match="expected TABLE and a rate"):
        mp.read("headless.tbl")
    with pytest.raises(
        mp.FormatError, match="expected AMC, ASF, BVH, C3D, CSV, GLB, NPY, NPZ, TRC or table"
    ):
        mp.read(b"1.25\n")


def test_compressing_and_restoring() -> None:
    mocapress("compress", ".", "-o", "packed")  # found in a folder by its ending
    assert row("verify", "packed/heights.tbl.mcz")["ok"]
    mocapress("decompress", "packed", "-o", "back")
    assert Path("back/heights.tbl").read_bytes() == TABLE


def test_diffma_json() -> None:
    mocapress("compress", "heights.tbl", "-o", "heights.diffma.json", "--codec", "diffma:bound=1")
    assert row("verify", "heights.diffma.json")["ok"]
    mocapress("decompress", "heights.diffma.json", "-o", "back.tbl")
    assert Path("back.tbl").read_bytes().startswith(b"TABLE 50\n")
    assert mp.load("heights.diffma.json").frames == 1500


def test_info() -> None:
    facts = row("info", "heights.tbl")
    assert (facts["format"], facts["frames"], facts["joints"]) == ("table", 1500, 1)
    mocapress("compress", "heights.tbl")
    packed = row("info", "heights.tbl.mcz")
    assert (packed["format"], packed["frames"]) == ("table", 1500)


def test_converting_from_and_to(samples: Path) -> None:
    mocapress("convert", "heights.tbl", "-o", "heights.bvh")
    there = mp.read("heights.bvh")
    np.testing.assert_array_equal(there.values[:, :1], mp.read("heights.tbl").values)
    assert there.frame_time == mp.read("heights.tbl").frame_time
    mocapress("convert", samples / "freebvh.bvh", "--to", "table", "-o", "walk.tbl")
    walk = mp.read(samples / "freebvh.bvh")
    (height,) = (i for i, column in enumerate(walk.columns) if column.name.endswith("Hips.ty"))
    np.testing.assert_array_equal(mp.read("walk.tbl").values[:, 0], walk.values[:, height])
    mocapress("convert", "heights.bvh", "--to", "table", "-o", "again.tbl")
    np.testing.assert_array_equal(mp.read("again.tbl").values, mp.read("heights.tbl").values)


def test_viewing() -> None:
    mocapress("view", "heights.tbl", "--export", "page.html")
    assert b"heights.tbl" in Path("page.html").read_bytes()


def test_training() -> None:
    Path("more").mkdir()
    for i in range(3):
        Path(f"more/{i}.tbl").write_bytes(TABLE)
    learned = row("train", "more", "-o", "tables.mcm")
    assert learned["clips"] == 3
    mocapress("compress", "heights.tbl", "--model", "tables.mcm")
    mocapress("decompress", "heights.tbl.mcz", "--model", "tables.mcm", "-o", "back.tbl")
    assert Path("back.tbl").read_bytes() == TABLE


def test_a_format_that_cannot_be_loaded_is_named_and_left_out(
    tmp_path: Path, samples: Path
) -> None:
    (tmp_path / "site/tables_for_mocapress.py").write_text("import nothing_of_this_name\n")
    with pytest.warns(UserWarning, match="format table .* is left out"):
        mocapress("compress", "heights.tbl")
    assert mp.decompress("heights.tbl.mcz") == TABLE
    assert mp.read(samples / "freebvh.bvh").frames == 69
