"""The page in a real browser: what a user sees and does."""

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import LAPTOP, PHONE, Visit, chromium, coloured
from playwright.sync_api import Browser

import mocapress as mp
from mocapress.container import diffma_json
from mocapress.motion.columns import skeleton_columns
from mocapress.source import Source
from mocapress.viewer import embed, page

GOLDEN = Path(__file__).parents[1] / "golden"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as started:
        yield started


def _visit(browser: Browser, **settings: Any) -> Iterator[Visit]:
    width, height = settings.pop("size", LAPTOP)
    context = browser.new_context(viewport={"width": width, "height": height}, **settings)
    visit = Visit(context.new_page())
    yield visit
    url = visit.page.url
    context.close()
    assert visit.logged == []
    assert set(visit.asked) <= {url, "about:srcdoc"}


@pytest.fixture
def visit(browser: Browser) -> Iterator[Visit]:
    yield from _visit(browser)


@pytest.fixture
def phone(browser: Browser) -> Iterator[Visit]:
    yield from _visit(browser, size=PHONE, has_touch=True, is_mobile=True, device_scale_factor=2)


def clip(samples: Path, name: str) -> dict[str, Any]:
    return embed.file(samples / name)


def noisy(samples: Path, name: str) -> dict[str, Any]:
    made = mp.read(samples / name)
    noise = np.sin(np.arange(made.values.size)).reshape(made.values.shape)
    return embed.exact(made.with_values(made.values + 3 * noise), "decoded")


def test_an_exported_page_plays_from_disk(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "cmu_01_01.amc")]), tmp_path)
    visit.until("document.body.dataset.frame > 5")
    visit.page.keyboard.press(" ")
    frame = visit.frame
    visit.page.wait_for_timeout(200)
    assert visit.frame == frame
    assert visit.text("#frame") == f"{frame + 1} / 2751"
    assert visit.text("#time").endswith("/ 22.93 s")
    assert visit.names() == ["cmu_01_01.amc"]


def test_the_figure_moves_with_the_frame(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "mocapbank.bvh")]), tmp_path)
    visit.seek(0)
    first = visit.pixels()
    assert coloured(first, 2) > 500
    visit.seek(30)
    later = visit.pixels()
    assert (np.abs(later - first).max(axis=-1) > 0.2).sum() > 500
    visit.seek(0)
    again = visit.pixels()
    assert (np.abs(again - first).max(axis=-1) > 0.2).sum() == 0


def test_the_timeline_scrubs(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "mocapbank.bvh")]), tmp_path)
    visit.page.keyboard.press(" ")
    box = visit.page.locator("#timeline").bounding_box()
    assert box is not None
    mouse, middle = visit.page.mouse, box["y"] + box["height"] / 2
    mouse.move(box["x"] + box["width"] / 4, middle)
    mouse.down()
    assert abs(visit.frame - 454 / 4) < 5
    mouse.move(box["x"] + box["width"] / 2, middle, steps=4)
    mouse.up()
    assert abs(visit.frame - 454 / 2) < 2


def test_the_mouse_turns_the_camera(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "mocapbank.bvh")]), tmp_path)
    visit.seek(0)
    before = visit.pixels()
    visit.page.mouse.move(400, 300)
    visit.page.mouse.down()
    visit.page.mouse.move(600, 300, steps=4)
    visit.page.mouse.up()
    turned = visit.pixels()
    assert (np.abs(turned - before).max(axis=-1) > 0.2).sum() > 500
    visit.page.mouse.wheel(0, 600)
    visit.page.wait_for_timeout(300)
    assert coloured(visit.pixels(), 2) < coloured(turned, 2)


def test_keys_work_and_are_listed(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "cmu_01_01.amc")]), tmp_path)
    keys = visit.page.keyboard
    keys.press("End")
    assert visit.frame == 2750
    keys.press("ArrowLeft")
    keys.press("Shift+ArrowLeft")
    assert visit.frame == 2750 - 1 - 120
    keys.press("Home")
    keys.press("+")
    assert visit.page.locator("#speed").input_value() == "2"
    theme = visit.page.evaluate("document.documentElement.dataset.theme")
    keys.press("d")
    assert visit.page.evaluate("document.documentElement.dataset.theme") != theme
    assert not visit.page.locator("#keys").is_visible()
    keys.press("?")
    listed = visit.page.locator("#bindings kbd").all_inner_texts()
    assert {"Space", "←", "→", "Home", "End", "−", "+", "D", "?"} <= set(listed)
    keys.press("Escape")
    assert not visit.page.locator("#keys").is_visible()


