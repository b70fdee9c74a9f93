"""Progress on a terminal."""

import os
import pty
import subprocess
from pathlib import Path

from running import COMMAND

SAMPLES = Path(__file__).parents[2] / "samples"


def test_a_terminal_shows_how_far_it_is(tmp_path: Path) -> None:
    (tmp_path / "clips").mkdir()
    for name in ("first.bvh", "second.bvh"):
        (tmp_path / "clips" / name).write_bytes((SAMPLES / "mocapbank.bvh").read_bytes())
    command = [*COMMAND, "compress", "-1", "clips", "-o", "packed"]
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=theirs,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "100"},
    )
    os.close(theirs)
    shown = b""
    while True:
        try:
            part = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        shown += part
    os.close(ours)
    assert process.wait() == 0
    assert b"2/2" in shown
    assert b"MB/s" in shown
    assert b"second.bvh" in shown
