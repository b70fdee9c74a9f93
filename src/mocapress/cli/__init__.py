"""The command ``mocapress``. Imports little, so that ``--help`` is quick."""

import errno
import io
import os
import sys
import warnings


def main() -> None:
    """Run the command line; no traceback reaches a user who has not asked for one."""
    try:
        _run()
    except KeyboardInterrupt:  # before a command that says what was done, or behind it
        sys.exit(130)


def _run() -> None:
    from mocapress.cli.app import app
    from mocapress.cli.warned import say_at_once

    if isinstance(sys.stdout, io.TextIOWrapper):
        # Names of files need not be UTF-8: they go out as they came in.
        sys.stdout.reconfigure(errors="surrogateescape")
    warnings.showwarning = say_at_once
    debug = "--debug" in sys.argv[1:]
    try:
        try:
            app(prog_name="mocapress")
        finally:
            sys.stdout.flush()
    except Exception as error:
        if isinstance(error, OSError) and error.filename is None:
            _end_stdout(error)
        if debug:
            raise
        from mocapress.cli.report import is_defect, message, say

        say(message(error, ""))
        sys.exit(70 if is_defect(error) else 1)


def _end_stdout(error: OSError) -> None:
    """End quietly when stdout is closed: its reader has seen enough."""
    # What is still in the buffer must not be tried again when Python ends.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    if error.errno != errno.EPIPE:
        print(f"mocapress: standard output: {error.strerror}", file=sys.stderr)
    sys.exit(1)