def test_a_decoded_clip_is_compared(visit: Visit, samples: Path, tmp_path: Path) -> None:
    name = "cmu_01_01.amc"
    visit.open(page.document([clip(samples, name), noisy(samples, name)]), tmp_path)
    visit.seek(3)
    assert " cm" in visit.text("#worst")
    assert visit.page.locator("#cells span").count() == 0
    visit.page.keyboard.press("e")  # colours off: original blue, decoded green
    visit.page.keyboard.press("o")
    visit.page.wait_for_timeout(200)
    assert visit.page.locator("#cells span").all_inner_texts() == [name, "decoded"]
    pixels = visit.pixels()
    half = pixels.shape[1] // 2
    assert coloured(pixels[:, :half], 2) > 500
    assert coloured(pixels[:, half:], 1) > 500
    assert coloured(pixels[:, :half], 1) == 0
    without = visit.pixels()
    visit.page.keyboard.press("e")
    assert coloured(visit.pixels(), 0) > coloured(without, 0)  # amber to red, where it errs


def test_exact_copies_differ_by_nothing(visit: Visit, samples: Path, tmp_path: Path) -> None:
    same = clip(samples, "freebvh.bvh")
    visit.open(page.document([same, same]), tmp_path)
    visit.until("document.querySelector('#worst').textContent === '0 cm'")


def test_clips_stand_in_a_grid(visit: Visit, samples: Path, tmp_path: Path) -> None:
    names = ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"]
    visit.open(page.document([clip(samples, name) for name in names]), tmp_path)
    visit.until("document.querySelectorAll('#cells span').length === 3")
    assert visit.names() == names
    assert all("up +y" in facts for facts in visit.page.locator("#legend small").all_inner_texts())


def test_performers_of_one_scene_stand_in_it(visit: Visit, samples: Path, tmp_path: Path) -> None:
    made = mp.read(samples / "cmu_01_01.amc")
    beside = made.values.copy()
    beside[:, 0] += 15
    partner = embed.exact(made.with_values(beside), "partner")
    visit.open(page.document([clip(samples, "cmu_01_01.amc"), partner]), tmp_path)
    visit.seek(300)
    assert visit.text("#mode") == "Side by side"
    assert visit.page.locator("#cells span").count() == 0
    pixels = visit.pixels()
    assert coloured(pixels, 1) > 500
    assert coloured(pixels, 2) > 500
    visit.page.locator("#mode").click()
    visit.until("document.querySelectorAll('#cells span').length === 2")
    assert not visit.page.locator(".heat").is_visible()
    visit.page.locator("#mode").click()
    visit.until("document.body.classList.contains('compared')")


def test_more_clips_are_on_further_pages(visit: Visit, samples: Path, tmp_path: Path) -> None:
    clips = [clip(samples, "freebvh.bvh") | {"name": f"clip {i}"} for i in range(19)]
    visit.open(page.document(clips), tmp_path)
    visit.until("document.querySelectorAll('#cells span').length === 16")
    assert visit.text("#page") == "1–16 of 19"
    visit.page.keyboard.press("PageDown")
    visit.until("document.querySelectorAll('#cells span').length === 3")
    assert visit.page.locator("#cells span").all_inner_texts() == ["clip 16", "clip 17", "clip 18"]
    visit.page.locator("#page-on").click()
    visit.until("document.querySelectorAll('#cells span').length === 16")


