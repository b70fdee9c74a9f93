"""The short form of the kill campaign; ``make long`` runs the long one."""

import os
import random
import subprocess
import sys
from pathlib import Path


def test_kills_lose_nothing() -> None:
    seed = os.environ.get("MOCAPRESS_SEED") or str(random.SystemRandom().randrange(10**6))
    print(f"MOCAPRESS_SEED={seed} repeats this")
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
