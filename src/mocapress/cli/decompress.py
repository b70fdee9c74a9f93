"""``decompress``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from mocapress.cli.options import (
    Debug,
    Force,
    Jobs,
    Json,
    Limit,
    Models,
    Output,
    Parents,
    Piped,
    Quiet,
    Remove,
    SkipExisting,
    Update,
    Verbose,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from mocapress.cli.batch import Job
    from mocapress.source import Source

T = TypeVar("T")


def decompress(
    inputs: Piped = None,
    output: Output = None,
    models: Models = None,
    limit: Limit = None,
    salvage: Annotated[
        bool,
        typer.Option(
            "--salvage", help="Restore what is left of damaged files, and say what is lost."
        ),
    ] = False,
    with_asf: Annotated[
        bool,
        typer.Option("--with-asf", help="Also restore the skeleton (ASF) that a file holds."),
    ] = False,
    jobs: Jobs = 1,
    force: Force = False,
    skip_existing: SkipExisting = False,
    update: Update = False,
    parents: Parents = False,
    remove: Remove = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Restore the original files: byte for byte or, after a lossy codec, with decoded values."""
    from mocapress import api
    from mocapress.cli.batch import STREAM, find, named, run
    from mocapress.cli.models import open_models, places_for
    from mocapress.cli.sizes import show_sizes, show_total
    from mocapress.cli.targets import plan
    from mocapress.errors import CorruptError
    from mocapress.source import JSON_SUFFIXES, MCZ

    given = open_models(models or [])
    files = plan(
        find(named(inputs), (".mcz", *JSON_SUFFIXES)),
        output,
        _original_name,
        force=force,
        json=json,
        reads=models or [],
        skip=skip_existing,
        update=update,
        parents=parents,
    )

    def hinted(source: "Source", restored: "Callable[[], Iterable[T]]") -> "Iterator[T]":
        try:
            yield from restored()
        except CorruptError as error:
            if not salvage and source.kind == MCZ:
                error.what += " (--salvage restores what is left)"
            raise

    def work(job: "Job") -> dict[str, Any]:
        assert job.target is not None
        source = job.opened(limit)
        places = places_for(job, given)
        long = None if salvage else api.restored_long(source, places)
        if long is not None:
            size, parts = long
            job.outputs[job.target] = hinted(source, lambda: parts)
            whole = True
        else:
            (restored,) = hinted(source, lambda: [api.restore(source, places, salvage=salvage)])
            size = len(restored.data)
            job.outputs[job.target] = restored.data
            if with_asf and job.target != STREAM:
                for companion in restored.companions:
                    job.outputs[job.target.with_suffix(f".{companion.format}")] = companion.data
            whole = len(job.outputs) == 1 + len(restored.companions) and not restored.damage
        job.remove = remove and whole
        kept = "not removed, as it holds more than was restored (see --with-asf)"
        return {
            "warning": kept if remove and not whole else None,
            "output": str(job.target),
            "raw_bytes": size,
            "compressed_bytes": source.size,
        }

    run(
        files,
        work,
        threads=jobs,
        json=json,
        show=show_sizes,
        total=show_total,
        quiet=quiet,
        verbose=verbose,
        debug=debug,
    )


def _original_name(source: Path) -> Path:
    from mocapress.container import diffma_json
    from mocapress.errors import MocapressError, ParameterError

    if source.suffix.lower() == ".mcz":
        named = source.with_name(source.name[:-4])
        return named if named.suffix else named.with_suffix(_original_suffix(source))
    stem = diffma_json.stem(source.name)
    if stem == source.name:
        raise ParameterError(
            "cannot tell the output's name; -o gives it", file=str(source), expected="NAME.mcz"
        )
    try:
        return source.with_name(f"{stem}.{diffma_json.format_of(source.read_bytes())}")
    except MocapressError as error:
        error.file = str(source)
        raise


def _original_suffix(packed: Path) -> str:
    """Give the suffix of the original's name, if the file can be read that far and knows it."""
    from mocapress.container import open_mcz
    from mocapress.errors import MocapressError
    from mocapress.source import Source

    if not packed.is_file():  # a pipe can be read only once
        return ""
    try:
        original = open_mcz(Source(packed), salvage=True).original
    except (MocapressError, OSError):
        return ""
    suffix = Path(original.name).suffix if original else ""
    return suffix if suffix[1:].isalnum() else ""