def test_a_clip_without_a_skeleton_shows_its_curves(
    visit: Visit, samples: Path, tmp_path: Path
) -> None:
    alone = mp.from_array(np.arange(60.0).reshape(20, 3), names=["a.rx", "a.ry", "b.rx"], fps=30)
    visit.open(page.document([embed.exact(alone, "alone")]), tmp_path)
    visit.seek(7)
    shown = visit.page.locator("#curves .plot")
    assert shown.locator("b").all_inner_texts() == ["a.rx", "a.ry", "b.rx"]
    assert shown.locator("output").all_inner_texts() == ["21", "22", "23"]
    visit.drop(samples / "freebvh.bvh")
    visit.until("document.querySelector('#curves').hidden")


def test_the_inspector_shows_a_joints_channels(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "cmu_01_01.amc")]), tmp_path)
    visit.seek(0)
    joints = visit.page.locator("#inspector select")
    joints.select_option("2")
    assert visit.page.locator(".plot b").all_inner_texts() == [
        "x rotation",
        "y rotation",
        "z rotation",
    ]
    made = mp.read(samples / "cmu_01_01.amc")
    column = [column.name for column in made.columns].index("lfemur.rx")
    shown = float(visit.page.locator(".plot output").first.inner_text())
    assert shown == pytest.approx(made.values[0, column], rel=1e-3)
    visit.page.locator("#inspector input").fill("HEAD")
    assert joints.locator("option").all_inner_texts() == ["head"]
    visit.page.locator("#inspector input").press("Enter")
    shown = float(visit.page.locator(".plot output").first.inner_text())
    column = [column.name for column in made.columns].index("head.rx")
    assert shown == pytest.approx(made.values[0, column], rel=1e-3)
    visit.page.set_viewport_size({"width": 1000, "height": 480})
    box = visit.page.locator("#inspector .plots").bounding_box()
    assert box is not None
    assert box["height"] >= 50
    assert box["y"] + box["height"] <= 480


def test_dropped_files_play(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([]), tmp_path)
    assert visit.page.locator(".welcome").is_visible()
    assert visit.pixels().mean() > 0.8  # the page's light ground, through an empty canvas
    visit.drop(samples / "freebvh.bvh")
    visit.until("document.body.dataset.frame > 0")
    visit.drop(samples / "cmu_01_01.amc", samples / "cmu_01_01.asf")
    visit.until("document.querySelector('#frame').textContent.endsWith('2751')")
    assert visit.names() == ["cmu_01_01.amc"]
    visit.drop(samples / "mocapbank.bvh", zone="add")
    visit.until("document.querySelectorAll('#cells span').length === 2")
    assert visit.names() == ["cmu_01_01.amc", "mocapbank.bvh"]
    visit.drop(samples / "cmu_01_01.amc")
    visit.until("document.querySelector('.notice')?.textContent.includes('no skeleton')")


def test_diffma_json_plays(visit: Visit, samples: Path, tmp_path: Path) -> None:
    source, file = samples / "cmu_01_01.amc", tmp_path / "walk.diffma.json"
    file.write_bytes(mp.to_json(source, "diffma:bound=16"))
    visit.open(page.document([embed.file(source), embed.file(file)]), tmp_path)
    visit.until("document.body.dataset.frame > 3")
    assert visit.page.evaluate("document.body.classList.contains('compared')")
    visit.drop(file)
    visit.until("document.querySelectorAll('#legend b').length === 1")
    assert visit.names() == ["walk.diffma.json"]
    assert visit.text("#frame").endswith("/ 2751")
    visit.drop(("bad.diffma.json", file.read_bytes().replace(b'"bits":6', b'"bits":66')))
    visit.until("document.querySelector('.notice') !== null")
    assert visit.text(".notice").startswith("bad.diffma.json: $.params.bits: expected 1 to 12")


