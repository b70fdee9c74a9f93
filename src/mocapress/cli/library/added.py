"""What commands that add to a library say of each file, and of all."""

from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from mocapress.cli.batch import Job, run
from mocapress.library.adding import Added
from mocapress.library.library import Library


def add_all(
    library: Library,
    jobs: Iterable[Job],
    add: Callable[[Job], Added],
    *,
    threads: int,
    json: bool,
    quiet: bool,
    debug: bool,
    whole: float | None = None,
) -> None:
    """Add the file of each job, and report; ``whole`` is the size of all, where it is known."""
    run(
        jobs,
        lambda job: _facts(add(job)),
        threads=threads,
        json=json,
        show=_show,
        total=lambda done: _total(done, library.path),
        quiet=quiet,
        debug=debug,
        whole=whole,
        close=library.close,
    )


def _facts(added: Added) -> dict[str, Any]:
    """Give what is reported of a file."""
    return {
        "state": added.state,
        "raw_bytes": added.size,
        "stored_bytes": added.stored,
        "frames": added.frames,
        "frames_shared": added.shared,
        "warning": added.warning,
    }


def _show(job: Job) -> None:
    """Print a line, unless nothing was done."""
    found = job.result
    if found["state"] == "unchanged":
        return
    shared = f", {found['frames_shared']} of {found['frames']} frames were there"
    print(
        f"{job.source}: {found['state']}, {found['raw_bytes']} -> {found['stored_bytes']} bytes"
        f"{shared if found['frames_shared'] else ''}"
    )


def _total(jobs: list[Job], file: Path) -> None:
    """Print a line for all of them."""
    states = Counter(job.result["state"] for job in jobs)
    raw = sum(job.result["raw_bytes"] for job in jobs)
    counts = ", ".join(f"{number} {state}" for state, number in sorted(states.items()))
    print(f"{file}: {counts}; {raw} bytes of files")
