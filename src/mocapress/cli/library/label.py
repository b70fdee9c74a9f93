"""``library label``."""

from typing import Annotated

import typer

from mocapress.cli.library.opening import File, Patterns, chosen, opened
from mocapress.cli.options import Debug, Quiet

Labels = list[str] | None


def label(
    file: File,
    patterns: Patterns = None,
    add: Annotated[
        Labels, typer.Option("--add", help="Label to give; may be repeated.", metavar="LABEL")
    ] = None,
    remove: Annotated[
        Labels, typer.Option("--remove", help="Label to take away.", metavar="LABEL")
    ] = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Give clips labels or take them away; without --add and --remove, list all labels."""
    from mocapress.cli.batch import usage

    if not (add or remove):
        with opened(file, debug=debug) as library:
            for name, number in library.labels.items():
                print(f"{name}\t{number}")
        return
    if not patterns:
        usage("label: name the clips, or '*' for all")
    with opened(file, "a", debug=debug) as library:
        clips = chosen(library, patterns)
        library.label_all(clips, add or [], remove or [])
    if not quiet:
        print(f"{len(clips)} clips")
