"""BVH files of which some repeat parts of others, nearly."""

import numpy as np
from numpy.typing import NDArray


def similar_takes() -> dict[str, bytes]:
    """Four takes as tables: the second, third and fourth repeat parts of the first."""
    random = np.random.default_rng(5)
    walk = np.cumsum(
        [np.convolve(c, np.ones(30) / 5, "same") for c in random.normal(0, 1, (10, 1500))], axis=1
    ).T
    bend = 0.3 * np.sin(np.arange(1500) / 90)[:, None]
    parts = {
        "a": walk,
        "b": walk[200:900] + bend[:700],
        "c": walk[500:1400] - bend[:900],
        "d": walk[220:880] + 1.5 * bend[100:760],
    }
    return {name: bvh_of(values) for name, values in parts.items()}


def bvh_of(values: NDArray[np.float64]) -> bytes:
    joints = [f"JOINT J{i}\n{{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n" for i in range(9)]
    head = "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + "".join(joints)
    tail = "End Site\n{\nOFFSET 0 1 0\n}\n" + "}\n" * 10
    rows = "".join(" ".join(f"{value:.4f}" for value in row) + "\n" for row in values)
    motion = f"MOTION\nFrames: {len(values)}\nFrame Time: 0.0083333\n"
    return (head + tail + motion + rows).encode()
