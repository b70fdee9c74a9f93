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
        help="File; or folder, for many files or with / at its end; - is stdout.",
        metavar="PATH",
    ),
]
Jobs = Annotated[int, typer.Option("-j", "--jobs", min=1, help="Files at a time.")]
Force = Annotated[
    bool,
    typer.Option(
        "--force", "-f", help="Overwrite existing files; write compressed data to a terminal."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Results as JSON on stdout.")]
Asf = Annotated[
    Path | None,
    typer.Option("--asf", help="Skeleton of the AMC files; else the ASF beside each.", metavar="F"),
]
Models = Annotated[
    list[Path] | None,
    typer.Option(
        "--model",
        help="Model that files need, or a folder of models; may be repeated. Looked for, too: "
        "beside the files, and in the folders of MOCAPRESS_MODELS.",
        metavar="PATH",
        show_default=False,
    ),
]
Lenient = Annotated[
    bool,
    typer.Option("--lenient", help="Read what is left of files that have lost frames."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.", hidden=True)]
