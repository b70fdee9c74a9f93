"""``cat``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.options import Debug, Limit, Models
from mocapress.cli.selecting import Frames

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def cat(
    file: Annotated[
        Path,
        typer.Argument(help="A motion file or .mcz; - is stdin.", show_default=False),
    ],
    frames: Frames = None,
    models: Models = None,
    limit: Limit = None,
    debug: Debug = False,
) -> None:
    """Write a file, or some frames of it in the file's own layout, to stdout."""
    from mocapress import api
    from mocapress.api.excerpts import excerpt
    from mocapress.cli.batch import STREAM, Job, run
    from mocapress.cli.models import open_models, places_for
    from mocapress.source import MCZ

    given = open_models(models or [])

    def work(job: "Job") -> dict[str, Any]:
        source = job.opened(limit)
        places = places_for(job, given)
        if frames is not None:
            data = excerpt(source, frames, places)
        else:
            data = api.restore(source, places).data if source.kind == MCZ else source.data
        job.outputs = {STREAM: data}
        return {}

    job = Job(file, file.parent, target=STREAM)
    run([job], work, json=False, show=lambda _: None, debug=debug)
