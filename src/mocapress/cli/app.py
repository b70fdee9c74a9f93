"""The command line: each command is a file beside this one."""

from typing import Annotated

import typer

from mocapress.cli.cat import cat
from mocapress.cli.compare import compare
from mocapress.cli.compress import compress
from mocapress.cli.convert import convert
from mocapress.cli.decompress import decompress
from mocapress.cli.info import info
from mocapress.cli.installed import Commands
from mocapress.cli.library import app as library
from mocapress.cli.list_codecs import list_codecs
from mocapress.cli.list_files import list_files
from mocapress.cli.options import Debug
from mocapress.cli.search import search
from mocapress.cli.stats import stats
from mocapress.cli.train import train
from mocapress.cli.verify import verify
from mocapress.cli.view import view
from mocapress.version import __version__

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(value: bool) -> None:
    if value:
        typer.echo(f"mocapress {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", "-V", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
    debug: Debug = False,
) -> None:
    """Store, play and search motion capture: AMC, BVH, C3D, TRC and tables, restored byte for byte.

    As with zstd and xz: mocapress FILE compresses, -d restores, -l lists and
    -t verifies; -1 to -9, -c, -f, -k, -o, -q, -r, --rm, -T and -v.

    Exit codes: 0 done; 1 bad input; 2 wrong usage; 3 damage or a difference
    found; 70 a defect of mocapress; 128 + n ended by signal n (130: Ctrl-C).
    """
    _ = version, debug


_OF_FILES = (compress, decompress, verify, train, info, convert, cat, compare, stats, view, search)
for _command in _OF_FILES:
    app.command()(_command)
app.command("list")(list_files)
app.command("codecs")(list_codecs)
app.add_typer(library, name="library")
