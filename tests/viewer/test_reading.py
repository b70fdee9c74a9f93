"""What the page reads in the browser is what mocapress reads, bit for bit; so are its errors."""

import base64
import hashlib
import json
import os
import re
import shutil
import subprocess
import warnings
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import chromium

import mocapress as mp
from mocapress.motion.columns import skeleton_columns
from mocapress.viewer import page

SCRIPT = Path(__file__).with_name("read_files.mjs")
SAMPLES = Path(__file__).parents[2] / "samples"
CASES = Path(__file__).parents[1] / "cases"


def in_node(drops: Sequence[Sequence[Path]]) -> list[Any]:
    """Give what the page makes of files that are dropped together, for each such drop."""
    node = shutil.which("node")
    if node is None:
        reason = "no node (Debian: apt-get install nodejs); `make browser` installs it as root"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    names = "\n".join("\t".join(map(str, drop)) for drop in drops)
    done = subprocess.run([node, SCRIPT], input=names, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def read_by_page(*paths: Path) -> Any:
    (made,) = in_node([paths])
    return made


def read_natively(path: Path) -> mp.Clip:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        return mp.read(path)


def dropped(path: Path) -> list[Path]:
    """Give a file, and its skeleton beside it."""
    beside = read_natively(path).metadata.get("skeleton")
    return [path, *([Path(beside)] if beside else [])]


def sha256(values: np.ndarray[Any, Any]) -> str:
    return hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()


def compare(path: Path, made: Any) -> None:
    clip = read_natively(path)
    assert made["names"] == [column.name for column in clip.columns], path
    assert made["frames"] == clip.frames, path
    assert made["frameTime"] == (float(clip.frame_time) if clip.frame_time else None), path
    assert made["values"] == sha256(clip.values.T), path
    if clip.skeleton is None:
        assert made["positions"] is None, path
        return
    try:
        expected, fault = sha256(mp.positions(clip, end_sites=True)), None
    except mp.UnsupportedError as error:
        expected, fault = None, error.what
    assert (made["positions"], made.get("error")) == (expected, fault), path


def check(path: Path) -> None:
    (made,) = read_by_page(*dropped(path))["clips"]
    compare(path, made)


def compare_all(paths: Sequence[Path], page_reads: Any) -> int:
    """Compare files; give how many of them are read."""
    drops: list[list[Path]] = []
    faults: dict[int, mp.MocapressError] = {}
    for i, path in enumerate(paths):
        try:
            drops.append(dropped(path))
        except mp.MocapressError as error:
            faults[i] = error
            beside = error.file if error.file and error.file.endswith(".asf") else None
            drops.append([path, *([Path(beside)] if beside else [])])
    for i, (path, made) in enumerate(zip(paths, page_reads(drops), strict=True)):
        if i in faults:
            assert not made["clips"], path
            assert faults[i].what in made["errors"][0], path
        else:
            assert made["errors"] == [], path
            compare(path, made["clips"][0])
    return len(paths) - len(faults)


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_samples(samples: Path, name: str) -> None:
    check(samples / name)


def motion_files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in (".amc", ".bvh"))


def test_cases() -> None:
    assert compare_all(motion_files(CASES), in_node) > 40


@pytest.mark.corpus
def test_clips_of_all_kinds(corpus_clips: list[Path]) -> None:
    compare_all([path for path in corpus_clips if path.suffix.lower() in (".amc", ".bvh")], in_node)


READ = """async ([modules, drops, files, script]) => {
    const urls = new Map();
    for (const [path, source] of modules) {
        const named = source.replace(/"module:([^"]+)"/g, (_, name) => `"${urls.get(name)}"`);
        urls.set(path, URL.createObjectURL(new Blob([named], {type: "text/javascript"})));
    }
    const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const {readFiles} = await import(urls.get("page/reading/files.js"));
    const {placesOf} = await import(urls.get("page/work/placing.js"));
    const {Assets} = await import(urls.get("mcz/assets.js"));
    const own = URL.createObjectURL(new Blob([script], {type: "text/javascript"}));
    const {digests} = await import(own);
    const assets = new Assets((path) => bytes(files[path]));
    const made = [];
    for (const drop of drops) {
        const given = drop.map(([name, text]) => ({name, bytes: bytes(text)}));
        made.push(await digests({readFiles, placesOf}, given, assets));
    }
    return made;
}"""


def test_the_browser_reads_the_same(samples: Path, tmp_path: Path) -> None:
    wanted = ("mcz/", "diffma/", "page/reading/", "page/work/")
    modules = [[name, text] for name, text in page.modules().items() if name.startswith(wanted)]
    script = SCRIPT.with_name("reading_digests.mjs").read_text()
    empty = tmp_path / "empty.html"
    empty.write_text("<!doctype html>")

    def in_chromium(drops: Sequence[Sequence[Path]]) -> Any:
        told = [
            [[path.name, base64.b64encode(path.read_bytes()).decode()] for path in drop]
            for drop in drops
        ]
        with chromium() as browser:
            tab = browser.new_page()
            tab.goto(empty.as_uri())  # on about:blank there is no crypto.subtle
            carried = page.binary_files(page.asset_names()).items()
            files = {name: base64.b64encode(data).decode() for name, data in carried}
            return tab.evaluate(READ, [modules, told, files, script])

    assert compare_all([*motion_files(samples), *motion_files(CASES)], in_chromium) > 40


