"""Digests of what codecs make of the golden clips: the same on every machine."""

import hashlib
from pathlib import Path

import mocapress as mp
from mocapress import codecs

GOLDEN = Path(__file__).parents[1] / "golden"
CLIPS = ("v1_walk.amc", "v1_walk.bvh")


def specs() -> list[str]:
    """List the lossless codecs, those with levels at four of them."""
    found = []
    for name in codecs.codec_ids():
        made = codecs.codec(name)
        if made.lossless and made.can.levels:
            found += [f"{name}:level={level}" for level in (1, 5, 6, 9)]
        elif made.lossless:
            found.append(name)
    return found


def golden(spec: str) -> Path:
    """Give the file that holds the digests, once made."""
    return GOLDEN / f"payloads_{spec.replace(':level=', '_level')}.txt"


def digests(spec: str) -> bytes:
    """Give the SHA-256 of header and payloads, a line for each golden clip."""
    lines = []
    for clip in CLIPS:
        read = mp.read(GOLDEN / clip)
        encoded = mp.codec(spec).encode(read.main, skeleton=read.skeleton)
        whole = b"".join([encoded.header, *(chunk.payload for chunk in encoded.chunks)])
        lines.append(f"{hashlib.sha256(whole).hexdigest()}  {clip}\n")
    return "".join(lines).encode()
