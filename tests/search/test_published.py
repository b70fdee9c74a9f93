"""Published ways of comparing by name, on motion of any skeleton."""

from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.errors import ParameterError
from mocapress.search import patterns
from mocapress.search.published import PATTERNS, PUBLISHED, distances_by
from mocapress.search.standard import StandardMotion, standard_motion


@pytest.fixture(scope="module")
def motions(samples: Path) -> list[StandardMotion]:
    walk = standard_motion(mp.read(samples / "cmu_01_01.amc"))
    return [walk[:80], walk[200:280], walk[400:480]]


@pytest.mark.parametrize("by", [*PUBLISHED, PATTERNS])
def test_a_clip_is_most_like_itself_and_mirrored_with_the_option(
    by: str, motions: list[StandardMotion]
) -> None:
    assert distances_by(by, motions[1], motions).argmin() == 1
    flipped = motions[2].mirrored()
    found = distances_by(by, flipped, motions, mirror=True)
    assert found.argmin() == 2
    assert found[2] < distances_by(by, flipped, motions)[2]


def test_scale_and_place_do_not_count(motions: list[StandardMotion]) -> None:
    clip = motions[0]
    other = StandardMotion(3 * clip.places, clip.root + 5, clip.heading + 1, clip.leg)
    assert distances_by("qssd", other, motions)[0] == pytest.approx(0, abs=1e-6)


def edit_distance(a: list[int], b: list[int]) -> int:
    """Give it as the definition has it."""
    rows = [[max(i, j) for j in range(len(b) + 1)] for i in range(len(a) + 1)]
    for i in range(1, len(a) + 1):
        for j in range(1, len(b) + 1):
            replaced = rows[i - 1][j - 1] + (a[i - 1] != b[j - 1])
            rows[i][j] = min(rows[i - 1][j] + 1, rows[i][j - 1] + 1, replaced)
    return rows[-1][-1]


def test_strings_of_patterns_are_compared_by_their_edit_distance() -> None:
    random = np.random.default_rng(0)
    for _ in range(50):
        a, b = (random.integers(0, 4, random.integers(1, 12)) for _ in range(2))
        assert patterns._edits(a, b) == edit_distance(a.tolist(), b.tolist())


def test_the_order_of_patterns_counts(motions: list[StandardMotion]) -> None:
    walk = motions[0]
    backwards = StandardMotion(walk.places[::-1], walk.root[::-1], walk.heading[::-1], walk.leg)
    same, other = distances_by(PATTERNS, walk, [walk, backwards])
    assert same == pytest.approx(0, abs=1e-9)
    assert other > 0.1


def test_nothing_to_search_in_and_unknown_names(motions: list[StandardMotion]) -> None:
    assert distances_by("qssd", motions[0], []).shape == (0,)
    assert distances_by(PATTERNS, motions[0], []).shape == (0,)
    with pytest.raises(ParameterError, match="qssd, qssd-dots, ksvd, patterns"):
        distances_by("best", motions[0], motions)
    assert np.isfinite(distances_by("ksvd", motions[0][:1], motions)).all()
