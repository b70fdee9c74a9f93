"""``convert``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import api, convert
from mocapress.cli.batch import STREAM, Job, Outcome, find, run, target, usage
from mocapress.errors import UnsupportedError
from mocapress.formats.files import format_clip


def convert_files(
    inputs: Sequence[Path],
    output: Path | None,
    to: str | None,
    *,
    asf: Path | None,
    fps: float | None,
    jobs: int,
    force: bool,
    json: bool,
) -> None:
    """Convert files; ``.mcz`` files are taken, too."""
    if to is None and output is not None and output.suffix.lower() in (".bvh", ".amc"):
        to = output.suffix.lower()[1:]
    if to is None:
        usage("say what to convert to: --to, or an output that ends in .bvh or .amc")
        return
    files = find(inputs, (".amc",) if to == "bvh" else (".bvh",))
    if any(job.source == STREAM for job in files):
        usage("convert reads files, not stdin")

    def rename(source: Path) -> Path:
        stem = source.with_suffix("") if source.suffix.lower() == ".mcz" else source
        return stem.with_suffix(f".{to}")

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, rename, many=len(files) > 1)
        compressed = job.source.suffix.lower() == ".mcz"
        clip = (api.load if compressed else api.read)(job.source, asf_path=asf)
        if clip.skeleton is None:
            raise UnsupportedError(
                "no skeleton", file=str(job.source), expected="an ASF beside it, or --asf"
            )
        warning = None
        if to == "bvh":
            if clip.frame_time is None and fps is None:
                warning = f"an AMC does not say its frame rate; taken as {convert.DEFAULT_FPS:g}"
            clip = convert.to_bvh_clip(clip, fps)
        result = {"output": str(place), "frames": clip.frames, "warning": warning}
        if place == STREAM:
            made = clip if to == "bvh" else convert.to_amc_clip(clip)
            print(format_clip(made, to).decode("latin-1"), end="")
        else:
            place.parent.mkdir(parents=True, exist_ok=True)
            api.write(clip, place, force=force)
        return result

    def show(outcomes: list[Outcome]) -> None:
        for outcome in outcomes:
            if outcome.result["output"] != str(STREAM):
                print(f"{outcome.result['output']}: {outcome.result['frames']} frames")

    run(files, work, threads=jobs, json=json, show=show)
