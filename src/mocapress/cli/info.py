"""``info``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import describe
from mocapress.cli.batch import Job, Outcome, find, opened, run
from mocapress.cli.models import open_models, places_for
from mocapress.formats import formats, suffixes
from mocapress.models import load_model
from mocapress.source import DIFFMA_JSON, JSON_SUFFIXES, MCM, MCZ


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
    files = find(inputs, (*suffixes(formats()), ".mcz", ".mcm", *JSON_SUFFIXES))
    given = open_models(models)

    def work(job: Job) -> dict[str, Any]:
        source = opened(job)
        if source.kind == MCZ:
            models = places_for(job, given)
            return describe.describe_mcz(source, asf_path=asf, models=models, strict=strict)
        if source.kind == MCM:
            return describe.describe_model(load_model(source.data), source.size)
        if source.kind == DIFFMA_JSON:
            return describe.describe_json(source.data)
        return describe.describe_file(source, asf_path=asf, strict=strict)

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
