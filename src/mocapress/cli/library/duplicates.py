"""``library duplicates``."""

from typing import Annotated

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Json


def duplicates(
    file: File,
    alike: Annotated[
        float,
        typer.Option("--alike", min=0.0, help="Mean distance up to which two takes count as one."),
    ] = 0.2,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Find takes that are nearly the same: copies at other rates or in other formats, retakes."""
    import json as jsonlib

    with opened(file, debug=debug) as library:
        groups = [[clip.name for clip in group.clips] for group in library.duplicates(alike)]
    if json:
        print(jsonlib.dumps(groups, indent=1))
        return
    for number, names in enumerate(groups, 1):
        print(f"{number}: {len(names)} takes")
        print("\n".join(f"  {name}" for name in names))
