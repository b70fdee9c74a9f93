"""``convert``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.options import (
    Asf,
    Debug,
    Force,
    Inputs,
    Jobs,
    Json,
    Lenient,
    Limit,
    Models,
    Output,
    Quiet,
)
from mocapress.cli.selecting import Columns, Every, Frames, Resample, Retime, Selection, Time

if TYPE_CHECKING:
    from mocapress.cli.batch import Job
    from mocapress.formats import Format
    from mocapress.source import Source


def _formats(begun: str) -> list[str]:
    """Give the formats that begin so, for completion in a shell."""
    from mocapress.formats import writable

    return [of.id for of in writable() if of.id.startswith(begun)]


def convert(
    inputs: Inputs,
    output: Output = None,
    to: Annotated[
        str | None,
        typer.Option(
            "--to",
            help="Format, e.g. bvh or amc; by default the output's suffix says it. A GLB takes "
            "options: glb:max=0.1cm,unit=cm.",
            autocompletion=_formats,
        ),
    ] = None,
    asf: Asf = None,
    models: Models = None,
    limit: Limit = None,
    frames: Frames = None,
    time: Time = None,
    every: Every = None,
    resample: Resample = None,
    retime: Retime = None,
    columns: Columns = None,
    fps: Annotated[
        float | None,
        typer.Option("--fps", help="Frames per second of files that do not state them.", min=1e-3),
    ] = None,
    constant: Annotated[
        bool,
        typer.Option(
            "--constant-lengths",
            help="Move markers a little, so that distances that a body keeps stay the same: for "
            "what a lossy codec has moved.",
        ),
    ] = False,
    lenient: Lenient = False,
    jobs: Jobs = 1,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Convert between AMC, BVH, C3D, GLB and TRC, or write CSV, NPZ or Parquet.

    Nothing is rescaled, but that a GLB has metres.
    """
    from mocapress import api
    from mocapress.cli.batch import STREAM, find, run, usage
    from mocapress.cli.models import open_models, places_for
    from mocapress.cli.targets import known_endings, plan, refuse_other_kinds
    from mocapress.container import diffma_json
    from mocapress.formats import by_id, readable, suffixes, writable
    from mocapress.motion.convert import with_rate
    from mocapress.motion.lengths import constant_lengths
    from mocapress.storage import is_stream

    wanted = Selection(frames, time, every, resample, retime, fps, columns)
    made = _format(to, output)
    refuse_other_kinds(output, made.suffixes, known_endings())
    if columns is not None and not made.any_columns:
        tables = ", ".join(of.id for of in writable() if of.any_columns)
        usage(f"--columns: {made.name} is no table; those are {tables}")
    given = open_models(models or [])

    def rename(source: Path) -> Path:
        packed = source.suffix.lower() == ".mcz"
        name = diffma_json.stem(source.stem if packed else source.name)
        kept = Path(name).stem if packed or name == source.name else name
        return source.with_name(f"{kept}{made.suffixes[0]}")

    files = plan(
        find(inputs, suffixes(of for of in readable() if of.id != made.id)),
        output,
        rename,
        force=force,
        json=json,
        reads=[asf, *(models or [])],
    )
    for file in files:
        file.times = False  # what is written is new
        file.beside = by_id(made.companion).suffixes[:1] if made.companion else ()

    def work(job: "Job") -> dict[str, Any]:
        assert job.target is not None
        source = job.opened(limit)
        places = places_for(job, given)
        clip = api.read_source(source, asf, models=places, strict=not lenient)
        clip = constant_lengths(clip) if constant else clip
        clip = with_rate(wanted.of(clip), needed=made.timed)
        job.outputs |= api.printed(clip, made, job.target)
        if job.target == STREAM or is_stream(job.target):  # which has nothing beside it
            job.outputs = {job.target: job.outputs[job.target]}
        _keep_skeleton(job, source)
        return {
            "output": str(job.target),
            "frames": clip.frames,
            "skeleton": clip.metadata.get("skeleton"),
            "skeleton_found": clip.metadata.get("skeleton_found"),
        }

    run(files, work, threads=jobs, json=json, show=_show, quiet=quiet, debug=debug)


def _format(to: str | None, output: str | None) -> "Format":
    from mocapress.cli.batch import usage
    from mocapress.formats import configured, for_writing, writable

    known = {of.id: of for of in writable()}
    if to and to.partition(":")[0] in known:
        return configured(to)
    found = for_writing(output) if output and not to else None
    if found is None:
        ids = ", ".join(known)
        usage(f"say what to convert to: --to ({ids}), or an output with the ending of one of these")
    return found


def _keep_skeleton(job: "Job", source: "Source") -> None:
    """Refuse to replace the skeleton that the clip was read with, as it says more than ours."""
    from mocapress.errors import ParameterError

    for path in job.outputs:
        used = source.used and Path(source.used.file)
        if used and used.exists() and path.exists() and path.samefile(used):
            raise ParameterError(
                f"{path} would replace the skeleton that this was read with",
                expected="another output: -o",
            )


def _show(job: "Job") -> None:
    if str(job.target) != "-":
        print(f"{job.target}: {job.result['frames']} frames")
