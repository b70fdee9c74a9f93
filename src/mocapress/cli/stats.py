"""``stats``."""

from typing import TYPE_CHECKING, Any

from mocapress.cli.options import Asf, Debug, Inputs, Jobs, Json, Lenient, Limit, Models

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def stats(
    inputs: Inputs,
    asf: Asf = None,
    models: Models = None,
    limit: Limit = None,
    lenient: Lenient = False,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Show how joints and channels move: range and speed, and what is missing.

    Speeds are per second where the sampling rate is known, and per frame where it is not.
    """
    from mocapress import api
    from mocapress.cli.batch import find, run
    from mocapress.cli.models import open_models, places_for
    from mocapress.cli.paging import paged
    from mocapress.formats import readable, suffixes
    from mocapress.motion.statistics import statistics

    given = open_models(models or [])

    def work(job: "Job") -> dict[str, Any]:
        source = job.opened(limit)
        places = places_for(job, given)
        clip = api.read_source(source, asf, models=places, strict=not lenient)
        return {"frames": len(clip), "seconds": clip.duration} | statistics(clip)

    files = find(inputs, (*suffixes(readable()), ".mcz"))
    with paged(not json) as paging:
        run(files, work, threads=jobs, json=json, show=_show, debug=debug, progress=not paging)


def _show(job: "Job") -> None:
    facts = job.result
    lasting = "" if facts["seconds"] is None else f", {facts['seconds']:.3f} s"
    print(f"{job.source}: {facts['frames']} frames{lasting}")
    for what in ("joints", "channels"):
        rows = facts[what]
        if rows:
            names = [name for name in rows[0] if name != "name"]
            print(f"{what[:-1]:<24}", *(f"{name.replace('_', ' '):>13}" for name in names))
        for row in rows:
            print(f"{row['name']:<24}", *(f"{_text(row[name]):>13}" for name in names))


def _text(value: Any) -> str:
    return "-" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)
