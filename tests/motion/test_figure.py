"""What is said of a figure's unit and floor, from its rest pose or its motion."""

from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.motion import Clip, Skeleton
from mocapress.motion.convert import to_bvh_clip
from mocapress.motion.figure import doubtful_root, unit_of

CASES = Path(__file__).parents[1] / "cases"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("14-all-six-zero-offsets/a.bvh", "cm (in motion the figure measures"),
        ("48-up-and-root/static_root_walk.bvh", "cm (the figure measures 150)"),
        ("48-up-and-root/z_up_push_ups.bvh", "m (the figure measures 1.5)"),
    ],
)
def test_the_unit_of_cases(name: str, said: str) -> None:
    assert (unit_of(mp.read(CASES / name)) or "").startswith(said)


def test_the_unit_is_suggested(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")
    assert (unit_of(clip) or "").startswith("1 unit is 5.644 cm")
    assert (unit_of(mp.read(samples / "freebvh.bvh")) or "").startswith("cm")
    converted = to_bvh_clip(clip, fps=120)
    assert converted.skeleton is not None
    bare = replace(converted, skeleton=Skeleton(converted.skeleton.joints))
    assert "5.644" in (unit_of(bare) or "")


def relative(clip: Clip, height: float) -> Clip:
    """Give the clip with the root's height moved from its channels to its OFFSET."""
    assert clip.skeleton is not None
    root = replace(clip.skeleton.joints[0], offset=(0.0, height, 0.0))
    skeleton = replace(clip.skeleton, joints=(root, *clip.skeleton.joints[1:]))
    values = np.array(clip.values)
    values[:, 1] -= height
    return replace(clip.with_frames(values, Decimal("0.01")), skeleton=skeleton)


def test_a_translation_relative_to_its_offset_is_told(samples: Path) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    assert doubtful_root(clip) is None
    height = float(np.median(clip.values[:, 1]))
    said = doubtful_root(relative(clip, height)) or ""
    assert "probably relative" in said
    assert f"{height:.2g}"[:1] in said
