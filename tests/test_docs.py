"""What the README shows works as shown."""

import doctest
import re
import shlex
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from mocapress import codecs
from mocapress.cli.app import app

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def test_the_python_example_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(code, {})
    promised = re.findall(r"print\(.*?\)  # (\(.*?\))", code)
    assert capsys.readouterr().out.split("\n")[:-1] == promised


def test_the_guide_to_compressed_clips_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(ROOT / "samples/freebvh.bvh", tmp_path)
    monkeypatch.chdir(tmp_path)
    guide = (ROOT / "docs/guide/mcz.md").read_text()
    exec("\n".join(re.findall(r"```python\n(.*?)```", guide, re.DOTALL)), {})


def test_the_guide_to_models_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "library").mkdir()
    for name in ("library/walk.amc", "take1.amc"):
        shutil.copy(ROOT / "tests/golden/v1_trained_laws.amc", tmp_path / name)
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs/guide/models.md").read_text(), re.DOTALL
    )
    exec(code, {})


def test_the_guide_to_libraries_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("freebvh", "mocapbank"):
        shutil.copy(ROOT / f"samples/{name}.bvh", tmp_path)
    monkeypatch.chdir(tmp_path)
    guide = (ROOT / "docs/guide/library.md").read_text()
    exec("\n".join(re.findall(r"```python\n(.*?)```", guide, re.DOTALL)), {})


def test_the_guide_to_markers_says_what_comes_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    found = doctest.testfile(str(ROOT / "docs/guide/markers.md"), module_relative=False)
    assert found.attempted > 2
    assert not found.failed


def test_the_commands_for_markers_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "samples").mkdir()
    for kind in ("c3d", "trc"):
        shutil.copy(ROOT / f"samples/markers.{kind}", tmp_path / "samples")
    monkeypatch.chdir(tmp_path)
    guide = (ROOT / "docs/guide/markers.md").read_text()
    commands = re.findall(r"^\$ mocapress (.+)$", guide, re.MULTILINE)
    assert len(commands) > 5
    for command in commands:
        result = CliRunner().invoke(app, command.split())
        assert result.exit_code == 0, (command, result.output)
    for kind in ("c3d", "trc"):
        restored = (tmp_path / f"restored/markers.{kind}").read_bytes()
        assert restored == (ROOT / f"samples/markers.{kind}").read_bytes()


def test_the_guide_to_gltf_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(ROOT / "samples/freebvh.bvh", tmp_path / "walk.bvh")
    monkeypatch.chdir(tmp_path)
    guide = ROOT / "docs/guide/gltf.md"
    commands = re.findall(r"^\$ mocapress (.+)$", guide.read_text(), re.MULTILINE)
    assert len(commands) > 4
    for command in commands:
        result = CliRunner().invoke(app, command.split())
        assert result.exit_code == 0, (command, result.output)
    found = doctest.testfile(str(guide), module_relative=False)
    assert found.attempted > 3
    assert not found.failed


def test_the_commands_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for suffix in ("amc", "asf"):
        shutil.copy(ROOT / f"samples/cmu_01_01.{suffix}", tmp_path / f"walk.{suffix}")
    (tmp_path / "clips").mkdir()
    shutil.copy(ROOT / "samples/freebvh.bvh", tmp_path / "clips")
    monkeypatch.chdir(tmp_path)
    commands = re.findall(r"^\$ mocapress (.*?)(?:  #.*)?$", README, re.MULTILINE)
    assert len(commands) == 16
    for command in commands:
        if command.startswith("decompress"):
            Path("walk.amc").rename("original.amc")
        words = command.split()
        if words[0] == "bench":  # the whole benchmark is too long for a test
            words = [*words[: words.index("--plots")], "--only", "app,gzip -9"]
        if words[0] == "view" and "--export" not in words:  # it would serve until it is told to end
            words += ["--export", "served.html"]
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, (command, result.output)
    assert Path("walk.amc").read_bytes() == Path("original.amc").read_bytes()


TASKS = (
    "ci",
    "commands",
    "convert",
    "diffma_json",
    "files",
    "measure",
    "near",
    "notebook",
    "python",
)
"""Pages whose examples run in a folder of clips: commands one after the other, then Python."""


@pytest.fixture
def clips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "clips").mkdir()
    shutil.copy(ROOT / "samples/freebvh.bvh", tmp_path / "clips/run.bvh")
    shutil.copy(ROOT / "samples/mocapbank.bvh", tmp_path / "walk.bvh")
    shutil.copy(ROOT / "samples/markers.c3d", tmp_path / "walk.c3d")
    shutil.copy(ROOT / "samples/cmu_01_01.asf", tmp_path / "walk.asf")
    lines = (ROOT / "samples/cmu_01_01.amc").read_text().splitlines(keepends=True)
    (tmp_path / "walk.amc").write_text("".join(lines[: lines.index("701\n")]))  # for speed
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
@pytest.mark.parametrize("page", TASKS)
def test_the_task_runs(page: str, clips: Path) -> None:
    guide = (ROOT / f"docs/guide/{page}.md").read_text()
    CliRunner().invoke(app, ["-1", "walk.amc", "walk.bvh"])
    commands = re.findall(r"^\$ mocapress (.*?)(?:  +[#>].*)?$", guide, re.MULTILINE)
    examples = "\n".join(re.findall(r"```python\n(.*?)```", guide, re.DOTALL))
    assert commands or examples
    for command in commands:
        words = shlex.split(command.partition(" > ")[0])
        result = CliRunner().invoke(app, [*words, "-f"] if writes_again(words) else words)
        assert result.exit_code == 0, (command, result.output)
    exec(examples, {"__name__": "guide"})
    for made in clips.glob("back/*.bvh"):
        assert made.read_bytes() == (clips / "clips" / made.name).read_bytes()


def writes_again(words: list[str]) -> bool:
    """Tell whether a page shows another way to what an example before it has written."""
    return words[0] in ("compress", "convert", "decompress") and "--skip-existing" not in words


def test_the_guide_to_search_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder, name in (("clips", "mocapbank"), ("more", "freebvh")):
        (tmp_path / folder).mkdir()
        shutil.copy(ROOT / f"samples/{name}.bvh", tmp_path / folder)
    for suffix in ("amc", "asf"):
        shutil.copy(ROOT / f"samples/cmu_01_01.{suffix}", tmp_path / f"walk.{suffix}")
    monkeypatch.chdir(tmp_path)
    guide = (ROOT / "docs/guide/search.md").read_text()
    commands = re.findall(r"^\$ mocapress (.*?)(?:  +#.*)?$", guide, re.MULTILINE)
    assert len(commands) > 7
    for command in commands:
        result = CliRunner().invoke(app, command.split())
        assert result.exit_code == 0, (command, result.output)
    assert Path("hits.png").stat().st_size > 1000
    exec("\n".join(re.findall(r"```python\n(.*?)```", guide, re.DOTALL)), {})


def test_every_codec_is_in_the_readme_and_the_format() -> None:
    described = (ROOT / "docs/format.md").read_text()
    for name in codecs.codec_ids():
        assert f"| `{name}` |" in README
        assert f"### `{name}`" in described


def test_links_lead_somewhere() -> None:
    for page in [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]:
        for link in re.findall(r"\]\((?!http)([^)#]+)\)", page.read_text()):
            assert (page.parent / link).exists(), f"{page}: {link}"
