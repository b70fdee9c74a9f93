"""What ``mocapress info`` says of a clip or a ``.mcz`` file."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from mocapress import api, codecs
from mocapress.codecs import Encoded, Model
from mocapress.container import diffma_json
from mocapress.errors import MissingModelError
from mocapress.models import Place, find_model
from mocapress.motion import Clip, Stream
from mocapress.motion.figure import doubtful_root, unit_of
from mocapress.motion.markers import (
    ANALOG,
    POINTS,
    ROTATIONS,
    Markers,
    events,
    force_plates,
    markers,
)
from mocapress.source import Source


def describe_file(
    source: Source, *, asf_path: Path | None = None, strict: bool = True
) -> dict[str, Any]:
    """Describe a motion file; of a large one no more is read than that needs, where that can be."""
    of = source.format
    if of is not None and of.outline is not None and source.size >= api.LONG:
        parts = of.outline(source, source.name or None)
        source.accept(parts.problems, strict=strict)
        told = describe_clip(source.described(of, parts.stored, parts.clip), parts.frames[0])
        return {"bytes": source.size, "format": source.kind} | told
    clip = api.read_source(source, asf_path, strict=strict)
    return {"bytes": source.size, "format": source.kind} | describe_clip(clip)


def describe_clip(clip: Clip, frames: int | None = None) -> dict[str, Any]:
    """Describe a clip of so many frames (None: its own): size, timing, skeleton, number formats."""
    skeleton, seconds = clip.skeleton, None
    frames = clip.frames if frames is None else frames
    if clip.frame_time:
        seconds = float(clip.frame_time * frames)
    kinds = {str(column.decimal) for column in clip.columns if column.decimal}
    return {
        "frames": frames,
        "channels": clip.channels,
        "frame_time": None if clip.frame_time is None else str(clip.frame_time),
        "seconds": seconds,
        "joints": len(skeleton.joints) if skeleton else None,
        "skeleton": clip.metadata.get("skeleton"),
        "skeleton_found": clip.metadata.get("skeleton_found"),
        "number_formats": ", ".join(sorted(kinds)) or None,
        "unit_suggested": (unit_of(clip) or "nothing usual") if skeleton else None,
        "root": doubtful_root(clip),
    } | _recorded(clip)


def _recorded(clip: Clip) -> dict[str, Any]:
    """Describe what a laboratory records: markers, and what is measured beside them."""
    facts: dict[str, Any] = {
        name: clip.metadata.get(name) for name in ("vendor", "encoding", "first_frame")
    }
    if POINTS in clip.streams:
        found = markers(clip)
        facts |= {"markers": len(found.labels), "unit": found.unit or None, "rate": found.rate}
        if found.valid.size:
            facts["gaps"] = _gaps(found)
    for name in (ANALOG, ROTATIONS):
        if name in clip.streams:
            facts[name] = _sampled(clip.streams[name], 17 if name == ROTATIONS else 1)
    facts["events"] = len(events(clip)) or None
    facts["force_plates"] = len(force_plates(clip)) or None
    return facts


def _gaps(found: Markers) -> str:
    """Say how much of the markers is missing."""
    missing = ~found.valid
    never = int(missing.all(axis=0).sum())
    some = int(missing.any(axis=0).sum()) - never
    if not some and not never:
        return "none"
    said = f"{100 * float(missing.mean()):.3g} % of the points, {some} markers with gaps"
    return f"{said}, {never} never seen" if never else said


def _sampled(stream: Stream, columns: int) -> str:
    rate = f" at {float(1 / Fraction(stream.frame_time)):.6g} Hz" if stream.frame_time else ""
    return f"{stream.channels // columns}{rate}"


def describe_model(model: Model, size: int) -> dict[str, Any]:
    """Describe a model, of a file of ``size`` bytes."""
    return {
        "format": "mcm",
        "codec": model.codec,
        "bytes": size,
        "payload_bytes": len(model.payload),
        "sha256": model.digest.hex(),
    }


def describe_json(source: Source) -> dict[str, Any]:
    """Describe a DiffMA JSON, packed or not."""
    document = diffma_json.open_json(source.data)
    clip = diffma_json.json_to_clip(source)
    bounds = sorted({plan.bound for plan in document.plans})
    orders = sorted({plan.order for plan in document.plans})
    facts: dict[str, Any] = {
        "format": "diffma.json",
        "lossless": False,
        "compressed_bytes": source.size,
        "bits": document.coding.bits,
        "window": document.coding.window,
        "bounds": " to ".join(f"{bound:g}" for bound in dict.fromkeys(bounds[:1] + bounds[-1:])),
        "orders": ", ".join(map(str, orders)),
        "levels": ", ".join(f"{level.bound:g}" for level in document.levels) or None,
        "layout_bytes": len(document.layout) or None,
    }
    facts |= describe_clip(clip)
    if clip.values.size:
        facts["bits_per_sample"] = 8 * source.size / clip.values.size
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
    opened = api.Opened(source, models)
    mcz, original = opened.mcz, opened.mcz.original
    main = opened.streams[0] if opened.streams else None
    model = main.model if main else b""
    facts: dict[str, Any] = {
        "format": _kind(opened),
        "name": (original.name if original else "") or None,
        "codec": codecs.spec(opened.codec()) if main else "general-purpose",
        "lossless": opened.codec().lossless if main else True,
        "parameters": _parameters(opened.codec()) if main else None,
        "model": model.hex() or None,
        "model_found": _found(model, models) if model else None,
        "raw_bytes": original.size if original else None,
        "compressed_bytes": mcz.size,
        "ratio": original.size / mcz.size if original else None,
        "chunk_bytes": sum(entry.end - entry.begin for entry in mcz.entries) or None,
        "layout_bytes": len(original.packed) if original and original.format else None,
        "companions": ", ".join(companion.name for companion in mcz.companions) or None,
        "chunks": len(mcz.entries),
        "closed": mcz.closed,
        "sha256": original.digest.hex() if original else None,
        "notes": dict(mcz.notes) or None,
    }
    if main is None:
        return facts
    if len(opened.streams) > 1:
        facts["streams"] = {
            stream.name: f"{mcz.frames(index)} x {len(stream.columns)}"
            for index, stream in enumerate(opened.streams)
        }
    frames = mcz.frames()
    columns = api.load_source(source, slice(0), asf_path=asf_path, strict=strict)
    facts |= describe_clip(columns, frames)
    if len(opened.streams) > 1:
        facts |= _recorded(api.columns_of(opened))
    if frames and main.columns:
        facts["bits_per_sample"] = 8 * mcz.size / (frames * len(main.columns))
    codec = opened.codec()
    if original is not None and codec.can.measured and facts["model_found"] is not False:
        clip = columns.with_frames(opened.rows().values, columns.frame_time)
        facts |= codec.measure(clip, Encoded(main.header, opened.coded()), original.size)
    return facts


def _kind(opened: api.Opened) -> str:
    """Give the id of the original's format, or what else a file holds."""
    if opened.mcz.original:
        return opened.mcz.original.format or "bytes"
    return "recording" if any(stream.frames is None for stream in opened.streams) else "clip"


def _parameters(codec: codecs.Codec) -> str | None:
    """Give all parameters of a lossy codec, its bounds among them."""
    if codec.lossless:
        return None
    return ", ".join(f"{name}={value}" for name, value in codecs.parameters(codec).items())


def _found(digest: bytes, models: Sequence[Place]) -> bool:
    try:
        find_model(digest, models)
    except MissingModelError:
        return False
    return True
