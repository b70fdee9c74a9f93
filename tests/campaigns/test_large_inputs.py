"""Inputs larger than is held in memory: what they take does not grow with them."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from large_inputs import run, work_on, write_c3d, write_table

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="measures memory as Linux does")

_MEMORY = 256 * 2**20
"""What any work takes, however large the file is; one that is held as a whole takes more."""


@pytest.mark.parametrize(("name", "make"), [("a.tsv", write_table), ("a.c3d", write_c3d)])
def test_memory_does_not_grow_with_the_file(
    name: str, make: Callable[[Path, int], None], tmp_path: Path
) -> None:
    path = tmp_path / name
    make(path, 64 * 2**20)
    for work, ran in work_on(path, 1):
        assert ran.peak < _MEMORY, work
    told = json.loads(run("info", "--json", f"{path}.mcz").output)[0]
    assert told["codec"].startswith("exact")
    assert told["ratio"] > 2
