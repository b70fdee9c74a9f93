"""``library sheet``."""

from pathlib import Path
from typing import Annotated

import typer

from mocapress.cli.library.opening import File, Label, Patterns, chosen, opened
from mocapress.cli.options import Debug, Force, Limit, Quiet


def sheet(
    file: File,
    patterns: Patterns = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="The picture.", metavar="SHEET.png")
    ] = Path("sheet.png"),
    label: Label = None,
    columns: Annotated[int, typer.Option("--columns", help="Clips in a row.", min=1, max=20)] = 3,
    moments: Annotated[int, typer.Option("--moments", help="Of each clip.", min=1, max=50)] = 6,
    most: Annotated[
        int, typer.Option("--most", help="Clips to draw, evenly spread over those chosen.", min=1)
    ] = 300,
    limit: Limit = None,
    force: Force = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Draw a contact sheet: figures of a few moments of each clip. Needs Pillow."""
    from mocapress.cli.pictures import check_kind, write_picture
    from mocapress.cli.report import message, say
    from mocapress.library.sheet import draw_sheet
    from mocapress.storage import check_targets

    check_kind(output, "-o")
    with opened(file, debug=debug, limit=limit) as library:
        check_targets([output], force=force)
        clips = [clip for clip in chosen(library, patterns, label) if clip.frames]
        if not clips:
            say(f"{file}: no clips to draw")
            raise typer.Exit(1)
        drawn = [clips[i * len(clips) // most] for i in range(most)] if len(clips) > most else clips
        picture, failures = draw_sheet(library, drawn, columns=columns, count=moments)
        write_picture(output, picture, force=force)
    for error in failures:
        say(message(error, error.file or ""))
    left = f" of {len(clips)} (--most)" if len(drawn) < len(clips) else ""
    if not quiet:
        print(f"{output}: {len(drawn)} clips{left}, {picture.width} x {picture.height} pixels")
    if failures:
        raise typer.Exit(1)
