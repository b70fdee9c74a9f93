"""``library cluster``."""

from pathlib import Path
from typing import Annotated

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Force, Json


def cluster(
    file: File,
    count: Annotated[
        int | None,
        typer.Option(
            "--count", min=1, help="How many clusters; by default as many as fit the clips best."
        ),
    ] = None,
    sheets: Annotated[
        Path | None,
        typer.Option(
            "--sheets", help="Draw a contact sheet of each into this folder.", metavar="FOLDER"
        ),
    ] = None,
    most: Annotated[
        int, typer.Option("--most", help="Clips on a sheet: those nearest to the middle.", min=1)
    ] = 60,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Group clips by how they move, for collections without labels. Sheets need Pillow."""
    import json as jsonlib

    from mocapress.cli.pictures import write_picture
    from mocapress.cli.report import message, say
    from mocapress.library.sheet import draw_sheet
    from mocapress.storage import check_targets

    with opened(file, debug=debug) as library:
        groups = library.clusters(count)
        names = [[clip.name for clip in group.clips] for group in groups]
        if json:
            print(jsonlib.dumps(names, indent=1))
        for number, own in enumerate([] if json else names, 1):
            print(f"cluster {number}: {len(own)} clips")
            print("\n".join(f"  {name}" for name in own))
        if sheets is None:
            return
        width = len(str(len(groups)))
        pictures = [sheets / f"{number:0{width}}.png" for number in range(1, len(groups) + 1)]
        check_targets(pictures, force=force)
        sheets.mkdir(exist_ok=True)
        failed = False
        for group, target in zip(groups, pictures, strict=True):
            picture, failures = draw_sheet(library, group.clips[:most])
            write_picture(target, picture, force=force)
            for error in failures:
                failed = True
                say(message(error, error.file or ""))
    if failed:
        raise typer.Exit(1)
