"""``library cat``."""

from typing import Annotated

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Limit, Models


def cat(
    file: File,
    clip: Annotated[str, typer.Argument(metavar="CLIP", help="Name of the clip.")],
    models: Models = None,
    limit: Limit = None,
    debug: Debug = False,
) -> None:
    """Write the original file of a clip to stdout."""
    import sys

    from mocapress.cli.models import open_models

    with opened(file, debug=debug, models=open_models(models or []), limit=limit) as library:
        sys.stdout.buffer.write(library.read_bytes(clip))
