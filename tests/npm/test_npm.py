"""The package for npm (`make npm`), installed, and tried by Node, TypeScript and three.js."""

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mocapress as mp
from mocapress.motion.kinematics import local_rotations, positions, rotations, translations

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
PACKAGE = ROOT / "build/npm"
PACKAGES = ROOT / "build/node/node_modules"


def _need(found: bool, what: str) -> None:
    if not found and os.environ.get("CI"):
        pytest.fail(what)
    if not found:
        pytest.skip(what)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a project that has the package installed, and three.js and TypeScript."""
    _need(PACKAGE.is_dir() and bool(shutil.which("npm")), "make npm")
    _need((PACKAGES / "typescript").is_dir(), "make node")
    folder = tmp_path_factory.mktemp("project")
    # What would be published: `npm pack` leaves out what package.json does.
    done = subprocess.run(
        ["npm", "pack", "--silent", "--pack-destination", folder],
        cwd=PACKAGE,
        check=True,
        capture_output=True,
        text=True,
    )
    modules = folder / "node_modules"
    modules.mkdir()
    shutil.unpack_archive(folder / done.stdout.strip(), folder / "unpacked")
    shutil.move(folder / "unpacked/package", modules / "mocapress")
    for name in ("three", "@types", "typescript"):
        (modules / name).symlink_to(PACKAGES / name)
    for name in ("poses.mjs", "use.ts", "tsconfig.json"):
        shutil.copy(HERE / name, folder)
    (folder / "package.json").write_text('{"type": "module"}')
    return folder


@pytest.fixture(scope="module")
def walk(project: Path) -> Path:
    path = project / "walk.mcz"
    clip = mp.read(ROOT / "samples/cmu_01_01.amc")[:200]
    path.write_bytes(mp.compress(clip, "near:max=0.1cm,chunk=64"))
    return path


def told(project: Path, file: Path, rate: float, *times: float) -> dict[str, Any]:
    command = ["node", "poses.mjs", file, rate, *times]
    done = subprocess.run(
        [str(part) for part in command], cwd=project, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("codec", ["exact:chunk=64", "exact:level=1", "near:max=0.1cm,chunk=64"])
@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh"])
def test_poses_are_those_of_python(codec: str, name: str, project: Path) -> None:
    source = mp.read(ROOT / "samples" / name)[:100]
    file = project / "clip.mcz"
    file.write_bytes(mp.compress(mp.retime(source, 50), codec))
    clip: Any = mp.load(file)
    frames = [0, 1, 63, 64, len(clip) - 1] if len(clip) > 64 else [0, 1, len(clip) - 1]
    found = told(project, file, 0, *(frame / 50 for frame in frames))
    assert found["frames"] == len(clip)
    assert found["frameTime"] == pytest.approx(0.02)
    assert [joint["name"] for joint in found["joints"]] == list(clip.skeleton.names)
    assert found["values"] == clip.values[[0, -1]].tolist()
    for frame, (world, local) in zip(frames, found["poses"], strict=True):
        assert world[0] == pytest.approx(positions(clip, end_sites=True)[frame].ravel(), abs=1e-8)
        assert _same_turns(world[1], rotations(clip)[frame])
        ours = translations(clip)[frame].ravel()
        assert local[0][: len(ours)] == pytest.approx(ours, abs=1e-8)
        assert _same_turns(local[1], local_rotations(clip)[frame])


def _same_turns(found: list[float], ours: np.ndarray) -> bool:
    cosines = np.abs((np.array(found).reshape(-1, 4) * ours).sum(axis=1))
    return bool(np.all(cosines > 1 - 1e-12))


def test_between_frames_and_outside(project: Path, walk: Path) -> None:
    from scipy.spatial.transform import Rotation, Slerp

    clip = mp.load(walk)
    turns = local_rotations(clip)
    before, part = 63, 0.25  # in two chunks
    found = told(project, walk, 120, (before + part) / 120, -1, 1e9)
    (_, (_, middle)), (first, _), (last, _) = found["poses"]
    for joint, turn in enumerate(np.array(middle).reshape(-1, 4)):
        pair = Rotation.from_quat(np.roll(turns[before : before + 2, joint], -1, axis=1))
        apart = Rotation.from_quat(np.roll(turn, -1)) * Slerp([0, 1], pair)(part).inv()
        assert apart.magnitude() < 2e-7
    places = positions(clip, end_sites=True)
    assert first[0] == pytest.approx(places[0].ravel(), abs=1e-8)
    assert last[0] == pytest.approx(places[-1].ravel(), abs=1e-8)


def test_what_cannot_be_played_is_said(project: Path, walk: Path) -> None:
    data = walk.read_bytes()
    file = project / "broken.mcz"
    for content, fault in (
        (data[: len(data) // 2], "cut off"),
        (b"", "not a .mcz file"),
        (data[:500] + bytes([data[500] ^ 1]) + data[501:], "checksum"),
        (mp.compress(b"no motion"), "holds a file that is no motion"),
    ):
        file.write_bytes(content)
        error = told(project, file, 120, 0)["error"]
        assert error.startswith("MczError: ")
        assert fault in error
    assert "RangeError: the file does not state its rate" in told(project, walk, 0, 0)["error"]
    file.write_bytes(mp.compress(mp.from_array(np.zeros((3, 1)), ["a"], 10)))
    assert "without a skeleton" in told(project, file, 0, 0)["error"]


def test_the_example_of_the_readme_runs(project: Path, walk: Path) -> None:
    readme = (ROOT / "npm/README.md").read_text()
    (project / "readme.mjs").write_text(re.findall(r"```js\n(.*?)```", readme, re.DOTALL)[0])
    command = ["node", "readme.mjs"]
    done = subprocess.run(command, cwd=project, capture_output=True, text=True, check=True)
    name, *numbers = re.findall(r"[a-z]+|-?\d+\.\d+", done.stdout.replace("Float64Array(3)", ""))
    assert name == "root"
    assert [float(n) for n in numbers] == pytest.approx(positions(mp.load(walk))[150, 0], abs=1e-8)


def test_types_are_right(project: Path) -> None:
    command = ["node", "node_modules/typescript/bin/tsc", "-p", "tsconfig.json"]
    done = subprocess.run(command, cwd=project, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.fixture
def visited(project: Path, walk: Path) -> Iterator[Any]:
    """Give the example's page, open in Chromium."""
    import sys

    sys.path.append(str(ROOT / "tests/viewer"))
    from browsing import chromium

    kinds = {".js": "text/javascript", ".html": "text/html"}

    def serve(route: Any) -> None:
        path = project / route.request.url.removeprefix("http://test/").partition("?")[0]
        kind = kinds.get(path.suffix, "application/octet-stream")
        route.fulfill(path=path, content_type=kind)

    with chromium() as browser:
        page = browser.new_page(viewport={"width": 640, "height": 480})
        page.route("http://test/**", serve)
        page.goto("http://test/node_modules/mocapress/example/index.html?clip=/walk.mcz")
        page.wait_for_function("window.show !== undefined")
        yield page


def test_the_example_moves_bones_in_three(visited: Any, walk: Path) -> None:
    clip = mp.load(walk)
    # The animation of the page runs on; a pose is shown and read in one go.
    read = """(seconds) => {
        show(seconds);
        group.updateMatrixWorld(true);
        return bones.map((bone) => bone.getWorldPosition(bone.position.clone()).toArray());
    }"""
    for frame in (0, 77, 150):
        found = np.array(visited.evaluate(read, frame / 120))
        ours = positions(clip, end_sites=True)[frame] * 2.54 / 0.45 / 100
        assert found == pytest.approx(ours, abs=1e-6)
