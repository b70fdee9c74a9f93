"""The models that commands are given."""

from collections.abc import Sequence
from pathlib import Path

import typer

from mocapress.cli.batch import STREAM, Job, is_folder
from mocapress.cli.report import message, say
from mocapress.codecs import Model
from mocapress.errors import MocapressError
from mocapress.models import Place, load_model


def open_model(path: Path) -> Model:
    """Read a model that was named; end where that fails."""
    try:
        return load_model(path)
    except (MocapressError, OSError) as error:
        say(message(error, str(path)))
        raise typer.Exit(1) from error


def open_models(paths: Sequence[Path]) -> list[Place]:
    """Read the models that were named, once for all files; folders stay folders."""
    return [path if is_folder(path) else open_model(path) for path in paths]


def places_for(job: Job, given: Sequence[Place]) -> list[Place]:
    """Say where the model of a job's file may be: given, or beside the file."""
    return [*given] if job.source == STREAM else [*given, job.source.parent]
