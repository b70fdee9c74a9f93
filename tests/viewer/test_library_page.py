"""A library on the page: its list, its clips, and what the server gives of it."""

import json
import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from browsing import LAPTOP, PHONE, Visit, chromium, coloured
from playwright.sync_api import Browser
from similar import bvh_of, similar_takes
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.codecs import Model
from mocapress.viewer import page
from mocapress.viewer.library import ServedLibrary
from mocapress.viewer.server import PageServer, first_of, nothing

AMC, ASF, BVH = "cmu_01_01.amc", "cmu_01_01.asf", "mocapbank.bvh"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as started:
        yield started


@pytest.fixture
def path(tmp_path: Path, samples: Path) -> Path:
    """A library: three takes, a cut of one of them, a lossy clip, and a text."""
    file = tmp_path / "takes.mocapdb"
    with mp.open_library(file, "a") as library:
        library.add(samples / AMC, f"cmu/{AMC}", labels=["walk"])
        library.add(samples / BVH, f"bank/{BVH}", labels=["walk", "slow"])
        library.add(samples / "freebvh.bvh", "<b>free.bvh", codec="app")
        library.add(mp.read(samples / AMC)[100:900], "cut")
        library.add(b"no motion", "read.me")
    return file


@contextmanager
def visited(
    browser: Browser, library: ServedLibrary | None, size: tuple[int, int]
) -> Iterator[Visit]:
    name = library.name if library else None
    document = page.document([], served=True, library=name)
    more = first_of(library.answer if library else nothing, page.lent)
    with PageServer(document, page.policy(served=True), 0, more) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        context = browser.new_context(viewport={"width": size[0], "height": size[1]})
        try:
            visit = Visit(context.new_page())
            visit.page.goto(server.url)
            yield visit
        finally:
            context.close()
            server.shutdown()
            thread.join()
        assert visit.logged == []
        visit.asked = [url.removeprefix(server.url) for url in visit.asked]


@contextmanager
def served(browser: Browser, path: Path, size: tuple[int, int] = LAPTOP) -> Iterator[Visit]:
    with ServedLibrary(path) as library, visited(browser, library, size) as visit:
        visit.until("document.querySelectorAll('.clips [role=option]').length > 0")
        yield visit
    known = {"", "catalogue", "clips", "similar"}
    assert {url.split("/")[0] for url in visit.asked} <= known


@contextmanager
def empty(browser: Browser) -> Iterator[Visit]:
    with visited(browser, None, LAPTOP) as visit:
        visit.until("document.body.classList.contains('empty')")
        yield visit


def listed(visit: Visit) -> list[str]:
    names: list[str] = visit.page.locator(".clips [role=option] > span").all_inner_texts()
    return names


def plays(visit: Visit, name: str, frames: int) -> None:
    visit.page.locator(".clips button", has_text=name).click()
    visit.until(f"document.querySelector('#frame').textContent.endsWith('/ {frames}')")
    visit.until("document.body.dataset.frame > 0")
    assert coloured(visit.pixels(), 2) > 500


def test_a_click_plays_a_clip(browser: Browser, path: Path) -> None:
    with served(browser, path) as visit:
        assert listed(visit) == ["<b>free.bvh", f"bank/{BVH}", f"cmu/{AMC}", "cut"]
        visit.until("document.querySelector('#frame').textContent.endsWith('/ 69')")  # the first
        plays(visit, BVH, 455)
        assert visit.names() == [f"bank/{BVH}"]
        plays(visit, "cut", 800)  # whose frames the library has once
        plays(visit, AMC, 2751)
        visit.page.locator(".clips button", has_text="cut").click(modifiers=["Shift"])
        visit.until("document.querySelectorAll('#legend b').length === 2")


