"""The short forms of the kill campaigns; ``make long`` runs the long ones."""

import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest


def a_seed() -> str:
    seed = os.environ.get("MOCAPRESS_SEED") or str(random.SystemRandom().randrange(10**6))
    print(f"MOCAPRESS_SEED={seed} repeats this")
    return seed


def test_kills_lose_nothing() -> None:
    seed = a_seed()
    done = subprocess.run(
        [
            *(sys.executable, Path(__file__).with_name("kills.py")),
            *("--runs", "16", "--frames", "5", "--seed", seed, "--every-call", "convert one"),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    print(done.stdout, done.stderr)
    assert done.returncode == 0
    assert "all written" in done.stdout
    assert "temporary files left" in done.stdout  # and cleaned by the run after it


@pytest.mark.skipif(
    sys.platform != "linux" or shutil.which(os.environ.get("CC", "cc")) is None,
    reason="calls are made to fail by LD_PRELOAD",
)
def test_kills_and_failing_calls_lose_nothing_of_a_library() -> None:
    done = subprocess.run(
        [
            *(sys.executable, Path(__file__).with_name("library_kills.py")),
            *("--runs", "10", "--stride", "60", "--seed", a_seed()),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    print(done.stdout, done.stderr)
    assert done.returncode == 0
    assert "the disk is full from then on" in done.stdout
