"""``library list``."""

from typing import TYPE_CHECKING, Annotated

import typer

from mocapress.cli.library.opening import File, Label, Patterns, catalogue, refuse_unknown, telling
from mocapress.cli.options import Debug, Json

if TYPE_CHECKING:
    from mocapress.library import StoredClip


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

    from mocapress.library.clips import select

    wanted = patterns or ()
    with (
        telling(file, debug=debug),
        catalogue(file) as db,
        db.reading() as connection,
    ):
        clips = select(None, connection, wanted, label=label)
        refuse_unknown(file, wanted, lambda pattern: bool(select(None, connection, [pattern])))
    if json:
        names = [field.name for field in fields(clips[0])][1:] if clips else []
        rows = [
            {name: getattr(clip, name) for name in names} | {"duration": clip.duration}
            for clip in clips
        ]
        text = jsonlib.dumps(rows, indent=1)
    else:
        text = "\n".join(_line(clip) if long else clip.name for clip in clips)
    if text:
        sys.stdout.write(text + "\n")


def _line(clip: "StoredClip") -> str:
    duration = "-" if clip.duration is None else f"{clip.duration:.3f}"
    facts = clip.format, str(clip.frames), duration, clip.skeleton, ",".join(clip.labels)
    return "\t".join((clip.name, *(fact or "-" for fact in facts)))