def test_the_list_is_filtered(browser: Browser, path: Path) -> None:
    with served(browser, path) as visit:
        search = visit.page.locator("#library [type=search]")
        search.fill("walk bvh")
        assert listed(visit) == [f"bank/{BVH}"]
        assert visit.text("#library output") == "1 of 4 clips"
        search.fill("")
        visit.page.locator("#library [name=labels]").select_option("walk")
        assert listed(visit) == [f"bank/{BVH}", f"cmu/{AMC}"]
        visit.page.locator("#library [name=labels]").select_option("")
        visit.page.locator("#library [name=format]").select_option("bvh")
        assert listed(visit) == ["<b>free.bvh", f"bank/{BVH}"]
        visit.page.get_by_label("Least seconds").fill("3")
        assert listed(visit) == [f"bank/{BVH}"]
        visit.page.get_by_label("Least seconds").fill("")
        visit.page.get_by_label("Most seconds").fill("3")
        assert listed(visit) == ["<b>free.bvh"]


def test_a_long_list_is_made_in_parts(browser: Browser, tmp_path: Path, samples: Path) -> None:
    path = tmp_path / "many.mocapdb"
    clip = mp.read(samples / BVH)
    with mp.open_library(path, "a") as library, library.db.writing():
        for number in range(230):
            library.add(clip[number : number + 4], f"{number:03}", codec="exact:level=1")
    with served(browser, path) as visit:
        assert len(listed(visit)) == 200
        visit.page.locator(".clips .more").click()
        assert listed(visit) == [f"{number:03}" for number in range(230)]


def test_on_a_phone_the_list_makes_room(browser: Browser, path: Path) -> None:
    with served(browser, path, PHONE) as visit:
        visit.page.locator(".clips button", has_text=BVH).click()
        visit.until("document.body.dataset.frame > 0")
        assert not visit.page.locator("#library").is_visible()
        visit.page.locator("#show-library").click()
        assert visit.page.locator("#library").is_visible()


def test_a_damaged_clip_is_told_of(browser: Browser, path: Path) -> None:
    with mp.open_library(path, "a") as library, library.db.writing() as connection:
        connection.execute("UPDATE chunks SET sections = zeroblob(length(sections)) WHERE clip = 2")
    with served(browser, path) as visit:
        visit.until("document.body.dataset.frame > 0")
        visit.page.locator(".clips button", has_text=BVH).click()
        visit.until("document.querySelector('.notice') !== null")
        assert f"bank/{BVH}" in visit.text(".notice")
        assert "chunk of frames 0 to 454" in visit.text(".notice")
        plays(visit, AMC, 2751)  # the others play
        (logged,) = visit.logged  # the browser's own remark
        assert "409" in logged
        visit.logged.clear()


def test_a_dropped_library_is_read_by_sqlite(browser: Browser, path: Path, samples: Path) -> None:
    with mp.open_library(path, "a") as library:
        library.add(samples / AMC, "copy.amc")
        library.add(samples / "markers.c3d", "markers.c3d")
    with empty(browser) as visit:
        visit.drop(samples / BVH)
        visit.until("document.querySelector('#frame').textContent.endsWith('/ 455')")
        assert not any("sqlite" in url for url in visit.asked)
        visit.drop(path)
        visit.until("document.querySelectorAll('.clips [role=option]').length === 6")
        assert listed(visit)[1:] == [f"bank/{BVH}", f"cmu/{AMC}", "copy.amc", "cut", "markers.c3d"]
        visit.page.locator("#library [name=labels]").select_option("slow")
        plays(visit, BVH, 455)
        visit.page.locator("#library [name=labels]").select_option("")
        plays(visit, f"cmu/{AMC}", 2751)
        plays(visit, "copy.amc", 2751)  # all of it is in the other
        plays(visit, "cut", 800)
        visit.seek(0)
        first = mp.read(samples / AMC).values[100, 0]
        shown = float(visit.page.locator(".plot output").first.inner_text())
        assert shown == pytest.approx(first, rel=1e-3)
        visit.page.locator(".clips button", has_text="markers").click()
        visit.until("document.querySelector('#frame').textContent.endsWith('/ 300')")
        assert visit.page.locator(".notice").count() == 0
    assert sum("sqlite" in url for url in visit.asked) == 2
    assert not any(url.startswith(("clips", "catalogue")) for url in visit.asked)


