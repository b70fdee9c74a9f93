"""``library export``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapress.cli.library.opening import (
    File,
    Label,
    Patterns,
    chosen,
    jobs_of,
    opened,
    write_files,
)
from mocapress.cli.options import Debug, Force, Jobs, Json, Limit, Quiet

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def export(
    file: File,
    patterns: Patterns = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder for the files.", metavar="FOLDER")
    ] = Path(),
    label: Label = None,
    limit: Limit = None,
    jobs: Jobs = 1,
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Write clips as .mcz files, with their skeletons; nothing is coded again but shared frames."""
    from mocapress.library import names

    with opened(file, debug=debug, limit=limit) as library:
        files = jobs_of(chosen(library, patterns, label))
        for job in files:
            job.target, job.force = output / f"{names.checked(str(job.source))}.mcz", force

        def read(job: "Job") -> bytes:
            clip = library[str(job.source)]
            job.modified = clip.modified
            return library.read_mcz(clip)

        write_files(files, read, threads=jobs, json=json, quiet=quiet, debug=debug)
