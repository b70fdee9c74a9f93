"""Tab completes commands, codecs and files: typed in the shells themselves."""

import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

pty = pytest.importorskip("pty", reason="no terminals on this system")

LOADED = {
    "bash": (["--norc", "-i"], 'eval "$(mocapress --show-completion)"'),
    "zsh": (
        ["-f", "-i"],
        'autoload -Uz compinit; compinit -u; eval "$(mocapress --show-completion)"',
    ),
}
TYPED = {
    "mocapress deco": "mocapress decompress ",
    "mocapress compress --codec ex": "mocapress compress --codec exact ",
    "mocapress --codec mr": "mocapress --codec mrpa ",
    "mocapress compress wal": "mocapress compress walk.amc ",
    "mocapress -9 wal": "mocapress -9 walk.amc ",
    "mocapress convert --to bv": "mocapress convert --to bvh ",
}
"""What is typed before Tab, and what then stands there."""


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "walk.amc").touch()
    (tmp_path / "run.bvh").touch()
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"PATH": path, "HOME": str(tmp_path), "TERM": "dumb", "PS1": "% "}


def there(shell: str) -> str:
    found = shutil.which(shell)
    if found is None:
        pytest.skip(f"{shell} is not installed")
    return found


@contextmanager
def terminal(words: list[str], environment: dict[str, str]) -> Iterator[int]:
    """Run a program on a terminal; give the terminal's other end."""
    mine, its = pty.openpty()
    with subprocess.Popen(
        words,
        stdin=its,
        stdout=its,
        stderr=its,
        env=environment,
        cwd=environment["HOME"],
        start_new_session=True,
    ) as running:
        os.close(its)
        try:
            yield mine
        finally:
            running.kill()
            os.close(mine)


def seen(terminal: int, wanted: str) -> str:
    """Read what is shown until something wanted is, or half a minute has passed."""
    shown, end = "", time.monotonic() + 30
    while wanted not in shown and time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            shown += os.read(terminal, 2**16).decode(errors="replace")
    return shown


@pytest.mark.parametrize("shell", LOADED)
def test_tab_completes(shell: str, environment: dict[str, str]) -> None:
    options, load = LOADED[shell]
    with terminal([there(shell), *options], environment) as typing:
        os.write(typing, f"{load}; echo LOA''DED\n".encode())
        assert "LOADED\r" in seen(typing, "LOADED\r")
        for typed, completed in TYPED.items():
            os.write(typing, f"{typed}\t".encode())
            assert completed in seen(typing, completed)
            os.write(typing, b"\x15")  # Ctrl-U: the line is not run


def test_fish_completes(environment: dict[str, str]) -> None:
    lines = "".join(f"complete -C '{typed}' | head -n 1\n" for typed in TYPED)
    script = f"mocapress --show-completion | source\n{lines}"
    found = subprocess.run(
        [there("fish"), "--no-config", "-c", script],
        env=environment,
        cwd=environment["HOME"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=True,
    )
    completed = [line.partition("\t")[0] for line in found.stdout.splitlines()]
    assert completed == [whole.split()[-1] for whole in TYPED.values()]