def test_a_stretch_is_marked_and_found(browser: Browser, path: Path) -> None:
    with served(browser, path) as visit:
        plays(visit, AMC, 2751)
        button = visit.page.locator("#similar")
        button.click()
        visit.until("document.querySelector('#library output').textContent.includes('like cmu/')")
        assert sorted(listed(visit)) == sorted(["<b>free.bvh", f"bank/{BVH}", "cut"])
        visit.page.locator("#library output button").click()
        assert len(listed(visit)) == 4
        visit.seek(400)
        visit.page.keyboard.press("m")
        visit.seek(639)
        visit.page.keyboard.press("m")
        assert button.inner_text() == "Find frames 401 to 640"
        visit.page.keyboard.press("s")
        visit.until("document.querySelector('#library output').textContent.includes('frames 401')")
        assert listed(visit)[:2] == [f"cmu/{AMC}", "cut"]
        # The first frame of the cut is the 101st of the take.
        visit.page.locator(".clips button", has_text="cut").first.click()
        visit.until("document.querySelector('#frame').textContent.endsWith('/ 800')")
        visit.until("document.body.dataset.frame >= 290")
        box = visit.page.locator("#timeline").bounding_box()
        assert box is not None
        visit.page.keyboard.down("Shift")
        visit.page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 20)
        visit.page.mouse.down()
        visit.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 20)
        visit.page.mouse.up()
        visit.page.keyboard.up("Shift")
        assert re.fullmatch(r"Find frames (19|20)\d to (39|40)\d", button.inner_text())
        button.click()
        visit.until("document.querySelector('#library output').textContent.includes('of cut')")


def scores(visit: Visit) -> list[float]:
    told = visit.page.locator(".clips small").all_inner_texts()
    return [float(re.findall(r"score ([0-9.]+)", one)[0]) for one in told]


def test_a_dropped_library_is_searched(browser: Browser, path: Path, samples: Path) -> None:
    with mp.open_library(path, "a") as library:
        library.add(samples / AMC, "copy.amc")
        library.add(samples / "markers.c3d", "markers.c3d")
        clips = library.search("cut")
        stretch = slice(40, 160)
        there = [
            (hit.name, hit.seconds[0]) for hit in library.search("cut", frames=stretch, within=True)
        ]
        library.add(mp.read(samples / AMC)[:200], "damaged")
        with library.db.writing() as connection:
            connection.execute("UPDATE features SET rows = x'05000000aa' WHERE clip = 8")
    with empty(browser) as visit:
        visit.drop(path)
        visit.until("document.querySelectorAll('.clips [role=option]').length === 7")
        plays(visit, "cut", 800)
        visit.page.locator("#similar").click()
        visit.until("document.querySelector('#library output').textContent.includes('like cut')")
        assert listed(visit) == [hit.name for hit in clips]
        assert scores(visit) == pytest.approx([hit.score for hit in clips], abs=0.006)
        visit.seek(40)
        visit.page.keyboard.press("m")
        visit.seek(159)
        visit.page.keyboard.press("m")
        visit.page.keyboard.press("s")
        visit.until("document.querySelector('#library output').textContent.includes('frames 41')")
        assert set(listed(visit)[:3]) == {"cut", f"cmu/{AMC}", "copy.amc"}
        assert scores(visit) == sorted(scores(visit))
        for row, name in enumerate(listed(visit)[:3]):
            told = visit.page.locator(".clips small").nth(row).inner_text()
            begins = [start for other, start in there if other == name]
            assert min(abs(float(told.split()[0]) - start) for start in begins) < 0.2
        visit.page.locator("#library output button").click()
        for name, frames in (("markers.c3d", 300), ("damaged", 200)):
            plays(visit, name, frames)
            visit.page.keyboard.press("s")
            visit.until(f"document.querySelector('.notice')?.textContent.includes('{name}')")
            visit.page.locator(".notice button").click()


