"""``library verify``."""

from typing import TYPE_CHECKING, Any

from mocapress.cli.library.opening import (
    Cluster,
    File,
    Patterns,
    chosen,
    jobs_of,
    opened,
    sharded,
)
from mocapress.cli.options import Debug, Jobs, Json, Limit, Models, Quiet

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def verify(
    file: File,
    patterns: Patterns = None,
    models: Models = None,
    limit: Limit = None,
    cluster: Cluster = None,
    jobs: Jobs = 1,
    json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Decode clips and check all their checksums; exit code 3 if one is damaged."""
    from mocapress.cli.batch import run
    from mocapress.cli.models import open_models
    from mocapress.errors import CorruptError

    with opened(file, debug=debug, models=open_models(models or []), limit=limit) as library:
        clips = chosen(library, patterns)
        shards = sharded(library, cluster)
        if shards is not None:
            from mocapress.cli.library.shards import verify_shards

            verify_shards(
                shards, clips, cluster=cluster, jobs=jobs, json=json, quiet=quiet, debug=debug
            )
            return

        def work(job: "Job") -> dict[str, Any]:
            faults = library.verify([str(job.source)])
            if faults:
                raise CorruptError("; ".join(what for _, what in faults), file=str(job.source))
            return {"ok": True}

        run(
            jobs_of(clips),
            work,
            threads=jobs,
            json=json,
            show=lambda job: print(f"{job.source}: ok"),
            total=lambda done: print(f"{len(done)} clips are sound"),
            failure_code=3,
            quiet=quiet,
            debug=debug,
        )
