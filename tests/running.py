"""The command line, run in this process or in one of its own."""

import subprocess
import sys
from typing import Any

from typer.testing import CliRunner, Result

from mocapress.cli.app import app

COMMAND = [sys.executable, "-m", "mocapress"]


def mocapress(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def process(*words: object, data: bytes = b"", **more: Any) -> subprocess.CompletedProcess[bytes]:
    command = [*COMMAND, *map(str, words)]
    return subprocess.run(command, input=data, capture_output=True, check=False, **more)


def started(*words: object, **more: Any) -> "subprocess.Popen[bytes]":
    command = [*COMMAND, *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)
