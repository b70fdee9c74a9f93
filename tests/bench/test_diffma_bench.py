"""The evaluation of DiffMA: one row for each contender, rates and errors that are what they say."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.codecs.diffma.allocation import psnr
from mocapress_bench import diffma, diffma_tables


def test_the_command_prints_and_writes_the_tables(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("zfpy")
    monkeypatch.setattr(diffma, "speed", lambda _: {"encode, 1 core": 1.0})
    words = ["bench", "diffma", str(samples / "freebvh.bvh")]
    words += ["--json", str(tmp_path / "rows.json"), "--markdown", str(tmp_path / "tables.md")]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0
    rows = {row["codec"]: row for row in json.loads((tmp_path / "rows.json").read_text())}
    assert set(rows) == {*diffma.contenders(), "the file", "zfp 0.125"}
    assert (tmp_path / "tables.md").read_text().strip() in result.stdout
    for table in ("**Table 2**", "**Table 3**", "**Table 4**", "**Speed**"):
        assert table in result.stdout

    clip = mp.read(samples / "freebvh.bvh")
    text = mp.to_json(replace(clip, skeleton=None), "diffma:bound=4")
    error = float(((mp.load(text).values - clip.values) ** 2).sum())
    row = rows["β = 4"]
    assert row["bits"] == 8 * len(text) / clip.values.size
    assert row["psnr"] == pytest.approx(psnr(error, clip.values.size))
    assert row["packed_bits"] < row["bits"]
    assert rows["own β for 40 dB"]["psnr"] >= 40
    assert rows["error ≤ 0.1, own β"]["largest_error"] <= 0.1
    assert rows["zfp 0.125"]["largest_error"] <= 0.125


def test_psnr_has_no_peak() -> None:
    assert psnr(4.0, 400) == pytest.approx(20)
    assert psnr(0.0, 400) == float("inf")


def test_clips_without_error_have_no_psnr() -> None:
    shape = {"clip": "a", "frames": 2, "channels": 3, "bits": 2.0, "packed_bits": 1.0}
    names = [f"β = {bound:g}" for bound in diffma.BOUNDS]
    rows = [shape | {"codec": name, "psnr": value} for name in names for value in (30.0, np.inf)]
    line = diffma_tables.report(rows).splitlines()[6]
    assert line.startswith("| 1 | 30.00 / 53.50 |")
    assert line.endswith("| 30.00 / 644.07 |")
    exact = [row for row in rows if row["psnr"] == np.inf]
    assert "| 1 |  |" in diffma_tables.report(exact)
