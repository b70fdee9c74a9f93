"""The plot shows who is beaten by no other, and only those that restored everything."""

import random
from pathlib import Path
from typing import Any

import pytest

from mocapress_bench import pareto
from mocapress_bench.pareto import Box, Point


def row(codec: str, small: int, seconds: float, **more: Any) -> dict[str, Any]:
    fields = {"clip": "a", "codec": codec, "raw_bytes": 1_000_000, "compressed_bytes": small}
    fields |= {"decompress_s": seconds, "header_bytes": 1, "counts": "file", "model_bytes": 0}
    return fields | {"exact": True} | more


def test_points_count_models_and_leave_out_what_was_not_restored() -> None:
    rows = [
        row("a", 100_000, 0.1),
        row("a + model", 80_000, 0.1, model_bytes=20_000),
        row("broken", 10, 0.1, exact=False),
        row("gzip", 500_000, 0.01, header_bytes=0),
        row("numbers", 50_000, 0.1, header_bytes=0, counts="values"),
    ]
    assert pareto.points(rows) == [
        Point("a", 10, 10, "codec"),
        Point("a + model", 10, 10, "codec"),
        Point("gzip", 100, 2, "tool"),
        Point("numbers †", 10, 20, "values"),
    ]


def test_the_front_is_beaten_by_no_whole_file() -> None:
    slow, quick, beaten = (
        Point("slow", 1, 9, "codec"),
        Point("quick", 50, 5, "tool"),
        Point("beaten", 40, 4, "tool"),
    )
    values = Point("values", 60, 20, "values")
    assert pareto.front([quick, beaten, values, slow]) == [slow, quick]
    assert pareto.front([]) == []


def test_boxes_share_what_both_cover() -> None:
    assert Box(0, 0, 4, 4).shared(Box(3, 2, 9, 9)) == 2
    assert Box(0, 0, 4, 4).shared(Box(5, 5, 9, 9)) == 0


def test_names_of_many_contenders_do_not_cover_each_other() -> None:
    chance = random.Random(5)
    middles = [(chance.uniform(150, 450), chance.uniform(80, 320)) for _ in range(20)]
    sizes = [(chance.uniform(20, 90), 9.0) for _ in middles]
    frame, legend = Box(0, 0, 600, 400), Box(400, 340, 600, 400)
    places = pareto.place_names(middles, sizes, frame, [legend])
    names = [
        Box(x + left, y + low, x + left + width, y + low + height)
        for (x, y), (left, low), (width, height) in zip(middles, places, sizes, strict=True)
    ]
    for i, name in enumerate(names):
        assert name.shared(legend) < 1
        assert all(name.shared(other) < 1 for other in names[:i])
        assert all(name.shared(Box(x - 3, y - 3, x + 3, y + 3)) < 1 for x, y in middles)


def test_the_plot_is_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    rows = [row(f"contender {i}", 100_000 + 9_000 * i, 0.01 + 0.001 * i) for i in range(3)]
    assert pareto.draw(rows, tmp_path / "plot.png").read_bytes()[:4] == b"\x89PNG"
