"""Published signatures by name, on motion of any skeleton."""

from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.errors import ParameterError
from mocapress.search.published import PUBLISHED, distances_by
from mocapress.search.standard import StandardMotion, standard_motion


@pytest.fixture(scope="module")
def motions(samples: Path) -> list[StandardMotion]:
    walk = standard_motion(mp.read(samples / "cmu_01_01.amc"))
    return [walk[:80], walk[200:280], walk[400:480]]


@pytest.mark.parametrize("by", PUBLISHED)
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


def test_nothing_to_search_in_and_unknown_names(motions: list[StandardMotion]) -> None:
    assert distances_by("qssd", motions[0], []).shape == (0,)
    with pytest.raises(ParameterError, match="qssd, qssd-dots, ksvd"):
        distances_by("best", motions[0], motions)
    assert np.isfinite(distances_by("ksvd", motions[0][:1], motions)).all()
