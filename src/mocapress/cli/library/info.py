"""``library info``."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from mocapress.cli.library.opening import File, Patterns, chosen, jobs_of, opened
from mocapress.cli.options import Debug, Json

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def info(file: File, patterns: Patterns = None, json: Json = False, debug: Debug = False) -> None:
    """Show what a library holds, or, of clips that are named, what is known of each."""
    from mocapress.cli.batch import Job, run
    from mocapress.cli.info import show
    from mocapress.library.describe import describe_clip, describe_library

    with opened(file, debug=debug) as library:
        if not patterns:
            run(
                [Job(Path(file), Path(file).parent)],
                lambda _: describe_library(library),
                json=json,
                show=show,
                debug=debug,
            )
            return

        def work(job: "Job") -> dict[str, Any]:
            return describe_clip(library, str(job.source))

        run(jobs_of(chosen(library, patterns)), work, json=json, show=show, debug=debug)
