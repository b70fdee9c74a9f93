"""``info``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import describe
from mocapress.cli.batch import STREAM, Job, Outcome, contents, find, run
from mocapress.cli.models import open_models, places_for
from mocapress.container import diffma_json, mcm, mcz
from mocapress.formats.files import find_asf
from mocapress.models import load_model


def show_info(
    inputs: Sequence[Path],
    *,
    asf: Path | None,
    models: Sequence[Path],
    strict: bool,
    jobs: int,
    json: bool,
) -> None:
    """Describe motion files, compressed files and models."""
    files = find(inputs, (".amc", ".bvh", ".asf", ".mcz", ".mcm", *diffma_json.SUFFIXES))
    given = open_models(models)

    def work(job: Job) -> dict[str, Any]:
        data = contents(job.source)
        if data[:4] == mcz.MAGIC:
            beside = find_asf(job.source.with_suffix("")) if job.source != STREAM else None
            models = places_for(job, given)
            return describe.describe_mcz(data, asf_path=asf or beside, models=models, strict=strict)
        if data[:4] == mcm.MAGIC:
            return describe.describe_model(load_model(data), len(data))
        if diffma_json.is_json(data, job.source.name):
            return describe.describe_json(data)
        return describe.describe_file(job.source, asf_path=asf, strict=strict)

    def show(outcomes: list[Outcome]) -> None:
        from rich.console import Console
        from rich.table import Table

        console = Console()
        for outcome in outcomes:
            table = Table(title=str(outcome.source), show_header=False, title_justify="left")
            for key, value in outcome.result.items():
                if value is not None:
                    table.add_row(key.replace("_", " "), _text(value))
            console.print(table)

    run(files, work, threads=jobs, json=json, show=show)


def _text(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