def test_dropped_mcz_play(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([]), tmp_path)
    motion = tmp_path / "cmu_01_01.amc.mcz"
    motion.write_bytes(mp.compress(samples / "cmu_01_01.amc"))
    visit.drop(motion)
    visit.until("document.querySelector('.notice')?.textContent.includes('drop the .asf with it')")
    assert visit.text("#frame").endswith("/ 2751")
    visit.drop(motion, samples / "cmu_01_01.asf")
    visit.until("document.querySelector('.notice') === null")
    visit.seek(0)
    assert coloured(visit.pixels(), 2) > 500
    visit.drop(GOLDEN / "v1_trained.bvh.mcz")
    visit.until("document.querySelector('.notice')?.textContent.includes('needs a model')")
    visit.drop(GOLDEN / "v1_trained.bvh.mcz", GOLDEN / "v1_trained.mcm", GOLDEN / "v1_learner.mcm")
    visit.until("document.querySelector('#legend b').textContent === 'v1_trained.bvh.mcz'")
    packed = diffma_json.named("a.diffma.json.xz", mp.to_json(samples / "freebvh.bvh"))
    visit.drop(("a.diffma.json.xz", packed))
    visit.until("document.querySelector('#frame').textContent.endsWith('/ 69')")
    visit.drop(("cut.mcz", motion.read_bytes()[:5000]))
    visit.until("document.querySelector('.notice') !== null")
    assert visit.text(".notice").startswith("cut.mcz, byte 5000: the file is cut off")
    assert visit.names() == ["a.diffma.json.xz"]


def test_an_exported_page_says_which_decoder_it_lacks(
    visit: Visit, samples: Path, tmp_path: Path
) -> None:
    made = clip(samples, "freebvh.bvh")
    visit.open(page.document([made], assets=embed.assets([made])), tmp_path)
    visit.until("document.body.dataset.frame > 3")
    visit.drop(("a.mcz", mp.compress(samples / "mocapbank.bvh", "app")))
    visit.until("document.querySelector('.notice') !== null")
    assert "this page does not carry the decoder" in visit.text(".notice")
    assert "wasm/app.wasm" in visit.text(".notice")


def test_the_page_goes_on_while_a_file_is_read(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "freebvh.bvh")]), tmp_path)
    made = mp.read(samples / "cmu_01_01.amc")
    rows = np.resize(np.arange(made.frames), 20_000)
    long = mp.compress(made.with_frames(made.values[rows], made.frame_time), "exact:level=9")
    visit.page.evaluate(
        "globalThis.drawn = 0; (function count() {"
        " if (document.body.classList.contains('reading')) drawn += 1;"
        " requestAnimationFrame(count); })()"
    )
    visit.drop(("long.mcz", long))
    visit.until("document.querySelector('#frame').textContent.endsWith('/ 20000')")
    assert visit.page.evaluate("drawn") > 1  # at most once, if reading held the page up


def test_a_long_clip_shows_its_first_frame_before_it_is_read(
    visit: Visit, samples: Path, tmp_path: Path
) -> None:
    made = mp.read(samples / "cmu_01_01.amc")
    rows = np.resize(np.arange(made.frames), 30_000)
    long = embed.exact(made.with_frames(made.values[rows], made.frame_time), level=9)
    visit.open(page.document([long]), tmp_path)
    assert visit.text("#frame") == "1 / 512"
    assert coloured(visit.pixels(), 2) > 500
    visit.until("document.querySelector('#frame').textContent.endsWith('/ 30000')")
    visit.until("document.body.dataset.frame > 3")


DECODE = """async ([modules, text]) => {
    const urls = new Map();
    for (const [path, source] of modules) {
        const named = source.replace(/"module:([^"]+)"/g, (_, name) => `"${urls.get(name)}"`);
        urls.set(path, URL.createObjectURL(new Blob([named], {type: "text/javascript"})));
    }
    const {decode} = await import(urls.get("diffma/diffma.js"));
    return decode(text).channels.map((channel) =>
        Array.from(new BigUint64Array(channel.buffer, channel.byteOffset, channel.length), String));
}"""


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh"])
@pytest.mark.parametrize("codec", ["bound=4", "bits=8,order=auto,per=channel,max_error=0.01"])
def test_the_browser_decodes_bit_for_bit(
    visit: Visit, samples: Path, name: str, codec: str
) -> None:
    text = mp.to_json(samples / name, f"diffma:{codec}")
    modules = [[k, v] for k, v in page.modules().items() if k.startswith("diffma/")]
    visit.page.goto("about:blank")
    bits = visit.page.evaluate(DECODE, [modules, text.decode()])
    expected = diffma_json.json_to_clip(Source(text)).values
    np.testing.assert_array_equal(
        np.array(bits, dtype=np.uint64).T, np.ascontiguousarray(expected).view(np.uint64)
    )


