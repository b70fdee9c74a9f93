"""``info``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import api
from mocapress.cli.batch import Job, Outcome, contents, find, run
from mocapress.container.mcz import MAGIC


def show_info(inputs: Sequence[Path], *, asf: Path | None, jobs: int, json: bool) -> None:
    """Describe motion files and ``.mcz`` files."""
    files = find(inputs, (".amc", ".bvh", ".asf", ".mcz"))

    def work(job: Job) -> dict[str, Any]:
        data = contents(job.source)
        if data[:4] == MAGIC:
            return api.describe(data, asf_path=asf or api.asf_beside(job.source))
        clip = api.read(job.source, asf_path=asf)
        return {"bytes": len(data)} | api.describe_clip(clip)

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
