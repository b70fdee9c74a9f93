"""Options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

Inputs = Annotated[
    list[Path], typer.Argument(help="Files or folders; - is stdin.", show_default=False)
]
# A text and not a path, as the slash at the end of a folder's name says something.
Output = Annotated[
    str | None,
    typer.Option(
        "-o",
        "--output",
        help="File; or folder, for several files or if it ends in /; - is stdout.",
        metavar="PATH",
    ),
]
Jobs = Annotated[
    int, typer.Option("-j", "--jobs", min=1, help="Number of files to work on at a time.")
]
Force = Annotated[
    bool,
    typer.Option(
        "--force", "-f", help="Overwrite existing files; write compressed data to a terminal."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print results as JSON.")]
Asf = Annotated[
    Path | None,
    typer.Option(
        "--asf", help="Skeleton of the AMC files; by default the ASF beside each.", metavar="FILE"
    ),
]
Models = Annotated[
    list[Path] | None,
    typer.Option(
        "--model",
        help="Model that files need, or a folder of models; may be repeated. Models are also "
        "found beside the files and in the folders of MOCAPRESS_MODELS.",
        metavar="PATH",
        show_default=False,
    ),
]
Lenient = Annotated[
    bool,
    typer.Option("--lenient", help="Read files that have lost frames as far as possible."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.", hidden=True)]
