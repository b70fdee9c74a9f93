"""``library``: each of its commands is a file beside this one."""

import typer

from mocapress.cli.library.add import add
from mocapress.cli.library.cat import cat
from mocapress.cli.library.check import check
from mocapress.cli.library.cluster import cluster
from mocapress.cli.library.create import create
from mocapress.cli.library.duplicates import duplicates
from mocapress.cli.library.export import export
from mocapress.cli.library.extract import extract
from mocapress.cli.library.import_mcz import import_mcz
from mocapress.cli.library.info import info
from mocapress.cli.library.label import label
from mocapress.cli.library.list_clips import list_clips
from mocapress.cli.library.patterns import patterns
from mocapress.cli.library.recompress import recompress
from mocapress.cli.library.reindex import reindex
from mocapress.cli.library.remove import remove
from mocapress.cli.library.sheet import sheet
from mocapress.cli.library.verify import verify

app = typer.Typer(
    help="Keep a collection of clips in one file, a library (.mocapdb).",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command()(create)
app.command()(add)
app.command("list")(list_clips)
for _command in (info, extract, cat, remove, label, verify, recompress, reindex, patterns, export):
    app.command()(_command)
app.command("import")(import_mcz)
app.command()(check)
app.command()(sheet)
app.command()(cluster)
app.command()(duplicates)
