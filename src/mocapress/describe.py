"""What ``mocapress info`` says of a clip or a ``.mcz`` file."""

from pathlib import Path
from typing import Any

from mocapress import api, codecs
from mocapress.codecs import Encoded
from mocapress.container import Kind, parse
from mocapress.convert import suggest_unit
from mocapress.model import Clip


def describe_file(path: Path, *, asf_path: Path | None = None) -> dict[str, Any]:
    """Describe a motion file."""
    clip = api.read(path, asf_path=asf_path)
    return {"bytes": path.stat().st_size, "format": path.suffix.lower()[1:]} | describe_clip(clip)


def describe_clip(clip: Clip) -> dict[str, Any]:
    """Describe a clip: size, timing, skeleton and number formats."""
    skeleton, seconds = clip.skeleton, None
    if clip.frame_time:
        seconds = float(clip.frame_time * clip.frames)
    kinds = {
        f"{column.decimal.kind.name.lower()} {column.decimal.digits}"
        for column in clip.columns
        if column.decimal
    }
    return {
        "frames": clip.frames,
        "channels": clip.channels,
        "frame_time": None if clip.frame_time is None else str(clip.frame_time),
        "seconds": seconds,
        "joints": len(skeleton.joints) if skeleton else None,
        "number_formats": ", ".join(sorted(kinds)) or None,
        "unit_suggested": (suggest_unit(skeleton) or "nothing usual") if skeleton else None,
    }


def describe_mcz(blob: bytes, *, asf_path: Path | None = None) -> dict[str, Any]:
    """Describe a ``.mcz`` file: what it holds, and where its bytes go.

    Of codecs that measure themselves, the measures follow: MCR, TCR and APE of APP (Eqs. 11-13).
    """
    mcz = parse(blob)
    payloads = sum(entry.length for entry in mcz.index)
    facts: dict[str, Any] = {
        "format": mcz.kind.name.lower(),
        "codec": mcz.codec or "general-purpose",
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
    clip = api.load(blob, asf_path=asf_path)
    facts |= describe_clip(clip)
    if clip.frames and clip.channels:
        facts["bits_per_sample"] = 8 * len(blob) / (clip.frames * clip.channels)
    measure = getattr(codecs.codec(mcz.codec), "measure", None)
    if measure is not None:
        encoded = Encoded(mcz.codec_header, api.chunks_of(mcz))
        facts |= measure(clip, encoded, mcz.size)
    return facts
