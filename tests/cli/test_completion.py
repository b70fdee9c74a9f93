"""Tab completes commands, codecs and files: typed in the shells themselves."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from terminals import seen, terminal

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
