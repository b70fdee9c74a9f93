"""What ``mocapress info`` says of a clip or a ``.mcz`` file."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mocapress import api, codecs
from mocapress.codecs import Encoded, Model
from mocapress.container import Kind, diffma_json, parse
from mocapress.errors import MissingModelError
from mocapress.models import Place, find_model
from mocapress.motion import Clip
from mocapress.motion.convert import suggest_unit
from mocapress.restore import chunks_of, load, load_source
from mocapress.source import Source


def describe_file(
    source: Source, *, asf_path: Path | None = None, strict: bool = True
) -> dict[str, Any]:
    """Describe a motion file."""
    clip = api.read_source(source, asf_path, strict=strict)
    return {"bytes": source.size, "format": source.kind} | describe_clip(clip)


def describe_clip(clip: Clip, frames: int | None = None) -> dict[str, Any]:
    """Describe a clip of so many frames (None: its own): size, timing, skeleton, number formats."""
    skeleton, seconds = clip.skeleton, None
    frames = clip.frames if frames is None else frames
    if clip.frame_time:
        seconds = float(clip.frame_time * frames)
    kinds = {
        f"{column.decimal.kind.name.lower()} {column.decimal.digits}"
        for column in clip.columns
        if column.decimal
    }
    return {
        "frames": frames,
        "channels": clip.channels,
        "frame_time": None if clip.frame_time is None else str(clip.frame_time),
        "seconds": seconds,
        "joints": len(skeleton.joints) if skeleton else None,
        "skeleton": clip.metadata.get("skeleton"),
        "skeleton_found": clip.metadata.get("skeleton_found"),
        "number_formats": ", ".join(sorted(kinds)) or None,
        "unit_suggested": (suggest_unit(skeleton) or "nothing usual") if skeleton else None,
    }


def describe_model(model: Model, size: int) -> dict[str, Any]:
    """Describe a model, of a file of ``size`` bytes."""
    return {
        "format": "mcm",
        "codec": model.codec,
        "bytes": size,
        "payload_bytes": len(model.payload),
        "sha256": model.digest.hex(),
    }


def describe_json(blob: bytes) -> dict[str, Any]:
    """Describe a DiffMA JSON, packed or not."""
    document = diffma_json.open_json(blob)
    clip = diffma_json.json_to_clip(blob)
    bounds = sorted({plan.bound for plan in document.plans})
    orders = sorted({plan.order for plan in document.plans})
    facts: dict[str, Any] = {
        "format": "diffma.json",
        "compressed_bytes": len(blob),
        "bits": document.coding.bits,
        "window": document.coding.window,
        "bounds": " to ".join(f"{bound:g}" for bound in dict.fromkeys(bounds[:1] + bounds[-1:])),
        "orders": ", ".join(map(str, orders)),
        "levels": ", ".join(f"{level.bound:g}" for level in document.levels) or None,
        "layout_bytes": len(document.layout) or None,
    }
    facts |= describe_clip(clip)
    if clip.values.size:
        facts["bits_per_sample"] = 8 * len(blob) / clip.values.size
    return facts


def describe_mcz(
    source: Source,
    *,
    asf_path: Path | None = None,
    models: Sequence[Place] = (),
    strict: bool = True,
) -> dict[str, Any]:
    """Describe a ``.mcz`` file: what it holds, and where its bytes go.

    Of codecs that measure themselves, the measures follow: MCR, TCR and APE of APP (Eqs. 11-13).
    A file whose model is missing is described without these.
    """
    blob = source.data
    mcz = parse(blob)
    payloads = sum(entry.length for entry in mcz.index)
    facts: dict[str, Any] = {
        "format": mcz.kind.name.lower(),
        "codec": mcz.codec or "general-purpose",
        "model": mcz.model.hex() or None,
        "model_found": _found(mcz.model, models) if mcz.model else None,
        "raw_bytes": mcz.size,
        "compressed_bytes": len(blob),
        "ratio": mcz.size / len(blob),
        "payload_bytes": payloads,
        "layout_bytes": len(mcz.layout),
        "skeleton_bytes": len(mcz.skeleton) or None,
        "chunks": len(mcz.index),
        "sha256": mcz.digest.hex(),
    }
    if mcz.kind is Kind.BYTES:
        return facts
    columns = load_source(source, slice(0), asf_path=asf_path, strict=strict)
    facts |= describe_clip(columns, mcz.frames)
    if mcz.frames and mcz.columns:
        facts["bits_per_sample"] = 8 * len(blob) / (mcz.frames * mcz.columns)
    codec = codecs.codec(mcz.codec)
    if codec.can.measured and facts["model_found"] is not False:
        clip = columns.with_frames(load(blob, models=models).values, columns.frame_time)
        facts |= codec.measure(clip, Encoded(mcz.codec_header, chunks_of(mcz)), mcz.size)
    return facts


def _found(digest: bytes, models: Sequence[Place]) -> bool:
    try:
        find_model(digest, models)
    except MissingModelError:
        return False
    return True
