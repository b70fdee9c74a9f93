"""``library list``."""

from collections.abc import Sequence
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
    import sys

    from mocapress.library.clips import names_of, select

    wanted = patterns or ()
    with (
        telling(file, debug=debug),
        catalogue(file) as db,
        db.reading() as connection,
    ):
        if json or long:
            clips = select(None, connection, wanted, label=label)
            text = _json(clips) if json else "\n".join(map(_line, clips))
        else:
            text = "\n".join(names_of(connection, wanted, label=label))
        refuse_unknown(file, wanted, lambda pattern: bool(names_of(connection, [pattern])))
    if text:
        sys.stdout.write(text + "\n")


def _json(clips: "Sequence[StoredClip]") -> str:
    import json
    from dataclasses import fields

    names = [field.name for field in fields(clips[0])][1:] if clips else []
    rows = [
        {name: getattr(clip, name) for name in names} | {"duration": clip.duration}
        for clip in clips
    ]
    return json.dumps(rows, indent=1)


def _line(clip: "StoredClip") -> str:
    duration = "-" if clip.duration is None else f"{clip.duration:.3f}"
    facts = clip.format, str(clip.frames), duration, clip.skeleton, ",".join(clip.labels)
    return "\t".join((clip.name, *(fact or "-" for fact in facts)))
