"""Long output is paged where it is shown on a terminal, and nowhere else."""

import os
import sys
from pathlib import Path

import pytest
from running import COMMAND, process
from terminals import seen, terminal

SAMPLE = Path(__file__).parents[2] / "samples/freebvh.bvh"
PAGER = """\
import sys
lines = sys.stdin.read().splitlines()
print(f"paged {len(lines)} lines, first {lines[0]}", flush=True)
"""


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "pager.py").write_text(PAGER)
    pager = f"{sys.executable} {tmp_path / 'pager.py'}"
    return os.environ | {"PAGER": pager, "HOME": str(tmp_path), "TERM": "dumb"}


def test_on_a_terminal_the_pager_gets_all_lines(environment: dict[str, str]) -> None:
    with terminal([*COMMAND, "info", str(SAMPLE)], environment) as shown:
        assert f"first {SAMPLE}" in seen(shown, "first ")


@pytest.mark.parametrize("pager", ["", "cat-that-is-not-there"])
def test_without_a_pager_it_is_printed(environment: dict[str, str], pager: str) -> None:
    with terminal([*COMMAND, "info", str(SAMPLE)], environment | {"PAGER": pager}) as shown:
        assert "number formats" in seen(shown, "number formats")


def test_a_pipe_gets_it_as_it_is(environment: dict[str, str]) -> None:
    found = process("info", SAMPLE, env=environment)
    assert found.stdout.startswith(os.fsencode(SAMPLE))
    assert b"paged" not in found.stdout
