"""The command ``mocapress``. Imports little, so that ``--help`` is quick."""

import sys


def main() -> None:
    """Run the command line; no traceback reaches a user who has not asked for one."""
    from mocapress.cli.app import app

    debug = "--debug" in sys.argv[1:]
    try:
        app(prog_name="mocapress")
    except Exception as error:
        if debug:
            raise
        print(
            f"mocapress: a defect of mocapress: {type(error).__name__}: {error}; "
            "--debug shows where",
            file=sys.stderr,
        )
        sys.exit(70)
