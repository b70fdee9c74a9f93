"""What others make of our GLB: the Khronos validator finds no fault, three.js moves it alike."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, Route
from test_gltf import arm, foreign, written

import mocapress as mp
from mocapress.motion.kinematics import positions

ROOT = Path(__file__).parents[2]
PACKAGES = ROOT / "build/node/node_modules"
sys.path.append(str(ROOT / "tests/viewer"))

VALIDATE = """
const {validateBytes} = require("gltf-validator");
const {readFileSync} = require("fs");
Promise.all(process.argv.slice(1).map((file) => validateBytes(new Uint8Array(readFileSync(file)))))
    .then((reports) => console.log(JSON.stringify(reports.map((report) => report.issues))));
"""

PAGE = """<!doctype html><script type="importmap">
{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}
</script><script type="module">
import * as THREE from "three";
import {GLTFLoader} from "three/addons/loaders/GLTFLoader.js";
const gltf = await new GLTFLoader().loadAsync("/clip.glb");
const nodes = [];
gltf.scene.traverse((node) => nodes.push(node));
const mixer = new THREE.AnimationMixer(gltf.scene);
mixer.clipAction(gltf.animations[0]).setLoop(THREE.LoopOnce).play().clampWhenFinished = true;
const place = new THREE.Vector3();
window.stand = (time) => {
    mixer.setTime(time);
    gltf.scene.updateMatrixWorld(true);
    return nodes.map((node) => [node.userData.name ?? node.name,
        place.setFromMatrixPosition(node.matrixWorld).toArray()]);
};
window.figure = () => {
    const mesh = nodes.find((node) => node.isSkinnedMesh);
    const count = mesh.geometry.attributes.position.count;
    return Array.from({length: count}, (_, i) => mesh.localToWorld(
        mesh.getVertexPosition(i, new THREE.Vector3())).toArray());
};
document.title = "loaded";
</script>"""


def _need(found: bool, what: str) -> None:
    if not found and os.environ.get("CI"):
        pytest.fail(what)
    if not found:
        pytest.skip(what)


def test_the_validator_finds_nothing(tmp_path: Path) -> None:
    _need((PACKAGES / "gltf-validator").is_dir() and bool(shutil.which("node")), "make node")
    files = []
    for name, to in (("arm", "glb"), ("reduced", "glb:max=0.5cm")):
        (tmp_path / name).mkdir()
        files.append(written(arm(100), tmp_path / name, to))
    for sample in ("freebvh.bvh", "cmu_01_01.amc"):
        (tmp_path / sample).mkdir()
        clip = mp.retime(mp.read(ROOT / "samples" / sample)[:30], 120)
        files.append(written(clip, tmp_path / sample, "glb:max=0.1cm"))
    one, two = tmp_path / "one", tmp_path / "two"
    one.mkdir()
    files.append(written(arm(1), one))
    two.mkdir()
    cases = ROOT / "tests/cases/15-two-roots"
    files.append(written(mp.read(next(cases.glob("*.bvh"))), two, "glb:unit=cm"))
    command = ["node", "-e", VALIDATE, *map(str, files)]
    done = subprocess.run(command, cwd=PACKAGES.parent, capture_output=True, text=True, check=True)
    assert len(json.loads(done.stdout)) == len(files)
    for file, report in zip(files, json.loads(done.stdout), strict=True):
        assert report["messages"] == [], file


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    _need((PACKAGES / "three").is_dir(), "make node")
    from browsing import chromium

    with chromium() as browser:
        yield browser.new_page()


def _open(page: Page, glb: bytes) -> None:
    def serve(route: Route) -> None:
        path = route.request.url.removeprefix("http://test/")
        if path == "clip.glb":
            route.fulfill(body=glb, content_type="model/gltf-binary")
        elif path:
            route.fulfill(path=PACKAGES / path, content_type="text/javascript")
        else:
            route.fulfill(body=PAGE, content_type="text/html")

    page.unroute_all()
    page.route("http://test/**", serve)
    page.goto("http://test/")
    page.wait_for_function("document.title == 'loaded'")


def _stand(page: Page, time: float) -> dict[str, list[float]]:
    return dict(page.evaluate(f"stand({time})"))


@pytest.mark.parametrize("to", ["glb", "glb:max=0.5cm"])
def test_three_moves_joints_as_we_do(page: Page, to: str, tmp_path: Path) -> None:
    clip: Any = arm(100)
    file = written(clip, tmp_path, to)
    _open(page, file.read_bytes())
    ours, again = positions(clip) / 100, positions(mp.read(file))
    for frame in (0, 1, 17, 50, 98):
        theirs = _stand(page, frame / 50)
        found = np.array([theirs[name] for name in clip.skeleton.names])
        assert found == pytest.approx(again[frame], abs=1e-5)
        assert np.abs(found - ours[frame]).max() < (1e-5 if to == "glb" else 0.005)


def test_three_draws_bones_from_joint_to_joint(page: Page, tmp_path: Path) -> None:
    clip: Any = arm(100)
    _open(page, written(clip, tmp_path).read_bytes())
    _stand(page, 17 / 50)
    corners = np.array(page.evaluate("figure()"))
    for point in positions(clip, end_sites=True)[17] / 100:
        assert np.linalg.norm(corners - point, axis=1).min() < 1e-5


def test_three_reads_files_of_others_as_we_do(page: Page) -> None:
    data = foreign()
    _open(page, data)
    clip: Any = mp.read(data)
    for frame in (0, 5, 12, 23):
        theirs = _stand(page, frame / 24)
        found = np.array([theirs[name] for name in clip.skeleton.names])
        assert found == pytest.approx(positions(clip)[frame], abs=1e-6)
