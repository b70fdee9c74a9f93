"""``verify``."""

from typing import TYPE_CHECKING, Any

from mocapress.cli.options import Debug, Inputs, Jobs, Json, Limit, Models, Quiet, Verbose

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def verify(
    inputs: Inputs,
    models: Models = None,
    limit: Limit = None,
    jobs: Jobs = 1,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Decode compressed files and check all checksums; exit code 3 if one is damaged.

    It says which sections, chunks and frames are damaged.
    """
    from mocapress import api
    from mocapress.cli.batch import find, run
    from mocapress.cli.models import open_models, places_for
    from mocapress.errors import CorruptError
    from mocapress.source import JSON_SUFFIXES

    files, given = find(inputs, (".mcz", *JSON_SUFFIXES)), open_models(models or [])

    def work(job: "Job") -> dict[str, Any]:
        source = job.opened(limit)
        checked = api.verify_source(source, places_for(job, given))
        if checked.damage:
            parts = (f"{where} ({error.what})" for where, error in checked.damage)
            raise CorruptError("; ".join(parts))
        return {"raw_bytes": checked.raw_bytes, "ok": True, "loss": dict(checked.loss) or None}

    run(
        files,
        work,
        threads=jobs,
        json=json,
        show=_show,
        failure_code=3,
        quiet=quiet,
        verbose=verbose,
        debug=debug,
    )


def _show(job: "Job") -> None:
    loss = job.result["loss"]
    said = "" if loss is None else f"; lossy: {', '.join(f'{k} {v}' for k, v in loss.items())}"
    print(f"{job.source}: {job.result['raw_bytes']} bytes, ok{said.replace('_', ' ')}")
