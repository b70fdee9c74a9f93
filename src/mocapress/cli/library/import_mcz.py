"""``library import``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapress.cli.library.opening import Cluster, File, opened, sharded
from mocapress.cli.options import Debug, Jobs, Json, Limit, Models, Quiet

if TYPE_CHECKING:
    from mocapress.cli.batch import Job
    from mocapress.library.adding import Added


def import_mcz(
    file: File,
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILES...",
            help=".mcz files, or folders of them; of a sharded library also as URLs.",
        ),
    ],
    into: Annotated[
        str, typer.Option("--into", help="Folder in the library.", metavar="FOLDER")
    ] = "",
    models: Models = None,
    limit: Limit = None,
    cluster: Cluster = None,
    jobs: Jobs = 1,
    json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Add the clips of .mcz files as they are coded, once they are checked."""
    from mocapress.cli.batch import find
    from mocapress.cli.library.added import add_all
    from mocapress.cli.models import open_models, places_for
    from mocapress.errors import CorruptError
    from mocapress.library.adding import Extra
    from mocapress.library.library import modified_of
    from mocapress.source import MCZ

    given = open_models(models or [])
    with opened(file, "a", debug=debug, limit=limit) as library:
        shards = sharded(library, cluster)
        if shards is not None:
            from mocapress.cli.library.shards import add_shards

            add_shards(
                shards,
                [shards.plan(name, into, compressed=True, models=given) for name in inputs],
                cluster=cluster,
                jobs=jobs,
                json=json,
                quiet=quiet,
                debug=debug,
            )
            return

        def add(job: "Job") -> "Added":
            own = str(job.source.relative_to(job.base)).removesuffix(".mcz")
            name = f"{into.strip('/')}/{own}".lstrip("/")
            source = job.opened(limit)
            if source.kind != MCZ:
                raise CorruptError("not compressed by mocapress", file=str(job.source))
            adder = library.adder(overwrite=True, models=places_for(job, given))
            return adder.file(source, name, Extra(modified_of(source)))

        add_all(
            library,
            find([Path(name) for name in inputs], (".mcz",)),
            add,
            threads=jobs,
            json=json,
            quiet=quiet,
            debug=debug,
        )
