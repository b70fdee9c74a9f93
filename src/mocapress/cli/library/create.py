"""``library create``."""

from mocapress.cli.library.opening import File
from mocapress.cli.options import Debug


def create(file: File, debug: Debug = False) -> None:
    """Make a library without clips."""
    import typer

    from mocapress.cli.report import message, say
    from mocapress.errors import MocapressError
    from mocapress.library.database import create

    try:
        create(file)
    except (MocapressError, OSError) as error:
        if debug:
            raise
        say(message(error, str(file)))
        raise typer.Exit(1) from error
