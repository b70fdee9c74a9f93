"""``library extract``."""

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
from mocapress.cli.options import Debug, Force, Jobs, Json, Limit, Models, Quiet

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def extract(
    file: File,
    patterns: Patterns = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder for the files.", metavar="FOLDER")
    ] = Path(),
    label: Label = None,
    models: Models = None,
    limit: Limit = None,
    salvage: Annotated[
        bool,
        typer.Option(
            "--salvage", help="Take what is left of a damaged library, and say what is lost."
        ),
    ] = False,
    jobs: Jobs = 1,
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Restore files with their names, folders and times, skeletons (ASF) included."""
    from mocapress.cli.models import open_models
    from mocapress.library import extracting, names

    with opened(file, debug=debug, models=open_models(models or []), limit=limit) as library:
        if salvage and not patterns and label is None:
            items = extracting.left(library)
        else:
            items = extracting.items(library, chosen(library, patterns, label), every=not patterns)
        files = jobs_of(items)
        of_job = dict(zip(files, items, strict=True))
        for job, item in of_job.items():
            job.target, job.force = output / names.checked(item.name), force

        def read(job: "Job") -> bytes:
            item = of_job[job]
            job.modified = item.modified
            return item.read(salvage)

        write_files(files, read, threads=jobs, json=json, quiet=quiet, debug=debug)