def test_a_clip_without_a_body_is_told_of(browser: Browser, path: Path, samples: Path) -> None:
    with mp.open_library(path, "a") as library:
        library.add(samples / "markers.c3d")
    with served(browser, path) as visit:
        visit.page.locator(".clips button", has_text="markers").click()
        visit.until("document.querySelector('#frame').textContent.endsWith('/ 300')")
        visit.page.locator("#similar").click()
        visit.until("document.querySelector('.notice')?.textContent.includes('skeleton')")
        visit.logged.clear()  # the browser's own line about the answer


def test_broken_libraries_are_told_of(browser: Browser, path: Path, samples: Path) -> None:
    data = path.read_bytes()
    with empty(browser) as visit:
        for name, broken in (
            ("text.mocapdb", b"no database" * 500),
            ("cut.mocapdb", data[:3000]),
            ("empty.mocapdb", b""),
            ("other.mocapdb", data[:68] + bytes(4) + data[72:]),
        ):
            visit.drop((name, broken))
            visit.until(f"document.querySelector('.notice')?.textContent.startsWith('{name}')")
        visit.drop(path)
        visit.until("document.body.dataset.frame > 0")  # the page goes on


def test_a_page_from_disk_cannot_read_a_library(
    browser: Browser, path: Path, tmp_path: Path
) -> None:
    context = browser.new_context()
    visit = Visit(context.new_page())
    visit.open(page.document([]), tmp_path)
    visit.drop(path)
    visit.until("document.querySelector('.notice')?.textContent.includes('mocapress view')")
    context.close()
    assert visit.logged == []


def test_the_server_gives_what_the_library_has(path: Path, samples: Path) -> None:
    with ServedLibrary(path) as library:
        catalogue = library.answer("/catalogue")
        assert catalogue is not None
        clips = {clip["name"]: clip for clip in json.loads(catalogue.content)["clips"]}
        assert clips[f"bank/{BVH}"]["labels"] == ["slow", "walk"]
        assert clips[f"bank/{BVH}"]["seconds"] == pytest.approx(455 / 30, rel=1e-3)
        for name, values in (
            (f"cmu/{AMC}", mp.read(samples / AMC).values),
            ("cut", mp.read(samples / AMC).values[100:900]),
        ):
            answer = library.answer(f"/clips/{clips[name]['id']}")
            assert answer is not None
            assert answer.status == 200
            assert mp.load(answer.content).values.tobytes() == values.tobytes()
        assert library.answer("/clips/99").status == 409  # type: ignore[union-attr]
        assert library.answer("/clips/9999999999999999999999") is None
        assert library.answer("/clips/1/../../x") is None
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_a_clip_that_needs_a_model_plays(tmp_path: Path, samples: Path) -> None:
    path = tmp_path / "trained.mocapdb"
    clip = mp.read(samples / AMC)
    model: Model = mp.train([clip], "exact")
    with mp.open_library(path, "a") as library:
        number = library.add(clip, "trained", model=model).id
    with ServedLibrary(path) as served_library:
        answer = served_library.answer(f"/clips/{number}")
        assert answer is not None
        assert mp.load(answer.content).values.tobytes() == clip.values.tobytes()


def test_a_sharded_library_plays(browser: Browser, tmp_path: Path, samples: Path) -> None:
    pytest.importorskip("pyarrow")
    folder = tmp_path / "takes"
    with mp.open_library(f"{folder}/", "a") as library:
        for name in (BVH, "freebvh.bvh"):
            library.add(samples / name)
    with served(browser, folder) as visit:
        assert listed(visit) == ["freebvh.bvh", BVH]
        plays(visit, BVH, 455)
        visit.page.locator("#similar").click()
        visit.until("document.querySelector('#library output').textContent.includes('like')")


