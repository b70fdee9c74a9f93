"""``library add``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Asf, Debug, Jobs, Json

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def add(
    file: File,
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILES...",
            help="Motion files, folders of them, or tar archives; - is a tar archive on stdin.",
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
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Add motion files, with the structure of their folders; makes the library if there is none.

    What is there already and has not changed is left alone; what has changed is replaced. Each file
    is written as a whole, so whatever ends the command keeps what is done.
    """
    from mocapress.cli.batch import run
    from mocapress.cli.compress import say_what_is_left_out
    from mocapress.cli.library.added import facts, show, total
    from mocapress.cli.library.codec import chosen_codec
    from mocapress.cli.library.inputs import Inputs, endings
    from mocapress.cli.models import open_model

    learned = open_model(model) if model else None
    made = chosen_codec(codec, level, learned)
    found = Inputs(inputs, into.strip("/"), None if asf is None else str(asf))
    say_what_is_left_out(inputs, endings())
    with opened(file, "a", debug=debug) as library:
        adder = library.adder(made, learned, overwrite=True)

        def work(job: "Job") -> dict[str, Any]:
            return facts(found.add(job, library, adder, label or []))

        run(
            found.jobs(),
            work,
            threads=jobs,
            json=json,
            show=show,
            total=lambda done: total(done, file),
            debug=debug,
            whole=found.size,
            close=library.close,
        )
