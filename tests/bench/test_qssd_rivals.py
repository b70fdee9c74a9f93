"""Dictionaries as whole codecs: kinematics, sizes and options are what they are said to be."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.codecs.qssd.decomposition import LogSums, learn
from mocapress.codecs.qssd.quaternions import exponential, logarithm
from mocapress_bench.qssd_options import FewJoints, NonNegative, SumOne
from mocapress_bench.qssd_rivals import measure, placed, poses_of


def turns(frames: int = 60) -> np.ndarray:
    random = np.random.default_rng(3)
    parts = random.normal(size=(4, 9, 3))
    weights = np.abs(random.normal(size=(frames, 4)))
    return exponential(0.05 * np.einsum("fk,kjc->fjc", weights, parts))


@pytest.mark.parametrize("source", ["freebvh.bvh", "cmu_01_01.amc"])
def test_rotations_and_the_path_of_the_root_place_all_joints(samples: Path, source: str) -> None:
    one = poses_of(mp.read(samples / source)[:20], 1)
    assert placed(one.clip, one.turns, one.root) == pytest.approx(one.places, abs=1e-6)


def test_finer_steps_and_more_atoms_cost_more_and_lose_less(samples: Path) -> None:
    clips = [poses_of(mp.read(samples / "cmu_01_01.amc")[:800], 1000)]
    found = measure(clips, {"K": LogSums()}, atoms=12, most=6, steps=[0.1, 1], iterations=3)
    fine, coarse = found.rows
    assert fine["bytes"] > coarse["bytes"]
    assert fine["ARMS, cm"] < coarse["ARMS, cm"]
    assert fine["ratio"] == pytest.approx(1000 / fine["bytes"], rel=0.01)


def test_weights_are_not_below_0() -> None:
    learned = learn(NonNegative(), turns(), 6, 3, iterations=3)
    assert learned.weights.values.min() >= 0
    assert learned.errors[-1] < 5


def test_weights_have_one_sum() -> None:
    own = turns()
    learned = learn(SumOne(), own, 6, 3, iterations=3)
    mean = np.linalg.norm(logarithm(own).reshape(len(own), -1), axis=1).mean()
    assert learned.weights.values.sum(axis=1) == pytest.approx(mean)


def test_atoms_turn_few_joints() -> None:
    learned = learn(FewJoints(joints=2), turns(), 6, 3, iterations=3)
    assert ((learned.dictionary != 0).any(axis=2).sum(axis=1) <= 2).all()
    lengths = np.sqrt((learned.dictionary**2).sum(axis=(1, 2)))
    assert lengths == pytest.approx(1)


def test_the_command_writes_rows_and_pictures(samples: Path, tmp_path: Path) -> None:
    words = ["bench", "qssd-rivals", str(samples / "freebvh.bvh"), "--atoms", "5", "--most", "3"]
    words += ["--iterations", "2", "--steps", "0.5", "--json", str(tmp_path / "rows.json")]
    result = CliRunner().invoke(app, [*words, "--pictures", str(tmp_path)])
    assert result.exit_code == 0, result.output
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert len({row["codec"] for row in rows}) == len(rows) == 7
    for name in ("qssd_atoms.png", "qssd_poses.png"):
        with Image.open(tmp_path / name) as picture:
            assert len(set(picture.convert("L").tobytes())) > 10