def test_the_command_knows_sharded_libraries(
    tmp_path: Path, samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyarrow")
    given: list[str] = []
    monkeypatch.setattr(
        "mocapress.cli.view.serve", lambda document, *_, **__: given.append(document)
    )
    with mp.open_library(f"{tmp_path}/takes/", "a") as library:
        library.add(samples / "freebvh.bvh")
    for name in (f"{tmp_path}/takes", f"{tmp_path}/takes/", f"file://{tmp_path}/takes"):
        done = CliRunner().invoke(app, ["view", "--no-browser", name])
        assert done.exit_code == 0, done.output
    assert all("<title>takes" in document for document in given), given[0][:300]
    assert len(given) == 3
    done = CliRunner().invoke(app, ["view", "--no-browser", f"file://{tmp_path}/nothing"])
    assert (done.exit_code, "no manifest" in done.output) == (1, True)


@pytest.fixture
def similar(tmp_path: Path) -> Path:
    """A library whose clips are predicted from each other, and one that shares frames with one."""
    pytest.importorskip("cv2")
    file = tmp_path / "similar.mocapdb"
    with mp.open_library(file, "a") as library:
        for name, data in similar_takes().items():
            library.add(data, f"{name}.bvh", codec="exact:level=1")
        library.recompress_together(["a.bvh", "b.bvh", "c.bvh", "d.bvh"], "mrpa")
        cut = mp.read(similar_takes()["b"]).values[100:500]
        library.add(bvh_of(cut), "cut.bvh")
        with library.db.reading() as connection:
            (count,) = connection.execute("SELECT count(*) FROM needs WHERE clip = 2").fetchone()
            assert count
            assert connection.execute("SELECT DISTINCT source FROM runs").fetchall() == [(2,)]
    return file


def test_clips_predicted_from_others_are_served_on_their_own(similar: Path) -> None:
    files = similar_takes()
    with ServedLibrary(similar) as library:
        catalogue = library.answer("/catalogue")
        assert catalogue is not None
        clips = json.loads(catalogue.content)["clips"]
        assert [clip["name"] for clip in clips] == ["a.bvh", "b.bvh", "c.bvh", "cut.bvh", "d.bvh"]
        for clip in clips:
            answer = library.answer(f"/clips/{clip['id']}")
            assert answer is not None
            assert answer.status == 200
            original = mp.read(files[clip["name"][0]] if clip["name"] != "cut.bvh" else files["b"])
            wanted = original[100:500] if clip["name"] == "cut.bvh" else original
            found = mp.load(answer.content)  # which reads no chunk that needs another clip
            assert found.values.tobytes() == wanted.values.tobytes()
            assert found.frame_time == wanted.frame_time
            assert found.skeleton == wanted.skeleton


def test_clips_predicted_from_others_play_where_they_are_served(
    browser: Browser, similar: Path
) -> None:
    with served(browser, similar) as visit:
        plays(visit, "b.bvh", 700)
        plays(visit, "cut.bvh", 400)


def test_a_dropped_library_says_what_it_cannot_play(browser: Browser, similar: Path) -> None:
    with empty(browser) as visit:
        visit.drop(similar)
        visit.until("document.querySelectorAll('.clips [role=option]').length === 5")
        for name in ("b.bvh", "cut.bvh"):
            visit.page.locator(".clips button", has_text=name).click()
            visit.until("document.querySelector('.notice') !== null")
            notice = visit.text(".notice")
            assert notice.startswith("b.bvh: is predicted from other clips of the library")
            assert "mocapress view" in notice
            visit.page.locator(".notice button").click()
        plays(visit, "a.bvh", 1500)  # which needs no other


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["none.mocapdb"], 1, "No such file"),
        (["bad.mocapdb"], 1, "not a database"),
        (["bad.mocapdb", "other.bvh"], 2, "alone"),
        (["bad.mocapdb", "--export", "page.html"], 2, "--export"),
    ],
)
def test_what_cannot_be_viewed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], code: int, told: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.mocapdb").write_bytes(b"no database" * 100)
    done = CliRunner().invoke(app, ["view", "--no-browser", *words])
    assert done.exit_code == code
    assert told in done.output
    assert not Path("page.html").exists()
