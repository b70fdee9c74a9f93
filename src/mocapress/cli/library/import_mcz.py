"""``library import``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Jobs, Json, Models

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def import_mcz(
    file: File,
    inputs: Annotated[
        list[Path], typer.Argument(metavar="FILES...", help=".mcz files, or folders of them.")
    ],
    into: Annotated[
        str, typer.Option("--into", help="Folder in the library.", metavar="FOLDER")
    ] = "",
    models: Models = None,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Add the clips of .mcz files as they are coded, once they are checked."""
    from mocapress.cli.batch import find, run
    from mocapress.cli.library.added import facts, show, total
    from mocapress.cli.models import open_models, places_for
    from mocapress.errors import CorruptError
    from mocapress.library.adding import Extra
    from mocapress.library.library import modified_of
    from mocapress.source import MCZ

    given = open_models(models or [])
    with opened(file, "a", debug=debug) as library:

        def work(job: "Job") -> dict[str, Any]:
            own = str(job.source.relative_to(job.base)).removesuffix(".mcz")
            name = f"{into.strip('/')}/{own}".lstrip("/")
            source = job.opened()
            if source.kind != MCZ:
                raise CorruptError("not compressed by mocapress", file=str(job.source))
            adder = library.adder(overwrite=True, models=places_for(job, given))
            return facts(adder.file(source, name, Extra(modified_of(source))))

        run(
            find(inputs, (".mcz",)),
            work,
            threads=jobs,
            json=json,
            show=show,
            total=lambda done: total(done, file),
            debug=debug,
            close=library.close,
        )
