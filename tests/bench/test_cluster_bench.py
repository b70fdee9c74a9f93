"""``bench lossless --cluster``: the same sizes as one machine finds, wherever the clips are."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from running import mocapress
from typer.testing import CliRunner

from mocapress_bench.cluster import measured
from mocapress_bench.command import app

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")
ONLY = "exact:level=1,xz -9e"


def rows(corpus: Path, target: Path, *more: str) -> list[tuple[Any, ...]]:
    words = ["lossless", str(corpus), "--only", ONLY, "--json", str(target), *more]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    kept = ("clip", "codec", "compressed_bytes", "frames", "exact", "sha256")
    found: list[dict[str, Any]] = json.loads(target.read_text())
    return [tuple(row[key] for key in kept) for row in found]


def test_a_cluster_finds_what_one_machine_finds(tmp_path: Path, samples: Path) -> None:
    raw = tmp_path / "raw"
    (raw / "in").mkdir(parents=True)
    for name in ("freebvh.bvh", "mocapbank.bvh"):
        shutil.copy(samples / name, raw / "in" / name)
    here = rows(raw, tmp_path / "here.json")
    assert len(here) == 4
    assert rows(raw, tmp_path / "there.json", "--cluster", "local:1") == here
    library = f"{tmp_path / 'lib'}/"
    mocapress("library", "create", library, "--shard-size", 10000)
    assert mocapress("library", "add", library, raw).exit_code == 0
    of_library = rows(Path(library), tmp_path / "library.json", "--cluster", "local:1")
    assert sorted(of_library) == sorted(here)
    assert measured.__module__ == "mocapress_bench.cluster"  # which workers can import


def test_what_a_cluster_cannot_do_is_refused(tmp_path: Path) -> None:
    for words in (["--folds", "2"], []):
        corpus = [str(tmp_path)] if words else []
        done = CliRunner().invoke(app, ["lossless", *corpus, "--cluster", "local:1", *words])
        assert done.exit_code == 2
        assert "--cluster needs a folder" in done.output
    done = CliRunner().invoke(app, ["lossless", str(tmp_path), "--cluster", "local:1"])
    assert (done.exit_code, "no clips" in done.output) == (2, True)
