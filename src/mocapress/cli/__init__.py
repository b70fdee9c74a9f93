"""The command ``mocapress``. Imports little, so that ``--help`` is quick."""

import errno
import io
import os
import sys


def main() -> None:
    """Run the command line; no traceback reaches a user who has not asked for one."""
    from mocapress.cli.app import app

    if isinstance(sys.stdout, io.TextIOWrapper):
        # Names of files need not be UTF-8: they go out as they came in.
        sys.stdout.reconfigure(errors="surrogateescape")
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
        if isinstance(error, OSError) and isinstance(error.filename, str):
            # A path that cannot be looked at: a folder without permission, a name too long.
            print(f"mocapress: {error.filename}: {error.strerror}", file=sys.stderr)
            sys.exit(1)
        print(
            f"mocapress: a defect of mocapress: {type(error).__name__}: {error}; "
            "--debug shows where",
            file=sys.stderr,
        )
        sys.exit(70)


def _end_stdout(error: OSError) -> None:
    """End quietly when stdout is closed: its reader has seen enough."""
    # What is still in the buffer must not be tried again when Python ends.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    if error.errno != errno.EPIPE:
        print(f"mocapress: standard output: {error.strerror}", file=sys.stderr)
    sys.exit(1)
