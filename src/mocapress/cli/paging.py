"""Long output on a terminal, page by page, as git shows it."""

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def paged(wanted: bool) -> Iterator[bool]:
    """Send what is printed through ``$PAGER``, by default less; never what goes into a pipe.

    Gives whether that is so. less shows what fits on the screen without waiting for a key, unless
    ``$LESS`` says otherwise.
    """
    command = os.environ.get("PAGER", "less")
    words = shlex.split(command)
    if not (wanted and sys.stdout.isatty() and words and shutil.which(words[0])):
        yield False
        return
    with subprocess.Popen(  # noqa: S603 - the user's own choice
        words,
        stdin=subprocess.PIPE,
        text=True,
        errors="surrogateescape",
        env={"LESS": "FRX"} | os.environ,
    ) as pager:
        terminal, sys.stdout = sys.stdout, pager.stdin
        try:
            with suppress(BrokenPipeError):  # its reader has seen enough
                yield True
        finally:
            sys.stdout = terminal
            with suppress(BrokenPipeError):
                pager.communicate()
