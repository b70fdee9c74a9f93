"""``convert``."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import api
from mocapress.cli.batch import STREAM, Job, Outcome, find, opened, run, target, usage
from mocapress.cli.models import open_models
from mocapress.container import diffma_json
from mocapress.errors import UnsupportedError
from mocapress.formats import Format, by_name, readable, suffixes, writable
from mocapress.models import Place
from mocapress.motion import Clip
from mocapress.motion.convert import with_rate
from mocapress.source import MCZ, Source


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
    target_format = _target(to, output)
    files = find(inputs, suffixes(of for of in readable() if of is not target_format))
    given = open_models(models)

    def rename(source: Path) -> Path:
        packed = source.suffix.lower() == ".mcz"
        name = diffma_json.stem(source.stem if packed else source.name)
        kept = Path(name).stem if packed or name == source.name else name
        return source.with_name(f"{kept}{target_format.suffixes[0]}")

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, rename, many=len(files) > 1)
        source = opened(job)
        clip = _read(source, asf, given, strict=strict)
        clip = with_rate(clip, fps, needed=target_format.timed)
        result = {
            "output": str(place),
            "frames": clip.frames,
            "skeleton": clip.metadata.get("skeleton"),
            "skeleton_found": clip.metadata.get("skeleton_found"),
        }
        if place == STREAM:
            sys.stdout.buffer.write(next(iter(api.printed(clip, target_format).values())))
        else:
            place.parent.mkdir(parents=True, exist_ok=True)
            api.write(clip, place, to=target_format.id, force=force)
        return result

    run(files, work, threads=jobs, json=json, show=_show)


def _target(to: str | None, output: Path | None) -> Format:
    known = [of for of in writable() if to is None or of.id == to]
    named = by_name(output.name) if output else None
    found = (known[0] if known else None) if to else named
    if found is None or found not in known:
        ids = ", ".join(of.id for of in writable())
        usage(f"say what to convert to: --to ({ids}), or an output with the ending of one of these")
    return found


def _read(source: Source, asf: Path | None, models: Sequence[Place], *, strict: bool) -> Clip:
    if source.kind == MCZ:
        clip = api.load_source(source, asf_path=asf, models=models, strict=strict)
    else:
        clip = api.read_source(source, asf, strict=strict)
    if clip.skeleton is None:
        raise UnsupportedError(
            "no skeleton", file=source.name or None, expected="one beside it, or --asf"
        )
    return clip


def _show(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        if outcome.result["output"] != str(STREAM):
            print(f"{outcome.result['output']}: {outcome.result['frames']} frames")