def test_a_broken_file_is_told_of(visit: Visit, samples: Path, tmp_path: Path) -> None:
    visit.open(page.document([clip(samples, "freebvh.bvh")]), tmp_path)
    broken = (samples / "mocapbank.bvh").read_bytes().replace(b"JOINT", b"JOINTS", 1)
    (tmp_path / "broken.bvh").write_bytes(broken)
    with pytest.raises(mp.FormatError) as error:
        mp.read(tmp_path / "broken.bvh")
    visit.drop(tmp_path / "broken.bvh")
    visit.until("document.querySelector('.notice') !== null")
    notice = visit.text(".notice")
    assert notice.startswith(f"broken.bvh, line {error.value.line}: {error.value.what}; expected ")
    assert visit.names() == ["freebvh.bvh"]  # what was there goes on playing
    visit.page.locator(".notice button").click()
    assert visit.page.locator(".notice").count() == 0


def test_markup_in_names_is_text(visit: Visit, samples: Path, tmp_path: Path) -> None:
    markup = "<img src=x onerror=alert(1)></script><b>"
    plain = mp.read(samples / "freebvh.bvh")
    assert plain.skeleton is not None
    joints = tuple(replace(joint, name=markup) for joint in plain.skeleton.joints)
    skeleton = replace(plain.skeleton, joints=joints)
    columns = skeleton_columns(skeleton)
    made = embed.exact(mp.Clip.of(plain.values, columns, plain.frame_time, skeleton), markup)
    visit.open(page.document([made, made, made], title=markup), tmp_path)
    visit.until("document.querySelectorAll('#cells span').length === 3")
    assert visit.names() == [markup] * 3
    assert visit.page.locator("option").first.inner_text() == markup
    visit.drop((f"{markup}.bvh", b"nothing"))
    visit.until("document.querySelector('.notice') !== null")
    assert visit.text(".notice").startswith(f"{markup}.bvh")
    assert visit.page.locator("img").count() == 0
    assert visit.page.title() == markup


@pytest.mark.parametrize("files", [["cmu_01_01.amc"], ["cmu_01_01.amc", "freebvh.bvh"]])
def test_everything_fits_a_phone(
    phone: Visit, samples: Path, tmp_path: Path, files: list[str]
) -> None:
    phone.open(page.document([clip(samples, name) for name in files]), tmp_path)
    phone.seek(0)
    assert phone.page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]
    for selector in (
        "nav button:not([hidden])",
        "footer button",
        "#timeline",
        "#speed",
        ".camera #follow",
    ):
        for found in phone.page.locator(selector).all():
            box = found.bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= PHONE[0]
            assert box["y"] + box["height"] <= PHONE[1]
    assert coloured(phone.pixels(), 2) > 500
    phone.page.locator("#show-inspector").tap()
    assert phone.page.locator(".plot").count() == 6


def test_the_served_page_plays(visit: Visit, samples: Path) -> None:
    command = "from mocapress.cli import main; main()"
    words = ["view", "--no-browser", str(samples / "cmu_01_01.amc"), str(samples / "freebvh.bvh")]
    process = subprocess.Popen(
        [sys.executable, "-c", command, *words], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        url = process.stdout.readline().split()[0]
        assert url.startswith("http://127.0.0.1:")
        visit.page.goto(url)
        visit.until("document.body.dataset.frame > 3")
        assert visit.names() == ["cmu_01_01.amc", "freebvh.bvh"]
    finally:
        process.terminate()
        process.communicate(timeout=30)


def test_a_clip_plays_in_a_notebook(visit: Visit, samples: Path, tmp_path: Path) -> None:
    markup = mp.read(samples / "freebvh.bvh")._repr_html_()
    file = tmp_path / "notebook.html"
    file.write_text(f"<!doctype html><link rel=icon href=data:,><h1>Notebook</h1>{markup}")
    visit.page.goto(file.as_uri())
    inner = visit.page.frame_locator("iframe")
    inner.locator("#frame", has_text="/ 69").wait_for()
    first = inner.locator("#frame").inner_text()
    visit.page.wait_for_timeout(500)
    assert inner.locator("#frame").inner_text() != first
