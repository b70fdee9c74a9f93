"""Write the seeds of the fuzz target of libmocapress: small clips whose heads are not packed."""

from pathlib import Path

import numpy as np

import mocapress as mp
from mocapress.container import head
from mocapress.container.packing import stored

FOLDER = Path(__file__).with_suffix("")


def main() -> None:
    """Write a file for each codec, and one with its head packed."""
    FOLDER.mkdir(exist_ok=True)
    time = np.arange(24) / 24
    turns = np.zeros((24, 3, 4))
    turns[..., 0], turns[..., 1] = np.cos(time)[:, None], np.sin(time)[:, None]
    offsets = [[0, 0, 0], [0, 80, 0], [0, 90, 0]]
    clip = mp.from_quaternions(turns, offsets, [-1, 0, 1], ["a", "b", "c"], 24)
    clip = clip.with_values(np.round(clip.values, 2))
    (FOLDER / "packed.mcz").write_bytes(mp.compress(clip, "exact:level=1"))
    head.pack = stored  # type: ignore[attr-defined, assignment]
    for name, codec in (
        ("fast", "exact:level=1,chunk=9"),
        ("exact", "exact:level=4"),
        ("near", "near:max=1cm,chunk=16"),
    ):
        (FOLDER / f"{name}.mcz").write_bytes(mp.compress(clip, codec))


if __name__ == "__main__":
    main()
