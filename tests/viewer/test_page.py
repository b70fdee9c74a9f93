"""The document: whole, closed to the world, and safe against what is in the motion."""

import base64
import gzip
import hashlib
import json
import re
from importlib.metadata import distribution, files
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.container import diffma_json
from mocapress.motion.figure import centimetres
from mocapress.motion.kinematics import positions
from mocapress.source import Source
from mocapress.viewer import embed, page

ROOT = Path(__file__).parents[2]


def embedded(document: str) -> list[dict[str, object]]:
    (text,) = re.findall(r'id="clips">(.*?)</script>', document, re.DOTALL)
    clips: list[dict[str, object]] = json.loads(text)["clips"]
    return clips


def test_exact_values_are_exact(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")
    (made,) = embedded(page.document([embed.exact(clip, "walk.amc")]))
    decoded = mp.load(base64.b64decode(str(made["mcz"])))
    assert decoded.values.tobytes() == clip.values.tobytes()
    assert decoded.columns == clip.columns
    assert decoded.frame_time == clip.frame_time
    assert mp.positions(decoded).tobytes() == mp.positions(clip).tobytes()


def test_an_exported_page_may_hold_motion_within_a_largest_error(
    samples: Path, tmp_path: Path
) -> None:
    target = tmp_path / "page.html"
    words = ["view", str(samples / "freebvh.bvh"), "--export", str(target), "--near", "max=0.2cm"]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    (made,) = embedded(target.read_text())
    blob = base64.b64decode(str(made["mcz"]))
    assert f"{len(blob)} of them motion, near:max=0.2cm" in result.stdout
    clip, shown = mp.read(samples / "freebvh.bvh"), mp.load(blob)
    apart = np.linalg.norm(positions(clip) - positions(shown), axis=2)
    unit = centimetres(clip)
    assert unit
    assert 0 < apart.max() * unit <= 0.2
    assert len(blob) < len(mp.compress(clip))


@pytest.mark.parametrize(
    ("option", "fault"),
    [
        (["--near", "max=far"], "an amount above 0"),
        (["--near", "max=1cm", "--max-error", "1"], "instead of --max-error"),
        (["--near", "wide=1"], "no such parameter, part or joint"),
    ],
)
def test_near_that_cannot_be_is_refused(
    samples: Path, tmp_path: Path, option: list[str], fault: str
) -> None:
    target = tmp_path / "page.html"
    words = ["view", str(samples / "freebvh.bvh"), "--export", str(target), *option]
    result = CliRunner().invoke(app, words)
    assert result.exit_code in (1, 2)
    assert fault in result.output
    assert not target.exists()


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh"])
@pytest.mark.parametrize("max_error", [0.5, 0.01])
def test_an_exported_page_keeps_its_stated_error(
    samples: Path, tmp_path: Path, name: str, max_error: float
) -> None:
    target = tmp_path / "page.html"
    words = ["view", str(samples / name), "--export", str(target), "--max-error", str(max_error)]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0
    assert f"{max_error:g}" in result.stdout
    (made,) = embedded(target.read_text())
    decoded = diffma_json.json_to_clip(Source(json.dumps(made["diffma"]).encode()))
    clip = mp.read(samples / name)
    assert 0 < np.abs(decoded.values - clip.values).max() <= max_error
    assert made["maxError"] == max_error
    assert decoded.skeleton is not None
    assert clip.skeleton is not None
    np.testing.assert_array_equal(
        mp.positions(clip.with_values(decoded.values)), mp.positions(decoded)
    )


def test_an_exported_page_is_exact_and_small(samples: Path, tmp_path: Path) -> None:
    target, source = tmp_path / "page.html", samples / "cmu_01_01.amc"
    result = CliRunner().invoke(app, ["view", str(source), "--export", str(target)])
    assert result.exit_code == 0
    assert "exact values" in result.stdout
    (made,) = embedded(target.read_text())
    decoded = mp.load(base64.b64decode(str(made["mcz"])))
    assert decoded.values.tobytes() == mp.read(source).values.tobytes()
    assert target.stat().st_size <= 850_000


def test_a_page_says_nothing_of_where_its_clips_lay(samples: Path, tmp_path: Path) -> None:
    made = embed.file(samples / "cmu_01_01.amc")
    blob = base64.b64decode(made["mcz"])
    assert str(samples).encode() not in blob
    assert not mp.load(blob).metadata


@pytest.mark.parametrize("ending", [".diffma.json", ".diffma.json.xz"])
def test_a_document_is_embedded_as_it_is(samples: Path, tmp_path: Path, ending: str) -> None:
    file = tmp_path / f"clip{ending}"
    text = mp.to_json(samples / "freebvh.bvh", "diffma:bound=16")
    file.write_bytes(diffma_json.named(file.name, text))
    content = json.loads(text)
    del content["layout"]
    assert embed.file(file) == {"name": file.name, "diffma": content}
    file.write_bytes(b"{}")
    with pytest.raises(mp.FormatError, match=r"\$\.channels"):
        embed.file(file)


def test_the_policy_names_every_script_and_style_of_the_page() -> None:
    document = page.document([])
    inline = re.findall(
        r'<(?:script type="module"|style)>(.*?)</(?:script|style)>',
        document,
        re.DOTALL,
    )
    assert len(inline) == 2
    for text in inline:
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in page.policy()
    assert re.findall(r"[\w-]*unsafe[\w-]*", page.policy()) == ["wasm-unsafe-eval"]
    assert "http" not in page.policy()
    assert page.policy() in document


def test_every_module_is_in_the_page_after_those_that_it_imports() -> None:
    (packed,) = re.findall(r'id="modules">(.*?)</script>', page.document([]))
    modules = json.loads(gzip.decompress(base64.b64decode(packed)))
    sources = {
        path.relative_to(page.SOURCES).as_posix() for path in (page.SOURCES / "page").rglob("*.js")
    }
    assert sources - {"page/start.js"} <= {path for path, _ in modules}
    before: set[str] = set()
    for path, text in modules:
        assert set(re.findall(r'"module:([^"]+)"', text)) <= before, path
        statements = r'^(?:import|export)\b[^;]*?from\s*["\']([^"\']+)["\'];'
        for name in re.findall(statements, text, re.MULTILINE):
            assert name.startswith("module:"), path
        before.add(path)


ROOMS = {
    "reading": set(),
    "state": {"reading"},
    "panels": {"state"},
    "scene": {"state"},
    "work": {"reading"},
}


def test_the_rooms_of_the_page_import_only_from_below() -> None:
    for room, below in ROOMS.items():
        for path in (page.SOURCES / "page" / room).glob("*.js"):
            code = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
            named = set(re.findall(r'from "\.\./(\w+)/', code))
            assert named <= below, path
            assert room == "scene" or 'from "three' not in code, path


def test_motion_cannot_leave_its_element() -> None:
    text = "</script><script>alert(1)</script><!--"
    document = page.document([{"name": text}], title=text)
    assert document.count("<script") == 4
    assert embedded(document) == [{"name": text}]
    assert "<title></script>" not in document


def test_exporting_never_overwrites_unasked(samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    words = ["view", str(samples / "freebvh.bvh"), "--export", str(target)]
    assert CliRunner().invoke(app, words).exit_code == 0
    written = target.read_bytes()
    assert b"freebvh.bvh" in written
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 1
    assert "--force" in result.stderr
    assert target.read_bytes() == written


@pytest.mark.parametrize("content", [b"", b"HIERARCHY\nROOT", b"\x00" * 1000])
def test_broken_files_are_told_of_before_anything_is_served(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "broken.bvh"
    file.write_bytes(content)
    result = CliRunner().invoke(app, ["view", str(file)])
    assert result.exit_code == 1
    assert str(file) in result.stderr
    assert "Traceback" not in result.output


def test_a_skeleton_alone_is_not_played(samples: Path) -> None:
    with pytest.raises(mp.UnsupportedError, match=r"cmu_01_01\.asf: no frames"):
        embed.file(samples / "cmu_01_01.asf")


@pytest.mark.parametrize("codec", ["exact:level=9", "app", "diffma:bound=16", "near"])
def test_a_compressed_clip_is_embedded_as_it_is_coded(
    samples: Path, tmp_path: Path, codec: str
) -> None:
    file = tmp_path / "clip.bvh.mcz"
    file.write_bytes(mp.compress(samples / "freebvh.bvh", codec))
    made = embed.file(file)
    blob = base64.b64decode(made["mcz"])
    assert mp.load(blob).values.tobytes() == mp.load(file).values.tobytes()
    assert len(blob) < file.stat().st_size
    name = codec.partition(":")[0]
    modules = {asset for asset in embed.assets([made]) if asset.startswith("wasm/")}
    assert modules == {f"wasm/{name}.wasm", "wasm/kinematics.wasm"}


def test_a_clip_that_needs_a_model_is_coded_anew(samples: Path, tmp_path: Path) -> None:
    file, model = tmp_path / "clip.bvh.mcz", mp.train([samples / "freebvh.bvh"])
    mp.save_model(model, tmp_path / "a.mcm")
    file.write_bytes(mp.compress(samples / "freebvh.bvh", model=model))
    blob = base64.b64decode(embed.file(file)["mcz"])
    assert mp.load(blob).values.tobytes() == mp.read(samples / "freebvh.bvh").values.tobytes()


def test_the_package_carries_the_page() -> None:
    names = {str(name) for name in files("mocapress") or []}
    for path in ("page/main.js", "page/index.html", "vendor/three/LICENSE", "wasm/exact.wasm"):
        assert f"mocapress/viewer/web/{path}" in names
    assert not any("/test" in name for name in names)


def test_what_others_wrote_comes_with_its_licence() -> None:
    """Beside the files themselves, and where installers and auditors look for it."""
    folders = [path for path in (ROOT / "viewer/vendor").iterdir() if path.is_dir()]
    carried = {str(name) for name in files("mocapress") or []}
    for folder in folders:
        licence = (folder / "LICENSE").read_text()
        assert len(licence) > 500
        assert f"mocapress/viewer/web/vendor/{folder.name}/LICENSE" in carried
    metadata = distribution("mocapress").metadata
    named = set(metadata.get_all("License-File") or [])
    assert named == {"LICENSE", *(f"viewer/vendor/{folder.name}/LICENSE" for folder in folders)}
