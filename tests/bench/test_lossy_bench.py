"""Bytes and errors of lossy contenders are what they say."""

import os
import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.motion.kinematics import positions, rotations
from mocapress_bench import lossy
from mocapress_bench.lossy_report import draw

ROOT = Path(__file__).parents[2]
GLTFPACK = ROOT / "build/node/node_modules/gltfpack/cli.js"


@pytest.fixture
def walk(samples: Path) -> mp.Clip:
    return mp.retime(mp.read(samples / "cmu_01_01.amc")[:130], 120)


def test_errors_are_those_of_each_joint_and_three_points_around_it(walk: mp.Clip) -> None:
    task = lossy.task_of(walk)
    changed = walk.values + 0.5 * np.sin(np.arange(walk.values.size)).reshape(walk.values.shape)
    other = walk.with_values(changed)
    offsets = np.hstack([np.zeros((3, 1)), 3 * np.eye(3)])
    ours, theirs = (
        positions(clip)[..., None] * task.unit + rotations(clip, form="matrix") @ offsets
        for clip in (walk, other)
    )
    expected = np.linalg.norm(ours - theirs, axis=2).max(axis=2)
    assert task.errors(changed) == pytest.approx(expected, rel=1e-6)
    # What is played by others is measured alike.
    places = positions(other) * task.unit / 100
    turns = np.roll(rotations(other), -1, axis=2)
    assert lossy._apart(places, turns, task) == pytest.approx(expected, rel=1e-6)


def test_contenders_are_measured_on_what_they_decode(walk: mp.Clip) -> None:
    pytest.importorskip("zfpy")
    chosen = {
        "near": lossy.of_codec("near:max=0.5cm"),
        "diffma": lossy.of_codec("diffma:max_error=1.0"),
        "zfp": lossy.zfp,
        "DCT": lossy.dct,
    }
    points = list(lossy.measured(walk, "walk", chosen))
    (near,) = [point for point in points if point.contender == "near"]
    assert near.mean < near.most <= 0.5
    assert near.bits == 8 * near.size / (130 * 31)
    for contender in ("zfp", "DCT"):
        own = [point for point in points if point.contender == contender]
        assert len(own) > 3
        for coarse, fine in pairwise(own):
            assert coarse.size < fine.size
            assert coarse.mean > fine.mean > 0
    both = lossy.together(points + points)
    for one, two in zip(points, both, strict=True):
        assert (two.bits, two.most) == (one.bits, one.most)
        assert two.mean == pytest.approx(one.mean)
    assert draw(points).startswith(b"\x89PNG")


def test_gltfpack_is_measured_as_it_plays(walk: mp.Clip) -> None:
    there = GLTFPACK.exists() and shutil.which("node") is not None
    if not there and os.environ.get("CI"):
        pytest.fail("make node")
    if not there:
        pytest.skip("make node")
    found = {
        point.setting: point
        for point in lossy.measured(walk[:60], "walk", {"gltfpack": lossy.gltfpack(GLTFPACK)})
    }
    fine, coarse = found["-af 0 -ar 16"], found["-af 0 -ar 8"]
    assert 0 < fine.mean < 0.02
    assert fine.mean < coarse.mean
    assert coarse.size < fine.size < 60 * 31 * 16
    assert found["default"].most > fine.most


def test_the_command_writes_table_and_plot(samples: Path, tmp_path: Path) -> None:
    pytest.importorskip("zfpy")
    for suffix in ("amc", "asf"):
        shutil.copy(samples / f"cmu_01_01.{suffix}", tmp_path / f"01_01.{suffix}")
    words = ["bench", "lossy", str(tmp_path), "--clips", "01_01", "--only", "zfp"]
    words += ["--markdown", str(tmp_path / "a.md"), "--plot", str(tmp_path / "a.png")]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    table = (tmp_path / "a.md").read_text()
    assert table.strip() in result.stdout
    for line in table.splitlines()[4:]:
        assert line.split("|")[1].strip() in ("ACL", "zfp", "CurveCodec 2, as stated")
    assert "| ACL | p=0.1cm | 15.9" in table
    assert "| CurveCodec 2, as stated | p=0.1cm | 3.5" in table
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    words[words.index("zfp")] = "zfq"
    assert "no contender zfq" in CliRunner().invoke(app, [*words, "--force"]).output
