"""How levels of ``exact`` follow each other, and how files name them."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress.api.opening import Opened
from mocapress.source import Source

LEVELS = range(1, 10)
FRAMES, CHANNELS = 420, 12


def bvh(rows: NDArray[np.float64]) -> bytes:
    """Give a file of a root and joints one behind the other."""
    joints = [
        f"JOINT j{i}\n{{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation"
        for i in range(rows.shape[1] // 3 - 2)
    ]
    root = "ROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
    head = ["HIERARCHY", root + "Zrotation Xrotation Yrotation", *joints]
    text = "\n".join([*head, "End Site\n{\nOFFSET 0 1 0\n}", *"}" * (len(joints) + 1), "MOTION"])
    lines = [" ".join(f"{value:.4f}" for value in row) for row in rows]
    return "\n".join([text, f"Frames: {len(rows)}", "Frame Time: 0.01", *lines, ""]).encode()


def waves() -> NDArray[np.float64]:
    """Give motion in which most channels follow from a few, (F, C)."""
    random = np.random.default_rng(3)
    times = np.arange(FRAMES)[:, None]
    few = 30 * np.sin(times * [0.05, 0.031, 0.017] + [0, 1, 2])
    return few @ random.normal(0, 1, (3, CHANNELS)) + random.normal(0, 0.002, (FRAMES, CHANNELS))


def turned() -> NDArray[np.float64]:
    """Give motion that is another one behind the first 256 frames: noise that nothing predicts."""
    rows = waves()
    rows[260:] = np.random.default_rng(4).normal(0, 20, rows[260:].shape)
    return rows


@pytest.mark.parametrize("rows", [waves(), turned(), np.ones((40, CHANNELS)), waves()[:3]])
def test_no_level_is_much_larger_than_the_one_below(rows: NDArray[np.float64]) -> None:
    data = bvh(rows)
    sizes = []
    for level in LEVELS:
        blob = mp.compress(data, f"exact:level={level}")
        assert mp.decompress(blob) == data
        assert Opened(Source(blob)).codec() == mp.codec(f"exact:level={level}")
        sizes.append(len(blob))
    # A byte may name the level.
    assert all(own <= max(1.002 * below, below + 1) for below, own in pairwise(sizes))


def test_a_file_names_only_what_is_not_usual() -> None:
    data = bvh(waves())

    def parameters(codec: str) -> dict[str, int | float | str | bool]:
        return dict(Opened(Source(mp.compress(data, codec))).streams[0].codec.parameters)

    assert parameters("exact:level=7") == {}
    assert parameters("exact:level=2,chunk=100") == {"chunk": 100}
