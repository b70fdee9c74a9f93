"""The evaluation of search: measures by hand, alignment by a slow oracle, the whole command."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.search.signatures import BYTES
from mocapress_bench.search import HELD_OUT, METHODS
from mocapress_bench.search_alignment import Clips, separate, stretches
from mocapress_bench.search_measures import average_precision, confusion, measures
from mocapress_bench.search_projection import learned
from mocapress_bench.search_rivals import between_clouds, euclidean
from mocapress_bench.search_stretches import Hit, Mark, iou

Array = NDArray[np.float64]


def test_measures_of_a_ranking_by_hand() -> None:
    labels = np.array(["a", "a", "a", "b", "b"])
    actors = np.array(["bd", "bd", "mm", "bd", "mm"])
    near = np.array(
        [
            [0, 1, 2, 3, 4],  # a: two of two
            [1, 0, 3, 2, 4],  # a: one of two
            [1, 3, 0, 2, 4],  # a: one of two
            [3, 2, 4, 0, 1],  # b: its one
            [1, 2, 3, 4, 0],  # b: none
        ],
        dtype=float,
    )
    found = measures(near, labels, actors)
    assert found["true positives"] == pytest.approx(100 * (2 / 3 + 1 / 2) / 2)
    assert found["first"] == pytest.approx(100 * ((1 + 1 + 1) / 3 + 1 / 2) / 2)
    # Across actors the first query may find the third clip and the fifth only.
    assert found["first across"] == pytest.approx(100 * ((1 + 1 + 1) / 3 + 1 / 2) / 2)
    # The third and the fifth clip ask, the first, second and fourth are there to be found.
    assert found["split"] == 50
    assert found["nearest by the same actor"] == pytest.approx(100 * 2 / 5)
    names, matrix = confusion(near, labels)
    assert names == ["a", "b"]
    assert matrix.sum(axis=1) == pytest.approx(100)
    assert matrix[0, 0] == pytest.approx(found_of(near, labels))


def found_of(near: Array, labels: NDArray[np.str_]) -> float:
    parts = []
    for q in np.flatnonzero(labels == "a"):
        order = [i for i in np.argsort(near[q]) if i != q][:2]
        parts.append(np.mean(labels[order] == "a"))
    return 100 * float(np.mean(parts))


def test_average_precision_by_hand() -> None:
    assert average_precision(np.array([1.0, 0, 1])) == pytest.approx((1 + 2 / 3) / 2)


def slowly_aligned(costs: Array) -> float:
    paths = np.full((costs.shape[0] + 1, costs.shape[1] + 1), np.inf)
    paths[0, 0] = 0
    for i in range(costs.shape[0]):
        for j in range(costs.shape[1]):
            alone = min(paths[i, j + 1], paths[i + 1, j]) + costs[i, j]
            paths[i + 1, j + 1] = min(alone, paths[i, j] + 2 * costs[i, j])
    return float(paths[-1, -1] / sum(costs.shape))


def test_many_clips_are_aligned_as_each_would_be() -> None:
    random = np.random.default_rng(0)
    rows = [random.normal(size=(length, 3)) for length in (7, 1, 12, 5, 30, 9)]
    query = random.normal(size=(8, 3))
    expected = [slowly_aligned(euclidean(query, row)) for row in rows]
    assert Clips(rows, euclidean).distances(query) == pytest.approx(expected)


def test_a_stretch_is_found_where_it_lies() -> None:
    random = np.random.default_rng(1)
    take = np.cumsum(random.normal(size=(80, 4)), axis=0)
    ends, begins = stretches(euclidean(take[20:36], take))
    (cost, first, last), *_ = separate(ends, begins, 3)
    assert (first, last) == (20, 36)
    assert cost == pytest.approx(0, abs=1e-6)
    faster, _ = stretches(euclidean(take[20:36], take[20:37:2]))
    assert np.isfinite(faster[-1])
    too_fast, _ = stretches(euclidean(take[20:36], take[20:36:3]))
    assert not np.isfinite(too_fast).any()


def test_iou_of_stretches() -> None:
    mark = Mark(10, 20, "a", 0)
    assert iou(Hit(0, 0, 10, 20), mark) == 1
    assert iou(Hit(0, 0, 15, 25), mark) == pytest.approx(1 / 3)
    assert iou(Hit(0, 0, 30, 40), mark) == 0


def test_clouds_are_compared_at_their_best_turn_and_place() -> None:
    random = np.random.default_rng(2)
    cloud = random.normal(size=(1, 9, 3))
    cloud -= cloud.mean(axis=1, keepdims=True) * (1, 0, 1)
    turn = 0.7
    turned = cloud @ np.array(
        [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    )
    assert between_clouds(cloud, turned) == pytest.approx(0, abs=1e-6)
    lifted = cloud + np.array([0, 0.5, 0])
    assert between_clouds(cloud, lifted) == pytest.approx(0.5)


@pytest.fixture
def cuts(samples: Path, tmp_path: Path) -> Path:
    """Parts of a walk, twice each with small noise, by two actors."""
    folder = tmp_path / "data/hdm05"
    folder.mkdir(parents=True)
    clip = mp.read(samples / "cmu_01_01.amc")
    random = np.random.default_rng(0)
    lines = ["file\tclass\tactor"]
    (folder / "walk.asf").write_bytes((samples / "cmu_01_01.asf").read_bytes())
    for part in range(3):
        for actor in ("bd", "mm"):
            for copy in range(2):
                first = 100 + 600 * part + 10 * copy
                values = clip.values[first : first + 120]
                noisy = values + 0.1 * random.normal(size=values.shape)
                name = f"{actor}{part}{copy}.amc"
                mp.write(clip.with_frames(noisy, clip.frame_time), folder / name)
                lines.append(f"{name}\tpart{part}\t{actor}")
    (folder / "labels.tsv").write_text("\n".join(lines) + "\n")
    return folder.parent


def test_the_command_ranks_by_all_methods(cuts: Path, tmp_path: Path) -> None:
    rows = tmp_path / "rows.json"
    words = ["bench", "search", str(cuts), "--seeds", "2", "--json", str(rows)]
    result = CliRunner().invoke(app, [*words, "--plots", str(tmp_path / "fig7.png")])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "fig7.png").read_bytes().startswith(b"\x89PNG")
    found = json.loads(rows.read_text())
    assert [row["method"] for row in found["HDM05"]] == [m for m in METHODS if m != HELD_OUT]
    by = {row["method"]: row for row in found["HDM05"]}
    assert by["match webs (Kovar 2004)"]["true positives"] == 100
    assert by["mocapress"]["true positives"] > 90
    assert by["QSSD of bones"]["true positives"] > 60
    assert by["QSSD"]["bytes"] > 0
    assert [row["method"] for row in found["stretches"]] == ["mocapress", "match webs (Kovar 2004)"]
    assert all(row["recall at R"] > 80 and row["IoU"] > 0.7 for row in found["stretches"])
    assert np.sum(found["confusion"]["QSSD of bones"]["per cent"], axis=1) == pytest.approx(
        100, abs=0.1
    )


def test_a_folder_without_labels_is_refused(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["bench", "search", str(tmp_path)])
    assert result.exit_code == 2
    assert "hdm05" in result.output


def test_a_learned_projection_makes_what_differs_within_classes_count_little() -> None:
    random = np.random.default_rng(3)
    classes = [f"class {i % 5}" for i in range(100)]
    middles = np.repeat(random.normal(size=(1, 5, 80)), 20, axis=0).reshape(100, 80)
    way = random.normal(size=80)
    descriptions = (
        middles + random.normal(size=(100, 1)) * 5 * way + 0.1 * random.normal(size=(100, 80))
    )
    found = learned(descriptions, classes)
    assert found.matrix.shape == (80, BYTES)
    made = (descriptions - found.mean) @ found.matrix
    spread = [made[i::5].std(axis=0) for i in range(5)]
    before = [descriptions[i::5].std(axis=0) for i in range(5)]
    assert np.linalg.norm(spread) / made.std() < 0.8 * np.linalg.norm(before) / descriptions.std()