BVH = (SAMPLES / "mocapbank.bvh").read_bytes()
BROKEN = {
    "no_motion.bvh": BVH[: BVH.index(b"MOTION")],
    "number.bvh": BVH[:-40] + b" x" + BVH[-38:],
    "short_row.bvh": BVH.rstrip()[:-30],
    "brace.bvh": BVH.replace(b"}", b"", 1),
    "channels.bvh": BVH.replace(b"CHANNELS 3", b"CHANNELS 4", 1),
    "offset.bvh": BVH.replace(b"OFFSET ", b"OFFSET x", 1),
    "frames.bvh": re.sub(rb"Frames:\s+455", b"Frames: 45500", BVH),
    "a_row_missing.bvh": re.sub(rb"Frames:\s+455", b"Frames: 456", BVH),
    "frame_time.bvh": BVH.replace(b"Frame Time:", b"Frame Tim:"),
    "empty.bvh": b"",
    "empty.amc": b"",
    "bone.amc": b"1\nroot 1 2 3 4 5 6\nhip 1\n2\nroot 1 2 3 4 5 6\nhip 1\nhip 1\n",
    "few.amc": b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5\n",
    "infinite.amc": b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5 1e999\n",
}


@pytest.mark.parametrize("name", BROKEN)
def test_errors_name_the_same_place(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(BROKEN[name])
    with pytest.raises(mp.MocapressError) as error:
        mp.read(file)
    made = read_by_page(file)
    assert made["clips"] == []
    (message,) = made["errors"]
    place = f"{name}, line {error.value.line}: " if error.value.line else f"{name}: "
    assert message.startswith(f"{place}{error.value.what}"), (message, str(error.value))


@pytest.mark.parametrize("stated", ["60", "30.0", "0", "x"])
def test_an_amc_that_states_its_rate(tmp_path: Path, stated: str) -> None:
    file = tmp_path / "a.amc"
    file.write_text(
        f":DEGREES\n:SAMPLES-PER-SECOND {stated}\n-1\nroot 1 2 3 4 5 6\n0\nroot 1 2 3 4 5 6\n"
    )
    check(file)


def test_a_bone_first_seen_later(tmp_path: Path) -> None:
    file = tmp_path / "a.amc"
    file.write_text(
        "1\nroot 1 2 3 4 5 6\nhip 7\n2\nroot 1 2 3 4 5 6\nneck 8 9\nhip 7\n3\nneck 1 2\n"
    )
    check(file)


@pytest.mark.parametrize("kind", ["bvh", "amc"])
def test_odd_names(tmp_path: Path, kind: str) -> None:
    called = ["Hips", "a b", "Hüfteà", "Å", "End", "begin", "root", "#{}", "", "%41", "a b", "\xa0"]
    joints = tuple(
        mp.Joint(name, i - 1, channels=("rz", "ry", "rx"), ends=((0.0, 1.0, 0.0),) * (i == 11))
        for i, name in enumerate(called)
    )
    skeleton = mp.Skeleton(joints)
    columns = skeleton_columns(skeleton)
    clip = mp.Clip.of(np.ones((2, len(columns))), columns, Fraction(1, 30), skeleton)
    mp.write(clip, tmp_path / f"a.{kind}")
    check(tmp_path / f"a.{kind}")


ODD = {
    "more_rows.bvh": re.sub(rb"Frames:\s+455", b"Frames: 4", BVH),
    "undeclared.bvh": re.sub(rb"Frames:\s+455", b"Frames: 0", BVH),
    "nul.bvh": BVH + b"\0\0",
    "ctrl_z.bvh": BVH + b"\r\n\x1a",
    "text.bvh": BVH + b"end\n",
    "half_a_row.bvh": BVH + b"1 2 3",
    "nul.amc": b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5 6\n\0\0",
    "ctrl_z.amc": b"-1\nroot 1 2 3 4 5 6\n\x1a\r\n",
}


@pytest.mark.parametrize("name", ODD)
def test_what_loses_nothing_is_played_and_said(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(ODD[name])
    with pytest.warns(mp.MotionWarning) as caught:
        clip = mp.read(file)
    (made,) = read_by_page(file)["clips"]
    assert made["frames"] == clip.frames
    notes = [note for note in made["notes"] if "no skeleton" not in note]
    for note, warning in zip(notes, caught, strict=True):
        assert isinstance(warning.message, mp.MotionWarning)
        fact = warning.message.fact
        assert note.startswith(f"line {fact.line}: {fact.what}; expected ")
