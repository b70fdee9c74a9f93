"""``library list``."""

from typing import Annotated

import typer

from mocapress.cli.library.opening import File, Label, Patterns, chosen, opened
from mocapress.cli.options import Debug, Json


def list_clips(
    file: File,
    patterns: Patterns = None,
    label: Label = None,
    long: Annotated[
        bool,
        typer.Option("--long", "-l", help="Also format, frames, seconds, skeleton and labels."),
    ] = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """List clips by name, one a line; with --long the columns are separated by tabs."""
    import json as jsonlib
    import sys
    from dataclasses import fields

    with opened(file, debug=debug) as library:
        clips = chosen(library, patterns, label)
        if json:
            names = [field.name for field in fields(clips[0])][1:] if clips else []
            rows = [
                {name: getattr(clip, name) for name in names} | {"duration": clip.duration}
                for clip in clips
            ]
            text = jsonlib.dumps(rows, indent=1)
        elif long:
            text = "\n".join(
                "\t".join(
                    (
                        clip.name,
                        clip.format or "-",
                        str(clip.frames),
                        "-" if clip.duration is None else f"{clip.duration:.3f}",
                        clip.skeleton or "-",
                        ",".join(clip.labels) or "-",
                    )
                )
                for clip in clips
            )
        else:
            text = "\n".join(clip.name for clip in clips)
        if text:
            sys.stdout.write(text + "\n")
