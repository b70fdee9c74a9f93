"""``train``, and the models that other commands are given."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import typer

from mocapress import codecs
from mocapress.cli.batch import STREAM, Job, Outcome, find, run, usage
from mocapress.codecs import DEFAULT_CODEC, Model
from mocapress.errors import FormatError, MocapressError, ParameterError
from mocapress.formats import readable, suffixes
from mocapress.models import Place, load_model, model_bytes, save_model, train
from mocapress.motion import Clip
from mocapress.source import Source, read


def open_model(path: Path) -> Model:
    """Read a model that was named; end where that fails."""
    try:
        return load_model(path)
    except (MocapressError, OSError) as error:
        text = f"{path}: {error.strerror}" if isinstance(error, OSError) else error
        typer.echo(f"mocapress: {text}", err=True)
        raise typer.Exit(1) from error


def open_models(paths: Sequence[Path]) -> list[Place]:
    """Read the models that were named, once for all files; folders stay folders."""
    return [path if path.is_dir() else open_model(path) for path in paths]


def places_for(job: Job, given: Sequence[Place]) -> list[Place]:
    """Say where the model of a job's file may be: given, or beside the file."""
    return [*given] if job.source == STREAM else [*given, job.source.parent]


def train_model(
    inputs: Sequence[Path], output: Path, codec: str | None, *, force: bool, json: bool
) -> None:
    """Learn a model; clips that cannot be read are left out with a warning."""
    try:
        made = codecs.codec(codec or DEFAULT_CODEC)
        codecs.learner(made)
    except ParameterError as error:
        usage(f"--codec: {error}")
    files = [job.source for job in find(inputs, suffixes(readable()))]
    if STREAM in (*files, output):
        usage("train reads and writes files, not stdin and stdout")
    learned = {"clips": 0, "frames": 0}

    def clips() -> Iterator[Clip]:
        for path in files:
            try:
                clip = read(Source(path))
            except FormatError as error:
                typer.echo(f"mocapress: warning: left out: {error}", err=True)
                continue
            learned["clips"] += 1
            learned["frames"] += clip.frames
            yield clip

    def work(_: Job) -> dict[str, Any]:
        model = train(clips(), made)
        output.parent.mkdir(parents=True, exist_ok=True)
        save_model(model, output, force=force)
        return learned | {"bytes": len(model_bytes(model)), "sha256": model.digest.hex()}

    run([Job(output, output.parent)], work, threads=1, json=json, show=_show)


def _show(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        made = outcome.result
        print(
            f"{outcome.source}: {made['bytes']} bytes, learned from {made['clips']} clips, "
            f"{made['frames']} frames"
        )
