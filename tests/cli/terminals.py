"""Programs on a terminal, and what they show there."""

import os
import select
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

import pytest

pty = pytest.importorskip("pty", reason="no terminals on this system")


@contextmanager
def terminal(words: Sequence[str], environment: Mapping[str, str]) -> Iterator[int]:
    """Run a program on a terminal, in its ``HOME``; give the terminal's other end."""
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
            try:
                shown += os.read(terminal, 2**16).decode(errors="replace")
            except OSError:  # the program has ended
                break
    return shown
