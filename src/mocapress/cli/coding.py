"""``compress``, ``decompress`` and ``verify``."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Any

from mocapress import api, codecs
from mocapress.cli.batch import STREAM, Job, Outcome, contents, find, run, target, usage
from mocapress.cli.models import open_model, open_models, places_for
from mocapress.codecs import Codec
from mocapress.codecs.diffma import DiffMA
from mocapress.container import diffma_json
from mocapress.errors import ParameterError
from mocapress.formats.asf import parse_asf
from mocapress.formats.files import find_asf, sniff
from mocapress.storage import write_whole

_MOTION = (".amc", ".bvh", ".asf")
_COMPRESSED = (".mcz", *diffma_json.SUFFIXES)


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
    files = find(inputs, _MOTION[:2] if isinstance(made, DiffMA) else _MOTION)

    def work(job: Job) -> dict[str, Any]:
        place = target(job, output, partial(_compressed_name, to=to), many=len(files) > 1)
        data = contents(job.source)
        name = str(job.source) if job.source != STREAM else ""
        beside = asf
        if beside is None and job.source != STREAM and sniff(data, job.source.name) == "amc":
            beside = find_asf(job.source)
        skeleton = beside.read_bytes() if beside else b""
        warning, loss = None, None
        if to == "mcz":
            compressed = api.compress_bytes(
                data,
                made,
                name=name,
                asf_data=skeleton,
                embed_asf=embed_asf,
                model=learned,
            )
            blob, warning, loss = compressed.blob, compressed.warning, compressed.loss
        else:
            assert isinstance(made, DiffMA)
            joints = parse_asf(skeleton, str(beside)) if skeleton else None
            text = diffma_json.file_to_json(data, made, name=name, skeleton=joints)
            blob = diffma_json.named(to, text)
        _put(place, blob, force=force)
        return {
            "output": str(place),
            "raw_bytes": len(data),
            "compressed_bytes": len(blob),
            "ratio": round(len(data) / len(blob), 3),
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
        blob, many = contents(job.source), len(files) > 1
        if diffma_json.is_json(blob, job.source.name):
            kind, data = diffma_json.json_to_file(blob)
            place = target(job, output, partial(_original_name, kind=kind), many=many)
        else:
            place = target(job, output, partial(_original_name, kind=""), many=many)
            data = api.decompress(blob, models=places_for(job, given))
        _put(place, data, force=force)
        return {"output": str(place), "raw_bytes": len(data), "compressed_bytes": len(blob)}

    run(files, work, threads=jobs, json=json, show=_show_sizes)


def verify_files(inputs: Sequence[Path], *, models: Sequence[Path], jobs: int, json: bool) -> None:
    """Decode files and compare digests."""
    files, given = find(inputs, _COMPRESSED), open_models(models)

    def work(job: Job) -> dict[str, Any]:
        data = contents(job.source)
        if diffma_json.is_json(data, job.source.name):  # a layout is not needed to be sound
            return {"raw_bytes": diffma_json.json_to_clip(data).values.nbytes, "ok": True}
        restored = api.decompress(data, models=places_for(job, given))
        return {"raw_bytes": len(restored), "ok": True}

    def show(outcomes: list[Outcome]) -> None:
        for outcome in outcomes:
            print(f"{outcome.source}: {outcome.result['raw_bytes']} bytes, ok")

    run(files, work, threads=jobs, json=json, show=show, failure_code=3)


def _kind_of(output: Path | None) -> str:
    name = output.name.lower() if output else ""
    return next((s[1:] for s in reversed(diffma_json.SUFFIXES) if name.endswith(s)), "mcz")


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
