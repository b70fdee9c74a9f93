"""What the commands of a library share: its arguments, opening it, choosing clips."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from mocapress.cli.batch import Job
    from mocapress.library import Library, StoredClip
    from mocapress.library.database import Database
    from mocapress.library.extracting import Item
    from mocapress.library.sharded import ShardedLibrary
    from mocapress.models import Place

# A text and not a path, as it may be a URL.
File = Annotated[
    str,
    typer.Argument(
        metavar="LIB",
        help="The library: a .mocapdb, or a folder or URL of a sharded one.",
        show_default=False,
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        help="Of a sharded library: do the work on a Dask cluster, tcp://HOST:8786, or on N "
        "workers that are started here, local:N.",
        metavar="CLUSTER",
    ),
]
Patterns = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[CLIPS]...",
        help="Names of clips, folders of them, or globs such as 'walks/*'; all without any.",
        show_default=False,
    ),
]
Label = Annotated[
    str | None, typer.Option("--label", help="Only clips that have this label.", metavar="LABEL")
]


@contextmanager
def telling(path: str, *, debug: bool) -> Iterator[None]:
    """End with a line where something fails that is done with a library."""
    from mocapress.cli.report import message, say
    from mocapress.errors import MocapressError

    try:
        yield
    except (MocapressError, OSError, MemoryError) as error:
        # Whoever read stdout has seen enough: no fault of the library.
        if debug or isinstance(error, BrokenPipeError):
            raise
        say(message(error, path))
        raise typer.Exit(1) from error


@contextmanager
def opened(
    path: str,
    mode: str = "r",
    *,
    debug: bool = False,
    models: "Sequence[Place]" = (),
    limit: int | None = None,
) -> "Iterator[Library]":
    """Open a library, of whose clips so many bytes may be restored; see ``telling``."""
    from mocapress.library import open_library
    from mocapress.source import LIMIT

    most = LIMIT if limit is None else limit
    with telling(path, debug=debug), open_library(path, mode, models=models, limit=most) as library:
        yield library


def sharded(library: "Library", cluster: str | None) -> "ShardedLibrary | None":
    """Give a library as the sharded one that it is; only such a one is for a cluster."""
    from mocapress.cli.batch import usage
    from mocapress.library.library import is_sharded

    if is_sharded(library.location):
        from mocapress.library.sharded import ShardedLibrary

        assert isinstance(library, ShardedLibrary)
        return library
    if cluster is not None:
        usage("--cluster is for sharded libraries: a URL, or a name that ends with a slash")
    return None


@contextmanager
def catalogue(path: str) -> "Iterator[Database]":
    """Give the tables of a library; of one that is one file without loading what reads clips."""
    from contextlib import closing

    from mocapress.library.database import WAIT, Database

    if "://" in path or Path(path).is_dir():
        from mocapress.library import open_library

        with open_library(path) as library:
            yield library.db
        return
    # Nothing is restored by the tables alone.
    with closing(Database(Path(path), writable=False, wait=WAIT, limit=None)) as db:
        yield db


def refuse_unknown(path: str, patterns: Sequence[str], fits: Callable[[str], bool]) -> None:
    """End where a pattern fits no clip."""
    from mocapress.cli.report import say

    for pattern in patterns:
        if not fits(pattern):
            say(f"{path}: no such clip: {pattern}")
            raise typer.Exit(1)


def chosen(
    library: "Library", patterns: Sequence[str] | None, label: str | None = None
) -> "list[StoredClip]":
    """Give the clips that are asked for; end where a pattern fits none."""
    refuse_unknown(library.location, patterns or (), lambda pattern: bool(library.clips(pattern)))
    return library.clips(patterns or (), label=label)


def jobs_of(items: "Sequence[StoredClip | Item]") -> "list[Job]":
    """Make a job of each clip or file of a library."""
    from mocapress.cli.batch import Job

    return [Job(Path(item.name), Path(), stored=True, share=item.size or 1) for item in items]


def write_files(
    files: "Sequence[Job]",
    read: "Callable[[Job], bytes]",
    *,
    threads: int,
    json: bool,
    quiet: bool,
    debug: bool,
) -> None:
    """Write to each job's target what is read for it."""
    from mocapress.cli.batch import run

    def work(job: "Job") -> dict[str, Any]:
        assert job.target is not None
        data = job.outputs[job.target] = read(job)
        return {"output": str(job.target), "bytes": len(data)}

    run(
        files,
        work,
        threads=threads,
        json=json,
        show=lambda job: print(f"{job.target}: {job.result['bytes']} bytes"),
        total=lambda done: print(f"{len(done)} files"),
        quiet=quiet,
        debug=debug,
    )
