"""``compress``, ``decompress`` and ``verify``."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import api, codecs
from mocapress.cli.batch import STREAM, Job, Outcome, contents, find, run, target, usage
from mocapress.cli.models import open_model, open_models, places_for
from mocapress.errors import ParameterError
from mocapress.files import write_whole
from mocapress.formats.files import find_asf, sniff

_MOTION = (".amc", ".bvh", ".asf")


def compress_files(
    inputs: Sequence[Path],
    output: Path | None,
    codec: str,
    *,
    level: int | None,
    model: Path | None,
    asf: Path | None,
    embed_asf: bool,
    jobs: int,
    force: bool,
    json: bool,
) -> None:
    """Compress files."""
    learned = open_model(model) if model else None
    try:
        made = codecs.codec(codec)
        if level is not None:
            made = codecs.with_level(made, level)
        if learned is not None:
            codecs.learner(made, learned)
    except ParameterError as error:
        usage(f"--codec: {error}")
    files = find(inputs, _MOTION)

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, _compressed_name, many=len(files) > 1)
        data = contents(job.source)
        beside = asf
        if beside is None and job.source != STREAM and sniff(data, job.source.name) == "amc":
            beside = find_asf(job.source)
        compressed = api.compress_bytes(
            data,
            made,
            name=str(job.source) if job.source != STREAM else "",
            asf_data=beside.read_bytes() if beside else b"",
            embed_asf=embed_asf,
            model=learned,
        )
        _put(place, compressed.blob, force=force)
        return {
            "output": str(place),
            "raw_bytes": len(data),
            "compressed_bytes": len(compressed.blob),
            "ratio": round(len(data) / len(compressed.blob), 3),
            "warning": compressed.warning,
        }

    run(files, work, threads=jobs, json=json, show=_show_sizes)


def decompress_files(
    inputs: Sequence[Path],
    output: Path | None,
    *,
    models: Sequence[Path],
    jobs: int,
    force: bool,
    json: bool,
) -> None:
    """Restore files."""
    files, given = find(inputs, (".mcz",)), open_models(models)

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, _original_name, many=len(files) > 1)
        blob = contents(job.source)
        data = api.decompress(blob, models=places_for(job, given))
        _put(place, data, force=force)
        return {"output": str(place), "raw_bytes": len(data), "compressed_bytes": len(blob)}

    run(files, work, threads=jobs, json=json, show=_show_sizes)


def verify_files(inputs: Sequence[Path], *, models: Sequence[Path], jobs: int, json: bool) -> None:
    """Decode files and compare digests."""
    files, given = find(inputs, (".mcz",)), open_models(models)

    def work(job: Job) -> dict[str, Any]:
        data = api.decompress(contents(job.source), models=places_for(job, given))
        return {"raw_bytes": len(data), "ok": True}

    def show(outcomes: list[Outcome]) -> None:
        for outcome in outcomes:
            print(f"{outcome.source}: {outcome.result['raw_bytes']} bytes, ok")

    run(files, work, threads=jobs, json=json, show=show, failure_code=3)


def _compressed_name(source: Path) -> Path:
    return source.with_name(source.name + ".mcz")


def _original_name(source: Path) -> Path:
    if source.suffix.lower() != ".mcz":
        raise ParameterError(
            "cannot tell the output's name; -o gives it", file=str(source), expected="NAME.mcz"
        )
    return source.with_name(source.name[:-4])


def _put(place: Path, data: bytes, *, force: bool) -> None:
    if place == STREAM:
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
    else:
        place.parent.mkdir(parents=True, exist_ok=True)
        write_whole(place, data, force=force)


def _show_sizes(outcomes: list[Outcome]) -> None:
    if outcomes[0].result["output"] == str(STREAM):
        return
    for outcome in outcomes:
        raw, small = outcome.result["raw_bytes"], outcome.result["compressed_bytes"]
        print(f"{outcome.result['output']}: {raw} <-> {small} bytes, {raw / small:.2f} : 1")
    if len(outcomes) > 1:
        raw = sum(outcome.result["raw_bytes"] for outcome in outcomes)
        small = sum(outcome.result["compressed_bytes"] for outcome in outcomes)
        print(f"{len(outcomes)} files: {raw} <-> {small} bytes, {raw / small:.2f} : 1")
