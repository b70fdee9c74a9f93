"""``info``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import describe
from mocapress.cli.batch import STREAM, Job, Outcome, contents, find, run
from mocapress.container.mcz import MAGIC
from mocapress.formats.files import find_asf


def show_info(inputs: Sequence[Path], *, asf: Path | None, jobs: int, json: bool) -> None:
    """Describe motion files and ``.mcz`` files."""
    files = find(inputs, (".amc", ".bvh", ".asf", ".mcz"))

    def work(job: Job) -> dict[str, Any]:
        data = contents(job.source)
        if data[:4] == MAGIC:
            beside = find_asf(job.source.with_suffix("")) if job.source != STREAM else None
            return describe.describe_mcz(data, asf_path=asf or beside)
        return describe.describe_file(job.source, asf_path=asf)

    def show(outcomes: list[Outcome]) -> None:
        from rich.console import Console
        from rich.table import Table

        console = Console()
        for outcome in outcomes:
            table = Table(title=str(outcome.source), show_header=False, title_justify="left")
            for key, value in outcome.result.items():
                if value is not None and key != "warning":
                    table.add_row(key.replace("_", " "), _text(value))
            console.print(table)

    run(files, work, threads=jobs, json=json, show=show)


def _text(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
