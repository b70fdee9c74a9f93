"""The evaluation of QSSD: its sizes are those of its files, its errors those of its decoder."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress_bench.qssd_model import MadeUp, made_up, restored, simulate, turns_of


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


def test_held_out_clips_are_coded_with_a_dictionary_of_others(
    samples: Path, tmp_path: Path
) -> None:
    for folder, first in (("01", 0), ("02", 40)):
        (tmp_path / folder).mkdir()
        clip = mp.read(samples / "freebvh.bvh")
        part = clip.with_frames(clip.values[first : first + 40], clip.frame_time)
        mp.write(part, tmp_path / folder / "clip.bvh")
    rows = tmp_path / "rows.json"
    words = ["bench", "qssd", str(tmp_path), "--learn-from", "01", "--steps", "0.5"]
    words += ["--training", "qssd:atoms=3,iterations=2", "--json", str(rows)]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    seen, held_out, plain = json.loads(rows.read_text())
    assert [row["clips"] for row in (seen, held_out, plain)] == [1, 1, 1]
    assert held_out["text"] == plain["text"] == (tmp_path / "02/clip.bvh").stat().st_size
    model = mp.train([tmp_path / "01/clip.bvh"], "qssd:atoms=3,iterations=2")
    packed = mp.compress(tmp_path / "02/clip.bvh", "qssd:step=0.5", model=model)
    assert held_out["text"] / held_out["ratio of files"] == pytest.approx(
        len(packed) + held_out["model"]
    )


def test_made_up_data_are_what_their_atoms_make() -> None:
    sizes = MadeUp(joints=3, atoms=4, most=2, frames=30)
    atoms, frames = made_up(sizes, 1.0, 60.0, 0)
    again, clean = made_up(sizes, 1.0, float("inf"), 0)
    assert (atoms == again).all()
    assert np.linalg.norm(frames, axis=-1) == pytest.approx(1)
    noise = np.mean((frames - clean) ** 2) * 4
    # What lies along the quaternion is lost when it is made unit length again.
    assert -10 * np.log10(noise) == pytest.approx(60 + 10 * np.log10(4 / 3), abs=0.5)
    assert restored(atoms, atoms) == 1
    assert restored(-atoms[:2], atoms) == 1
    assert restored(np.roll(atoms, 1, axis=1), atoms) == 0


def test_qssd_restores_a_dictionary_of_small_turns() -> None:
    sizes = MadeUp(joints=12, atoms=6, most=2, frames=150)
    rows = simulate(sizes, [0.5], [float("inf")], iterations=25, seed=0, progress=lambda _: None)
    sorting = next(row for row in rows if row["model"].startswith("QSSD, weights"))
    assert sorting["restored"][-1] == 1
    assert min(sorting["errors"]) < sorting["errors"][0] / 10


def test_frames_are_spread_over_clips_and_turn_from_the_first(samples: Path) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    turns = turns_of([clip, clip], 50)
    assert 25 <= len(turns) <= 50
    assert turns.shape[1] == len(clip.skeleton.joints) - 1 if clip.skeleton else False
    assert turns[0] == pytest.approx(np.broadcast_to([1.0, 0, 0, 0], turns[0].shape), abs=1e-9)


def test_the_command_repeats_section_4(samples: Path, tmp_path: Path) -> None:
    words = ["bench", "qssd-model", str(samples), "--frames", "120", "--atoms", "6", "--most", "3"]
    words += ["--iterations", "2", "--simulated", "3", "--times", "60", "--coefficients", "1"]
    words += ["--json", str(tmp_path / "rows.json")]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    found = json.loads((tmp_path / "rows.json").read_text())
    assert len(found["errors"]["all clips"]) == 4
    assert all(row["training"] > 0 for row in found["errors"]["all clips"])
    assert len(found["times"]) == 16
