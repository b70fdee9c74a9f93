"""``mocapress bench``: found by mocapress through the entry point ``mocapress.commands``."""

import typer

from mocapress_bench.demo import demo
from mocapress_bench.diffma_command import diffma
from mocapress_bench.lossless_command import lossless
from mocapress_bench.lossy_command import lossy
from mocapress_bench.mrpa_command import mrpa
from mocapress_bench.patterns_command import patterns
from mocapress_bench.qssd_command import qssd
from mocapress_bench.qssd_model_command import qssd_model
from mocapress_bench.qssd_rivals_command import qssd_rivals
from mocapress_bench.search_command import search

app = typer.Typer(
    help="Measure codecs on clips.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (
    lossless,
    lossy,
    diffma,
    mrpa,
    patterns,
    qssd,
    qssd_model,
    qssd_rivals,
    search,
    demo,
):
    app.command()(command)
