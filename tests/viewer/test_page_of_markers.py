"""Markers on the page: read as mocapress reads them, of a file and of its .mcz; drawn with gaps."""

import base64
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import LAPTOP, Visit, chromium, coloured
from playwright.sync_api import Browser
from test_reading import read_by_page, read_natively, sha256

import mocapress as mp
from mocapress.viewer import embed, page

sys.path.append(str(Path(__file__).parents[1] / "formats"))
from c3d_files import DEC, INTEL, MIPS, c3d, swapped, walk
from table_files import markers, trc


def compare(path: Path, *, packed: bool = True) -> None:
    """Compare what the page reads of a file, and of its .mcz, with what mocapress does."""
    clip = read_natively(path)
    found = mp.markers(clip)
    places = np.where(found.valid[:, :, None], found.positions, np.nan)
    columns = {
        f"{label}.{axis}": places[:, i, k]
        for i, label in enumerate(found.labels)
        for k, axis in enumerate("xyz")
    }
    analog = clip.streams.get("analog")
    if analog is not None:
        names = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in analog.columns]
        columns |= dict(zip(names, analog.values.T, strict=True))
    files = [path]
    if packed:
        files.append(path.with_name(f"{path.name}.mcz"))
        files[-1].write_bytes(mp.compress(path))
    for file in files:
        (made,) = read_by_page(file)["clips"]
        assert sorted(made["names"]) == sorted(columns), file
        assert made["frames"] == clip.frames, file
        expected = float(clip.frame_time) if clip.frame_time else None
        assert made["frameTime"] == pytest.approx(expected, rel=1e-15), file
        values = np.concatenate([columns[name] for name in made["names"]])
        assert made["values"] == sha256(values), file


@pytest.mark.parametrize("processor", [INTEL, DEC, MIPS])
@pytest.mark.parametrize("floats", [True, False])
def test_c3d_of_every_encoding(processor: int, floats: bool, tmp_path: Path) -> None:
    points, words, analog = walk(floats=floats)
    words[4, 1] = -1
    file = tmp_path / "walk.c3d"
    file.write_bytes(c3d(points, words, analog, processor=processor, floats=floats, samples=4))
    compare(file)


@pytest.mark.parametrize("delimiter", ["\t", ",", ";"])
@pytest.mark.parametrize("missing", ["", "NaN"])
def test_trc_of_every_dialect(delimiter: str, missing: str, tmp_path: Path) -> None:
    file = tmp_path / "walk.trc"
    places = markers()
    places[:, 9:] = np.nan  # never seen, so that the stream does not hold it
    file.write_bytes(trc(places, delimiter=delimiter, missing=missing))
    compare(file)


@pytest.mark.corpus
def test_c3d_of_many_makers(corpus: Path) -> None:
    files = sorted((corpus / "markers/c3d").glob("*/*.c3d"))
    done = 0
    for path in files:
        try:
            mp.markers(read_natively(path))
        except mp.MocapressError:
            continue
        if path.stat().st_size > 1e6:
            continue
        compare(path, packed=False)
        done += 1
    assert done > 40


def test_broken_files_are_told_of(tmp_path: Path) -> None:
    points, words, analog = walk()
    broken = {
        "short.c3d": c3d(points, words, analog, samples=4, announced=60),
        "none.c3d": swapped(c3d(points, words, analog, samples=4)[:1500], 16, 3),
        "empty.c3d": b"",
        "short.trc": trc(markers(), declared=900),
        "row.trc": trc(markers()) + b"151\t1.25\t7\r\n",
        "labels.trc": b"PathFileType\t4\r\n1\t2\t3\r\n",
        "empty.trc": b"",
    }
    for name, data in broken.items():
        (tmp_path / name).write_bytes(data)
        made = read_by_page(tmp_path / name)
        assert made["clips"] == [], name
        assert made["errors"][0].startswith(f"{name}: "), name


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as started:
        yield started


@pytest.fixture
def visit(browser: Browser) -> Iterator[Visit]:
    context = browser.new_context(viewport={"width": LAPTOP[0], "height": LAPTOP[1]})
    visit = Visit(context.new_page())
    yield visit
    context.close()
    assert visit.logged == []


def figure(frames: int = 60) -> mp.Clip:
    """Give a standing figure of Plug-in Gait's markers, in millimetres, one of them with a gap."""
    places = {
        "LFHD": (80, 100, 1700), "RFHD": (-80, 100, 1700), "LBHD": (80, -100, 1700),
        "RBHD": (-80, -100, 1700), "C7": (0, -100, 1500), "CLAV": (0, 120, 1450),
        "LSHO": (200, 0, 1480), "RSHO": (-200, 0, 1480), "LELB": (260, 0, 1150),
        "RELB": (-260, 0, 1150), "LASI": (120, 120, 1000), "RASI": (-120, 120, 1000),
        "LPSI": (60, -120, 1020), "RPSI": (-60, -120, 1020), "LKNE": (130, 20, 520),
        "RKNE": (-130, 20, 520), "LANK": (120, 0, 90), "RANK": (-120, 0, 90),
        "LTOE": (120, 180, 40), "RTOE": (-120, 180, 40),
    }  # fmt: skip
    values = np.tile(np.array(list(places.values()), float), (frames, 1, 1))
    values[:, :, 1] += 5 * np.arange(frames)[:, None]
    values[20:40, list(places).index("LKNE")] = np.nan
    columns = tuple(
        mp.Column(f"{label}.{axis}", i, axis, "mm")
        for i, label in enumerate(places)
        for axis in "xyz"
    )
    stream = mp.Stream(values.reshape(frames, -1), columns)
    return mp.Clip({"points": stream}, None, "figure")


def test_markers_are_drawn_with_bones_gaps_and_analog_curves(visit: Visit, tmp_path: Path) -> None:
    mp.write(figure(), tmp_path / "figure.c3d", fps=100)
    visit.open(page.document([embed.file(tmp_path / "figure.c3d")]), tmp_path)
    visit.seek(5)
    whole = visit.pixels()
    visit.seek(30)
    gap = visit.pixels()
    assert coloured(whole, 2) > coloured(gap, 2)  # bones to the knee are gone
    assert coloured(gap, 0) > coloured(whole, 0)  # and a red ball is where it was
    options = visit.page.locator("select[role=listbox] option").all_inner_texts()
    assert [text.strip() for text in options][:2] == ["LFHD", "RFHD"]
    visit.page.locator("select[role=listbox]").select_option("14")
    assert "missing" in visit.page.locator(".plots").inner_text()


def test_a_page_of_a_c3d_holds_names_scales_and_analog_data(tmp_path: Path) -> None:
    points, words, analog = walk(floats=False)
    file = tmp_path / "a.c3d"
    file.write_bytes(c3d(points, words, analog, floats=False, samples=4))
    clip = mp.read(file)
    for source in (file, tmp_path / "a.mcz"):
        (tmp_path / "a.mcz").write_bytes(mp.compress(file))
        held: Any = mp.load(base64.b64decode(embed.file(source)["mcz"]))
        assert list(held.streams) == ["points", "analog"]
        valid = np.repeat(mp.markers(clip).valid, 3, axis=1)
        assert np.array_equal(held.values[valid], clip.values[valid])
        assert np.isnan(held.values[~valid]).all()
        assert held.columns[0].name == "M0.x"
        assert np.array_equal(held.streams["analog"].values, clip.streams["analog"].values)
