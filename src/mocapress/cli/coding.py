"""``compress``, ``decompress`` and ``verify``."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Any

from mocapress import api, codecs
from mocapress.cli.batch import STREAM, Job, Outcome, find, opened, run, target, usage
from mocapress.cli.models import open_model, open_models, places_for
from mocapress.codecs import Codec
from mocapress.codecs.diffma import DiffMA
from mocapress.container import diffma_json
from mocapress.errors import ParameterError
from mocapress.formats import formats, suffixes
from mocapress.source import DIFFMA_JSON, JSON_SUFFIXES
from mocapress.storage import write_whole

_COMPRESSED = (".mcz", *JSON_SUFFIXES)


def compress_files(
    inputs: Sequence[Path],
    output: Path | None,
    codec: str | None,
    *,
    to: str | None,
    level: int | None,
    model: Path | None,
    target_psnr: float | None,
    asf: Path | None,
    embed_asf: bool,
    jobs: int,
    force: bool,
    json: bool,
) -> None:
    """Compress files."""
    learned = open_model(model) if model else None
    to = to or _kind_of(output)
    try:
        made = codecs.codec(codec or (codecs.DEFAULT_CODEC if to == "mcz" else "diffma"))
        if level is not None:
            made = codecs.with_level(made, level)
        if learned is not None:
            codecs.learner(made, learned)
        made = _aimed(made, target_psnr)
        if to != "mcz" and not isinstance(made, DiffMA):
            raise ParameterError(f"{made.id} makes no {to}", expected="diffma")
    except ParameterError as error:
        usage(f"--codec: {error}")
    kinds = [of for of in formats() if of.split or (of.read_skeleton and made.lossless)]
    files = find(inputs, suffixes(kinds))

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, partial(_compressed_name, to=to), many=len(files) > 1)
        source = opened(job)
        warning, loss = None, None
        if to == "mcz":
            compressed = api.compress_source(
                source, made, asf_path=asf, embed_asf=embed_asf, model=learned
            )
            blob, warning, loss = compressed.blob, compressed.warning, compressed.loss
        else:
            assert isinstance(made, DiffMA)
            blob = diffma_json.named(to, diffma_json.file_to_json(source, made, asf_path=asf))
        _put(place, blob, force=force)
        return {
            "output": str(place),
            "raw_bytes": source.size,
            "compressed_bytes": len(blob),
            "ratio": round(source.size / len(blob), 3),
            "largest_error": loss.most if loss else None,
            "psnr": loss.psnr if loss and isfinite(loss.psnr) else None,
            "warning": warning,
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
    files, given = find(inputs, _COMPRESSED), open_models(models)

    def work(job: Job) -> dict[str, Any]:
        source, many = opened(job), len(files) > 1
        if source.kind == DIFFMA_JSON:
            kind, data = diffma_json.json_to_file(source.data)
            place = target(job, output, partial(_original_name, kind=kind), many=many)
        else:
            place = target(job, output, partial(_original_name, kind=""), many=many)
            data = api.decompress(source, models=places_for(job, given))
        _put(place, data, force=force)
        return {"output": str(place), "raw_bytes": len(data), "compressed_bytes": source.size}

    run(files, work, threads=jobs, json=json, show=_show_sizes)


def verify_files(inputs: Sequence[Path], *, models: Sequence[Path], jobs: int, json: bool) -> None:
    """Decode files and compare digests."""
    files, given = find(inputs, _COMPRESSED), open_models(models)

    def work(job: Job) -> dict[str, Any]:
        source = opened(job)
        if source.kind == DIFFMA_JSON:  # a layout is not needed to be sound
            return {"raw_bytes": diffma_json.json_to_clip(source.data).values.nbytes, "ok": True}
        restored = api.decompress(source, models=places_for(job, given))
        return {"raw_bytes": len(restored), "ok": True}

    def show(outcomes: list[Outcome]) -> None:
        for outcome in outcomes:
            print(f"{outcome.source}: {outcome.result['raw_bytes']} bytes, ok")

    run(files, work, threads=jobs, json=json, show=show, failure_code=3)


def _kind_of(output: Path | None) -> str:
    name = output.name.lower() if output else ""
    return next((s[1:] for s in reversed(JSON_SUFFIXES) if name.endswith(s)), "mcz")


def _aimed(codec: Codec, target_psnr: float | None) -> Codec:
    if target_psnr is None:
        return codec
    if not isinstance(codec, DiffMA):
        raise ParameterError("--target-psnr is for a lossy codec", expected="diffma")
    return replace(codec, target_psnr=target_psnr)


def _compressed_name(source: Path, to: str) -> Path:
    name = source.name if to == "mcz" else source.stem
    return source.with_name(f"{name}.{to}")


def _original_name(source: Path, kind: str) -> Path:
    if kind and diffma_json.stem(source.name) != source.name:
        return source.with_name(f"{diffma_json.stem(source.name)}.{kind}")
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
        lost = outcome.result.get("largest_error")
        errors = "" if lost is None else f", errors up to {lost:.3g}"
        print(f"{outcome.result['output']}: {raw} <-> {small} bytes, {raw / small:.2f} : 1{errors}")
    if len(outcomes) > 1:
        raw = sum(outcome.result["raw_bytes"] for outcome in outcomes)
        small = sum(outcome.result["compressed_bytes"] for outcome in outcomes)
        print(f"{len(outcomes)} files: {raw} <-> {small} bytes, {raw / small:.2f} : 1")
