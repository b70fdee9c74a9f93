"""``train``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.options import Debug, Force, Inputs, Json

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mocapress.cli.batch import Job
    from mocapress.motion import Clip


def train(
    inputs: Inputs,
    output: Annotated[
        str, typer.Option("-o", "--output", help="File for the model.", metavar="FILE.mcm")
    ],
    codec: Annotated[
        str | None,
        typer.Option(
            "--codec",
            help="Codec that learns, e.g. exact:level=6; by default exact. Without a level, the "
            "strongest, 9; at levels 1 to 5 exact learns nothing.",
        ),
    ] = None,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Learn a model from clips, to compress similar clips with compress --model."""
    from mocapress import api, codecs, models
    from mocapress.cli.batch import STREAM, Job, find, run, usage
    from mocapress.cli.report import say
    from mocapress.cli.targets import known_endings, refuse_other_kinds, refuse_sources
    from mocapress.errors import MocapressError, ParameterError
    from mocapress.formats import readable, suffixes
    from mocapress.source import Source

    try:
        made = codecs.codec_for(codec or codecs.DEFAULT_CODEC, None)
    except ParameterError as error:
        usage(f"--codec: {error}")
    clips_named = [job.source for job in find(inputs, (*suffixes(readable()), ".mcz"))]
    target = Path(output)
    if STREAM in (*clips_named, target):
        usage("train reads and writes files, not stdin and stdout")
    refuse_other_kinds(output, (".mcm",), known_endings())
    model_job = Job(target, target.parent, target=target, force=force)
    refuse_sources([model_job], clips_named)
    if not made.learns:
        say(f"warning: {codecs.spec(made)} learns nothing from other clips")
    learned = {"clips": 0, "frames": 0}

    def clips() -> "Iterator[Clip]":
        for path in clips_named:
            try:
                clip = api.read_source(Source(path))
            except (MocapressError, OSError) as error:
                left_out = f"{path}: {error.strerror}" if isinstance(error, OSError) else error
                say(f"warning: left out: {left_out}")
                continue
            learned["clips"] += 1
            learned["frames"] += clip.frames
            yield clip

    def work(job: "Job") -> dict[str, Any]:
        model = models.train(clips(), made)
        data = models.model_bytes(model)
        job.outputs[target] = data
        return learned | {"bytes": len(data), "sha256": model.digest.hex()}

    run([model_job], work, json=json, show=_show, debug=debug)


def _show(job: "Job") -> None:
    made = job.result
    print(
        f"{job.source}: {made['bytes']} bytes, learned from {made['clips']} clips, "
        f"{made['frames']} frames"
    )
