"""Options that several commands have."""

import re
from pathlib import Path
from typing import Annotated

import typer

Inputs = Annotated[
    list[Path], typer.Argument(help="Files or folders; - is stdin.", show_default=False)
]
Piped = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="INPUTS...",
        help="Files or folders; - is stdin, which is also read where none is given and it is no "
        "terminal.",
        show_default=False,
    ),
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
    int,
    typer.Option(
        "-j",
        "--jobs",
        "-T",
        "--threads",
        min=0,
        help="Number of files to work on at a time; 0: as many as there are cores.",
    ),
]
Quiet = Annotated[
    bool, typer.Option("-q", "--quiet", help="Print errors only, neither results nor warnings.")
]
Verbose = Annotated[
    bool, typer.Option("-v", "--verbose", help="Also print the time and speed of each file.")
]
Parents = Annotated[
    bool, typer.Option("-p", "--parents", help="Make all folders above the outputs' own, too.")
]
SkipExisting = Annotated[
    bool, typer.Option("--skip-existing", help="Leave out inputs whose output exists.")
]
Update = Annotated[
    bool,
    typer.Option(
        "--update",
        "-u",
        help="Leave out inputs whose output exists and is as new; replace what is older.",
    ),
]
Remove = Annotated[
    bool,
    typer.Option(
        "--rm", help="Remove each input when its output is written; by default all are kept."
    ),
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
Joints = Annotated[
    Path | None,
    typer.Option(
        "--joints",
        help="JSON object that names the joints of a skeleton that are not found otherwise, e.g. "
        '{"left_knee": "LKnee"}.',
        metavar="FILE",
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
Limit = Annotated[
    int | None,
    typer.Option(
        "--limit",
        parser=lambda text: _bytes(text),
        metavar="SIZE",
        help="Bytes that may be restored from a file, or decoded of its numbers, e.g. 500M or 16G.",
        show_default="4G",
    ),
]
Lenient = Annotated[
    bool,
    typer.Option("--lenient", help="Read files that have lost frames as far as possible."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks of errors.")]


def _bytes(text: str) -> int:
    """Read a number of bytes: 4096, 500M, 4G; K, M, G, T are powers of 1024."""
    found = re.fullmatch(r"([0-9]{1,15})([KMGT]?)", text.upper())
    if found is None:
        raise typer.BadParameter(f"{text!r} is no size such as 500M or 16G")
    return int(found[1]) << 10 * " KMGT".index(found[2] or " ")
