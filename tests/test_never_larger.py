"""No file is larger than xz -9e makes it plus 64 bytes."""

import lzma
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import mocapress as mp

HERE = Path(__file__).parent
FILES = [
    path
    for folder in (HERE / "cases", HERE.parent / "samples")
    for path in sorted(folder.rglob("*.*"))
    if path.suffix.lower() in (".bvh", ".amc", ".asf", ".c3d", ".trc")
]


def check(data: bytes, level: int) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        blob = mp.compress(data, f"exact:level={level}")
    assert len(blob) <= len(lzma.compress(data, preset=9 | lzma.PRESET_EXTREME)) + 64
    assert mp.decompress(blob) == data


@pytest.mark.parametrize("level", [6, 9])
@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_small_files_of_all_sorts(path: Path, level: int) -> None:
    check(path.read_bytes(), level)


def takes() -> Iterator[tuple[str, np.ndarray]]:
    """Give rows that come again: loops, held poses, a part of the body in a loop, with pauses."""
    random = np.random.default_rng(5)
    steps = np.cumsum(random.normal(0, 0.4, (600, 30)), axis=0)
    yield "loop", np.tile(steps[:50], (12, 1))
    yield "long loop", np.tile(steps[:250], (3, 1))
    yield "held", np.repeat(steps[::40], 40, axis=0)
    yield "there and back", np.concatenate([steps[:150], steps[149::-1], steps[:150]])
    parts = steps.copy()
    parts[:, :20] = np.tile(steps[:40, :20], (15, 1))
    yield "legs in a loop", parts
    yield "poses that come again", steps[random.integers(0, 30, 600) * 20]
    yield "noise", random.normal(size=(600, 30))


def amc_of(rows: np.ndarray, number: str) -> bytes:
    """Print rows as an AMC."""
    body = "".join(
        f"{i + 1}\n"
        + "".join(
            f"bone{j} " + " ".join(number.format(float(x)) for x in row[3 * j : 3 * j + 3]) + "\n"
            for j in range(10)
        )
        for i, row in enumerate(rows)
    )
    return f":FULLY-SPECIFIED\n:DEGREES\n{body}".encode()


@pytest.mark.parametrize("factor", [2.54, 0.1, 1.0000001])
def test_decimals_times_a_factor(factor: float) -> None:
    steps = np.cumsum(np.random.default_rng(6).normal(0, 0.4, (600, 30)), axis=0)
    decimals = [float(f"{x:.6g}") for x in steps.ravel()]
    check(amc_of(np.reshape(decimals, steps.shape) * factor, "{!r}"), 6)


@pytest.mark.parametrize("number", ["{:.6g}", "{!r}", "{:.4f}", "{:.17g}"])
@pytest.mark.parametrize("rows", [rows for _, rows in takes()], ids=[name for name, _ in takes()])
def test_rows_that_come_again(rows: np.ndarray, number: str) -> None:
    check(amc_of(rows, number), 6)


@pytest.mark.corpus
@pytest.mark.parametrize("level", [6, 9])
def test_real_files(corpus: Path, level: int) -> None:
    paths = sorted(path for path in corpus.glob("*/*/*.*") if path.stat().st_size < 400_000)
    for path in paths[level::13]:
        check(path.read_bytes(), level)
