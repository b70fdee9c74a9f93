"""Models are measured on clips that they have not seen, and their bytes are counted."""

import json
from pathlib import Path

import pytest
from learner import Learner
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.models import model_bytes
from mocapress_bench import learning, lossless, tables
from mocapress_bench.contenders import contenders
from mocapress_bench.inputs import clips_in

pytestmark = pytest.mark.usefixtures("learner")
BVH = (
    "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n"
    "MOTION\nFrames: %d\nFrame Time: 0.01\n%s"
)
VALUES = {"a/1": 1, "a/2": 2, "b/1": 10, "b/2": 20, "c/1": 100}


@pytest.fixture
def clips(tmp_path: Path) -> list[Path]:
    for name, value in VALUES.items():
        file = tmp_path / f"{name}.bvh"
        file.parent.mkdir(exist_ok=True)
        file.write_text(BVH % (4, f"{value}\n" * 4))
    return clips_in(tmp_path)


def test_no_model_has_seen_the_clips_of_its_folder(clips: list[Path]) -> None:
    found = learning.cross_validated(clips, "", folds=99, most_frames=10**6)
    (learned,) = [one for one in found if one.codec.id == "learner"]
    assert learned.name == "learner:level=9 + model"
    assert learned.codec == Learner(level=9)
    for path, model in learned.models.items():
        others = [other for other in clips if other.parent != path.parent]
        assert model == mp.train(others, "learner")
    assert list(learned.models) == clips


def test_folders_are_dealt_to_folds(clips: list[Path]) -> None:
    (learned,) = learning.cross_validated(clips, "learner", folds=2, most_frames=10**6)
    assert learned.name == "learner + model"
    found = {path.parent.name: model for path, model in learned.models.items()}
    assert (
        found["a"] == found["c"] == mp.train([p for p in clips if p.parent.name == "b"], "learner")
    )
    assert found["b"] == mp.train([p for p in clips if p.parent.name != "b"], "learner")


def test_models_learn_from_so_many_frames_of_all_folders(clips: list[Path]) -> None:
    (learned,) = learning.cross_validated(clips, "learner", folds=9, most_frames=6)
    model = next(model for path, model in learned.models.items() if path.parent.name == "c")
    first, second = (mp.read(next(p for p in clips if p.parent.name == n)) for n in ("a", "b"))
    assert model == mp.train([first, second[:2]], "learner")


def test_one_folder_cannot_be_cross_validated(clips: list[Path]) -> None:
    with pytest.raises(mp.ParameterError, match="at least two"):
        learning.cross_validated(clips[:2], "", folds=9, most_frames=100)


def test_each_model_is_counted_once(clips: list[Path], tmp_path: Path) -> None:
    learned = learning.cross_validated(clips, "learner", folds=3, most_frames=100)
    rows, _ = lossless.measure(clips, tmp_path, only="learner", learned=learned)
    own = [row for row in rows if row["codec"] == "learner + model"]
    assert [row["clip"] for row in own if row["model_bytes"]] == ["a/1.bvh", "b/1.bvh", "c/1.bvh"]
    sizes = {len(model_bytes(model)) for model in learned[0].models.values()}
    assert {row["model_bytes"] for row in own} == {0} | sizes
    assert all(row["exact"] for row in rows)
    files = sum(row["compressed_bytes"] for row in own)
    assert tables.stored(own) == files + sum(row["model_bytes"] for row in own) > files
    table = tables.totals(rows)
    assert f"| {tables.stored(own):,.0f} | {sum(row['model_bytes'] for row in own):,} |" in table


def test_the_command_measures_models(
    clips: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # That is measured in another process, which does not have this codec.
    monkeypatch.setattr(lossless, "peak_memory", lambda *_: {"peak_mb": 1.0})
    words = ["bench", "lossless", str(tmp_path), "--only", "learner:level=3,gzip -9"]
    model = tmp_path / "x.mcm"
    mp.save_model(mp.train(clips, "learner"), model)
    for more in (["--folds", "5", "--train-frames", "9"], ["--model", str(model)]):
        rows = tmp_path / "rows.json"
        result = CliRunner().invoke(app, [*words, *more, "--json", str(rows), "--force"])
        assert result.exit_code == 0, result.output
        names = {row["codec"] for row in json.loads(rows.read_text())}
        assert names == {"learner:level=3", "learner:level=3 + model", "gzip -9"}
        assert "of which models" in result.stdout
    result = CliRunner().invoke(app, [*words[:-1], "app", "--model", str(model)])
    assert result.exit_code == 2
    assert "expected learner among the codecs" in result.stderr


def test_three_levels_are_compared() -> None:
    found, _ = contenders()
    assert [name for name in found if name.startswith("learner")] == [
        "learner:level=1",
        "learner:level=5",
        "learner:level=9",
    ]
    (one,) = contenders("learner:level=2")[0].values()
    assert one == Learner(level=2)


def test_contenders_are_chosen_by_name() -> None:
    names = ["app", "app:t=10,mantissa_limit=53", "MPEG-4 LP, limit 53", "gzip -9"]
    assert list(contenders(",".join(names))[0]) == names
    assert list(contenders(" app , xz -9e")[0]) == ["app", "xz -9e"]
    with pytest.raises(mp.ParameterError, match="--only; expected codecs, or some of exact"):
        contenders("app,lzw")
    with pytest.raises(mp.ParameterError, match="app:t; expected 1 to"):
        contenders("app:t=0")


def test_a_clip_that_cannot_be_read_does_not_take_the_model_with_it(
    clips: list[Path], tmp_path: Path
) -> None:
    clips[0].write_bytes(b"HIERARCHY")
    learned = learning.cross_validated(clips, "learner", folds=3, most_frames=100)
    rows, notes = lossless.measure(clips, tmp_path, only="learner", learned=learned)
    assert len(notes) == 1
    assert [row["clip"] for row in rows if row["model_bytes"]] == ["a/2.bvh", "b/1.bvh", "c/1.bvh"]
