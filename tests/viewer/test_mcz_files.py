"""What the page decodes is what mocapress decodes, bit for bit; damaged files end in an error."""

import base64
import hashlib
import os
import random
import runpy
import shutil
import subprocess
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path

import pytest
from browsing import chromium

import mocapress as mp
from mocapress.api.opening import Opened
from mocapress.source import Source
from mocapress.viewer import page

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests/golden"
SCRIPT = Path(__file__).with_name("mcz_digest.mjs")
PATIENCE = 120
CODECS = [
    *(f"exact:level={level}" for level in (1, 2, 3, 5, 6, 9)),
    *("app", "mrpa", "diffma", "near", "qssd"),
]
FUZZ = runpy.run_path(str(ROOT / "core/fuzz/container.py"))


def in_node(paths: Iterable[Path]) -> list[str]:
    """Give what the page's reader makes of files: a digest of their values, or an error."""
    node = shutil.which("node")
    if node is None:
        reason = "no node (Debian: apt-get install nodejs); `make browser` installs it as root"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    names = "\n".join(map(str, paths))
    done = subprocess.run(
        [node, SCRIPT], input=names, capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def digest(path: Path) -> str:
    """Give the same by mocapress, ``error`` for any error."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mp.MotionWarning)
            opened = Opened(Source(path), [GOLDEN])
            if not opened.streams:
                return "error"
            streams = [opened.rows(index).values for index in range(len(opened.streams))]
    except mp.MocapressError:
        return "error"
    return hashlib.sha256(b"".join(values.tobytes() for values in streams)).hexdigest()


def alike(found: Sequence[str], expected: Sequence[str]) -> bool:
    return [line.partition(":")[0] for line in found] == list(expected)


def test_golden_files() -> None:
    files = sorted(GOLDEN.glob("*.mcz"))
    found = in_node([*files, *sorted(GOLDEN.glob("*.mcm"))])
    assert alike(found, [digest(path) for path in files])
    failed = {path.name for path, line in zip(files, found, strict=True) if "error" in line}
    assert failed == {"v1_bytes.bin.mcz", "v1_random.bin.mcz"}
    assert all("no motion" in line for line in found if "error" in line)


def compressed(sources: Sequence[Path], folder: Path) -> list[Path]:
    made = []
    for i, source in enumerate(sources):
        for codec in CODECS:
            made.append(folder / f"{i}_{codec.replace(':', '_')}.mcz")
            made[-1].write_bytes(mp.compress(source, codec))
    return made


def test_samples(samples: Path, tmp_path: Path) -> None:
    files = compressed(sorted(samples.glob("*.[ab][mv][ch]")), tmp_path)
    expected = [digest(path) for path in files]
    assert "error" not in expected
    assert in_node(files) == expected


@pytest.mark.corpus
@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
def test_clips_of_all_kinds(corpus_clips: list[Path], tmp_path: Path) -> None:
    files = compressed(corpus_clips[::24], tmp_path)
    expected = [digest(path) for path in files]
    assert len(files) - expected.count("error") > 50
    assert alike(in_node(files), expected)


DECODE = """async ([modules, files, files_of_page]) => {
    const urls = new Map();
    for (const [path, source] of modules) {
        const named = source.replace(/"module:([^"]+)"/g, (_, name) => `"${urls.get(name)}"`);
        urls.set(path, URL.createObjectURL(new Blob([named], {type: "text/javascript"})));
    }
    const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const {openMcz, decodeStream} = await import(urls.get("mcz/mcz.js"));
    const {Assets} = await import(urls.get("mcz/assets.js"));
    const assets = new Assets((path) => bytes(files_of_page[path]));
    const models = files.filter(([name]) => name.endsWith(".mcm")).map(([, text]) => bytes(text));
    const found = [];
    for (const [name, text] of files.filter(([name]) => name.endsWith(".mcz"))) {
        const values = [];
        try {
            const mcz = await openMcz(bytes(text), assets);
            for (let i = 0; i < mcz.streams.length; i++)
                for await (const chunk of decodeStream(mcz, i, models, assets))
                    values.push(chunk.values);
            const all = await new Blob(values).arrayBuffer();
            const sha = new Uint8Array(await crypto.subtle.digest("SHA-256", all));
            found.push(Array.from(sha, (b) => b.toString(16).padStart(2, "0")).join(""));
        } catch (error) {
            found.push(`${error.name === "MczError" ? "error" : error}: ${error.message}`);
        }
    }
    return found;
}"""


def test_the_browser_decodes_the_same(samples: Path, tmp_path: Path) -> None:
    files = [
        *sorted(GOLDEN.glob("*.mcz")),
        *compressed([samples / "cmu_01_01.amc", samples / "freebvh.bvh"], tmp_path),
    ]
    given = [
        [path.name, base64.b64encode(path.read_bytes()).decode()]
        for path in [*files, *sorted(GOLDEN.glob("*.mcm"))]
    ]
    modules = [[k, v] for k, v in page.modules().items() if k.startswith("mcz/")]
    empty = tmp_path / "empty.html"
    empty.write_text("<!doctype html>")
    with chromium() as browser:
        tab = browser.new_page()
        tab.goto(empty.as_uri())  # on about:blank there is no crypto.subtle
        carried = page.binary_files(page.asset_names()).items()
        own = {name: base64.b64encode(data).decode() for name, data in carried}
        found = tab.evaluate(DECODE, [modules, given, own])
    assert alike(found, [digest(path) for path in files])


def test_mutants_end_in_an_error_or_the_same_values(tmp_path: Path) -> None:
    """Half of them have right checksums, so that what lies behind these is reached."""
    chance = random.Random(20)
    seeds = [path.read_bytes() for path in sorted(GOLDEN.glob("*.mcz"))]
    files = []
    for run in range(600):
        data = FUZZ["mutated"](chance.choice(seeds), chance)
        files.append(tmp_path / f"{run}.mcz")
        files[-1].write_bytes(FUZZ["forged"](data) if run % 2 else data)
    found = in_node([*files, *sorted(GOLDEN.glob("*.mcm"))])
    played = 0
    for path, line in zip(files, found, strict=True):
        if not line.startswith("error: "):
            played += 1
            # What belongs to the original's text only, the page does not look at.
            assert line == digest(path) or digest(path) == "error", path
    assert played < len(files) / 2
