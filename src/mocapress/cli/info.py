"""``info``."""

from typing import TYPE_CHECKING, Any

from mocapress.cli.options import Asf, Debug, Inputs, Jobs, Json, Lenient, Limit, Models

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def info(
    inputs: Inputs,
    asf: Asf = None,
    models: Models = None,
    limit: Limit = None,
    lenient: Lenient = False,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Show what motion files, compressed files and models contain."""
    from mocapress import describe
    from mocapress.cli.batch import find, run
    from mocapress.cli.models import open_models, places_for
    from mocapress.cli.paging import paged
    from mocapress.formats import formats, suffixes
    from mocapress.models import load_model
    from mocapress.source import DIFFMA_JSON, JSON_SUFFIXES, MCM, MCZ

    files = find(inputs, (*suffixes(formats()), ".mcz", ".mcm", *JSON_SUFFIXES))
    given = open_models(models or [])
    strict = not lenient

    def work(job: "Job") -> dict[str, Any]:
        source = job.opened(limit)
        if source.kind == MCZ:
            places = places_for(job, given)
            return describe.describe_mcz(source, asf_path=asf, models=places, strict=strict)
        if source.kind == MCM:
            return describe.describe_model(load_model(source.data), source.size)
        if source.kind == DIFFMA_JSON:
            return describe.describe_json(source)
        return describe.describe_file(source, asf_path=asf, strict=strict)

    with paged(not json) as paging:
        run(files, work, threads=jobs, json=json, show=show, debug=debug, progress=not paging)


def show(job: "Job") -> None:
    """Print what is known of a file: a fact a line, whole, however long it is."""
    facts = {key.replace("_", " "): value for key, value in job.result.items() if key != "warning"}
    width = max(map(len, facts))
    print(job.source)
    for key, value in facts.items():
        lines = [] if value is None else _text(value).split("\n")
        for name, line in zip([key, *[""] * len(lines)], lines, strict=False):
            print(f"  {name:<{width}}  {line}")


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):
        return "\n".join(f"{key}: {part}" for key, part in value.items())
    return f"{value:.4g}" if isinstance(value, float) else str(value)
