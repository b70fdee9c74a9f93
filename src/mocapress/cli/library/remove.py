"""``library remove``."""

from typing import Annotated

import typer

from mocapress.cli.library.opening import File, chosen, opened
from mocapress.cli.options import Debug, Quiet


def remove(
    file: File,
    patterns: Annotated[
        list[str], typer.Argument(metavar="CLIPS...", help="Names, folders or globs.")
    ],
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Remove clips, all of them or none; clips that share frames with them stay whole."""
    with opened(file, "a", debug=debug) as library:
        clips = chosen(library, patterns)
        library.remove(*clips)
    for clip in [] if quiet else clips:
        print(f"{clip.name}: removed")
