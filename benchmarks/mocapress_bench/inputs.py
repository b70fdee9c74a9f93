"""Options and output that the commands share."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from mocapress.formats import listed, readable, suffixes

SAMPLES = Path(__file__).parents[2] / "samples"

Corpus = Annotated[
    Path | None, typer.Argument(help="Folder of clips; without it, the samples of a checkout.")
]


def _writable(context: typer.Context, path: Path | None) -> Path | None:
    """Refuse to overwrite a file before anything is measured."""
    if path is not None and path.exists() and not context.params.get("force"):
        usage(f"{path}: file exists; --force overwrites it")
    return path


def output(name: str, told: str, metavar: str = "FILE") -> Any:
    """Give the option of a file to write, for commands that have ``Force``."""
    return typer.Option(name, help=told, metavar=metavar, callback=_writable)


Json = Annotated[Path | None, output("--json", "Write all rows to this file.")]
Markdown = Annotated[Path | None, output("--markdown", "Write the tables to this file.")]
# Known before the files are.
Force = Annotated[
    bool, typer.Option("--force", "-f", help="Overwrite existing files.", is_eager=True)
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.", hidden=True)]


def clips_in(folder: Path) -> list[Path]:
    """Find the motion files below a folder."""
    endings = suffixes(readable())
    return sorted(path for path in folder.rglob("*") if path.name.lower().endswith(endings))


def clips_named(corpus: Path | None) -> tuple[list[Path], Path]:
    """Give the clips to measure, and the folder to which their names are relative."""
    folder = corpus or SAMPLES
    if corpus is None and not folder.is_dir():
        usage("name a folder of clips")
    if not folder.exists():
        usage(f"{folder}: no such file or folder")
    paths = clips_in(folder) if folder.is_dir() else [folder]
    if not paths:
        usage(f"no {listed(readable())} files in {folder}")
    return paths, folder if folder.is_dir() else folder.parent


def say(notes: list[str]) -> None:
    """Print notes to stderr."""
    for note in notes:
        typer.echo(f"mocapress: {note}", err=True)


def usage(message: str) -> NoReturn:
    """End with the exit code of wrong usage."""
    say([message])
    raise typer.Exit(2)


def progress_line(total: int) -> Callable[[str], None]:
    """Give a function that shows a clip's name, and how many there have been, on a terminal."""
    count = 0

    def show(what: str) -> None:
        nonlocal count
        count += 1
        if sys.stderr.isatty():
            typer.echo(f"\r\033[K{f'{count}/{total} ' if total else ''}{what}", err=True, nl=False)

    return show
