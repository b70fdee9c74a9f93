"""The evaluation of QSSD: its sizes are those of its files, its errors those of its decoder."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app


def test_the_command_measures_what_it_says(samples: Path, tmp_path: Path) -> None:
    file, rows = samples / "freebvh.bvh", tmp_path / "rows.json"
    words = ["bench", "qssd", str(file), "--training", "qssd:atoms=4,iterations=2"]
    words += ["--steps", "0.5,2", "--json", str(rows), "--markdown", str(tmp_path / "t.md")]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    fine, coarse, plain, _ = json.loads(rows.read_text())
    assert (tmp_path / "t.md").read_text().strip() in result.stdout
    assert fine["ratio"] < coarse["ratio"]
    assert fine["ARMS, cm"] < coarse["ARMS, cm"]
    assert plain["model"] == 0 < fine["model"]
    assert plain["header"] > fine["header"]
    packed = mp.compress(file, "qssd:step=0.5")
    assert plain["ratio of files"] == pytest.approx(file.stat().st_size / len(packed))
    assert plain["payload"] < len(packed)
