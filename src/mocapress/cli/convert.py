"""``convert``."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import api
from mocapress.cli.batch import STREAM, Job, Outcome, find, run, target, usage
from mocapress.cli.models import open_models
from mocapress.container import diffma_json
from mocapress.errors import ParameterError, UnsupportedError
from mocapress.formats.files import format_clip
from mocapress.models import Place
from mocapress.motion import Clip, convert


def convert_files(
    inputs: Sequence[Path],
    output: Path | None,
    to: str | None,
    *,
    asf: Path | None,
    models: Sequence[Path],
    fps: float | None,
    strict: bool,
    jobs: int,
    force: bool,
    json: bool,
) -> None:
    """Convert files; ``.mcz`` and DiffMA JSON are taken, too."""
    to = to or _kind_of(output)
    files = find(inputs, (".amc",) if to == "bvh" else (".bvh",))
    given = open_models(models)

    def rename(source: Path) -> Path:
        packed = source.suffix.lower() == ".mcz"
        name = diffma_json.stem(source.stem if packed else source.name)
        return source.with_name(
            f"{Path(name).stem if packed or name == source.name else name}.{to}"
        )

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, rename, many=len(files) > 1)
        clip = _read(job.source, asf, given, strict=strict)
        warning = None
        if to == "bvh":
            if clip.frame_time is None and fps is None:
                warning = f"an AMC does not say its frame rate; taken as {convert.DEFAULT_FPS:g}"
            clip = convert.to_bvh_clip(clip, fps)
        result = {"output": str(place), "frames": clip.frames, "warning": warning}
        if place == STREAM:
            made = clip if to == "bvh" else convert.to_amc_clip(clip)
            sys.stdout.buffer.write(format_clip(made, to))
        else:
            place.parent.mkdir(parents=True, exist_ok=True)
            api.write(clip, place, force=force)
        return result

    run(files, work, threads=jobs, json=json, show=_show)


def _kind_of(output: Path | None) -> str:
    kind = output.suffix.lower()[1:] if output else ""
    if kind not in ("bvh", "amc"):
        usage("say what to convert to: --to, or an output that ends in .bvh or .amc")
    return kind


def _read(source: Path, asf: Path | None, models: Sequence[Place], *, strict: bool) -> Clip:
    if source == STREAM:
        raise ParameterError("convert reads files, not stdin")
    if source.suffix.lower() == ".mcz":
        clip = api.load(source, asf_path=asf, models=models, strict=strict)
    else:
        clip = api.read(source, asf_path=asf, strict=strict)
    if clip.skeleton is None:
        raise UnsupportedError(
            "no skeleton", file=str(source), expected="an ASF beside it, or --asf"
        )
    return clip


def _show(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        if outcome.result["output"] != str(STREAM):
            print(f"{outcome.result['output']}: {outcome.result['frames']} frames")
