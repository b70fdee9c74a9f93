"""``library recompress``."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

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


def recompress(
    file: File,
    patterns: Patterns = None,
    codec: Annotated[
        str, typer.Option("--codec", help="A lossless codec, e.g. exact:level=9.")
    ] = "exact",
    level: Annotated[
        int | None, typer.Option("--level", min=1, max=9, help="1 (fast) to 9 (small).")
    ] = None,
    models: Models = None,
    limit: Limit = None,
    cluster: Cluster = None,
    jobs: Jobs = 1,
    json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Code clips anew; their files and numbers stay the same.

    Each clip is a transaction of its own. A codec that predicts clips from each other, as mrpa
    does, codes them all in one.
    """
    from mocapress.cli.batch import run
    from mocapress.cli.library.codec import chosen_codec
    from mocapress.cli.models import open_models
    from mocapress.codecs import Scope

    made = chosen_codec(codec, level)
    with opened(file, "a", debug=debug, models=open_models(models or []), limit=limit) as library:
        clips = chosen(library, patterns)
        shards = sharded(library, cluster)
        if shards is not None:
            from mocapress.cli.library.shards import recompress_shards

            recompress_shards(
                shards,
                clips,
                made,
                cluster=cluster,
                jobs=jobs,
                json=json,
                quiet=quiet,
                debug=debug,
            )
            return
        together: dict[str, tuple[int, int]] = {}
        if made.can.scope is Scope.LIBRARY:
            together = library.recompress_together(clips, made)
            clips = [library[name] for name in together]

        def work(job: "Job") -> dict[str, Any]:
            name = str(job.source)
            before, after = together.get(name) or library.recompress(name, made)
            return {"bytes_before": before, "bytes_after": after}

        run(
            jobs_of(clips),
            work,
            threads=jobs,
            json=json,
            show=lambda job: print(f"{job.source}: {_sizes([job])}"),
            total=lambda done: print(f"{len(done)} clips: {_sizes(done)}"),
            quiet=quiet,
            debug=debug,
            close=library.close,
        )


def _sizes(jobs: "list[Job]") -> str:
    before = sum(job.result["bytes_before"] for job in jobs)
    after = sum(job.result["bytes_after"] for job in jobs)
    return f"{before} -> {after} bytes"
