"""``library import``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Jobs, Json, Limit, Models

if TYPE_CHECKING:
    from mocapress.cli.batch import Job
    from mocapress.library.adding import Added


def import_mcz(
    file: File,
    inputs: Annotated[
        list[Path], typer.Argument(metavar="FILES...", help=".mcz files, or folders of them.")
    ],
    into: Annotated[
        str, typer.Option("--into", help="Folder in the library.", metavar="FOLDER")
    ] = "",
    models: Models = None,
    limit: Limit = None,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Add the clips of .mcz files as they are coded, once they are checked."""
    from mocapress.cli.batch import find, usage
    from mocapress.cli.library.added import add_all
    from mocapress.cli.models import open_models, places_for
    from mocapress.errors import CorruptError
    from mocapress.library.adding import Extra
    from mocapress.library.library import is_sharded, modified_of
    from mocapress.source import MCZ

    if is_sharded(file):
        usage(
            "import: a sharded library takes motion files; .mcz files are for one that is one file"
        )
    given = open_models(models or [])
    with opened(file, "a", debug=debug) as library:

        def add(job: "Job") -> "Added":
            own = str(job.source.relative_to(job.base)).removesuffix(".mcz")
            name = f"{into.strip('/')}/{own}".lstrip("/")
            source = job.opened(limit)
            if source.kind != MCZ:
                raise CorruptError("not compressed by mocapress", file=str(job.source))
            adder = library.adder(overwrite=True, models=places_for(job, given))
            return adder.file(source, name, Extra(modified_of(source)))

        add_all(library, find(inputs, (".mcz",)), add, threads=jobs, json=json, debug=debug)
