"""``library add``."""

from pathlib import Path
from typing import Annotated

import typer

from mocapress.cli.library.opening import Cluster, File, opened, sharded
from mocapress.cli.options import Asf, Debug, Jobs, Json, Limit, Quiet


def add(
    file: File,
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILES...",
            help="Motion files, folders of them, or tar archives; - is a tar archive on stdin, "
            "which a sharded library does not take. Of such a one also as URLs.",
        ),
    ],
    into: Annotated[
        str, typer.Option("--into", help="Folder in the library.", metavar="FOLDER")
    ] = "",
    codec: Annotated[str, typer.Option("--codec", help="As of compress.")] = "exact",
    level: Annotated[
        int | None, typer.Option("--level", min=1, max=9, help="1 (fast) to 9 (small).")
    ] = None,
    model: Annotated[
        Path | None, typer.Option("--model", help="Model made by mocapress train; it is kept.")
    ] = None,
    asf: Asf = None,
    label: Annotated[
        list[str] | None,
        typer.Option("--label", help="Label for the clips; may be repeated.", metavar="LABEL"),
    ] = None,
    index: Annotated[
        bool | None,
        typer.Option(
            "--index/--no-index",
            help="Whether to index clips for search at once; by default as the library was "
            "created, with an index if nothing was said.",
            show_default=False,
        ),
    ] = None,
    limit: Limit = None,
    cluster: Cluster = None,
    jobs: Jobs = 1,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Add motion files, with the structure of their folders; makes the library if there is none.

    What is there already and has not changed is left alone; what has changed is replaced. Each file
    is written as a whole, so whatever ends the command keeps what is done.
    """
    from mocapress.cli.batch import usage
    from mocapress.cli.compress import say_what_is_left_out
    from mocapress.cli.library.added import add_all
    from mocapress.cli.library.codec import chosen_codec
    from mocapress.cli.library.inputs import Inputs, endings
    from mocapress.cli.models import open_model
    from mocapress.library.library import is_sharded

    learned = open_model(model) if model else None
    made = chosen_codec(codec, level, learned)
    if is_sharded(file):
        from mocapress.cli.library.shards import add_shards

        if asf is not None:
            usage("a sharded library takes the skeletons that lie beside the files, no other")
        with opened(file, "a", debug=debug, limit=limit) as library:
            shards = sharded(library, cluster)
            assert shards is not None
            add_shards(
                shards,
                [
                    shards.plan(
                        name, into, codec=made, model=learned, labels=label or [], index=index
                    )
                    for name in inputs
                ],
                labels=label or [],
                cluster=cluster,
                jobs=jobs,
                json=json,
                quiet=quiet,
                debug=debug,
            )
        return
    paths = [Path(name) for name in inputs]
    found = Inputs(paths, into.strip("/"), None if asf is None else str(asf), limit)
    if not quiet:
        say_what_is_left_out(paths, endings())
    with opened(file, "a", debug=debug, limit=limit) as library:
        sharded(library, cluster)
        adder = library.adder(made, learned, overwrite=True, indexed=index)

        add_all(
            library,
            found.jobs(),
            lambda job: found.add(job, library, adder, label or []),
            threads=jobs,
            json=json,
            quiet=quiet,
            debug=debug,
            whole=found.size,
        )
