"""MRPA on libraries: what each stage finds and brings, and the paper's tables and figures."""

import gzip
import lzma
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress import _core, api, codecs
from mocapress.codecs.mrpa import Thresholds, analyse, coding, forest, paths, som
from mocapress.codecs.mrpa.coding import Parent, Piece
from mocapress.codecs.mrpa.forest import Forest
from mocapress.codecs.mrpa.patterns import Patterns
from mocapress.motion import Clip

Row = dict[str, Any]
Progress = Callable[[str], None]
VALID_PATHS = (10, 20, 30, 40, 50, 55, 60, 70, 80, 90, 100)
LENGTHS = (5, 10, 15, 20, 25, 30, 40, 45, 50)
IOUS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
_INDEX_BYTES = 4
"""Of a frame index; a segment keeps two, and a child that of its parent."""


@dataclass(frozen=True, slots=True, eq=False)
class Library:
    """Clips of the same columns, one behind the other."""

    name: str
    clips: list[Clip]
    files: list[bytes]

    @property
    def size(self) -> int:
        """Bytes of the files."""
        return sum(map(len, self.files))

    @property
    def values(self) -> NDArray[np.float64]:
        """All frames, (F, C)."""
        return np.ascontiguousarray(np.concatenate([clip.values for clip in self.clips]))


def read_library(name: str, files: Sequence[Path]) -> Library:
    """Read the clips of a library."""
    return Library(name, [api.read(file) for file in files], [file.read_bytes() for file in files])


def patterns_of(library: Library, thresholds: Thresholds = Thresholds()) -> Patterns:  # noqa: B008
    """Analyse a library as published."""
    streams = [clip.main for clip in library.clips]
    return analyse(streams, library.clips[0].skeleton, thresholds)


def with_threshold(found: Patterns, **changed: Any) -> Patterns:
    """Give the patterns of the same trellis with another threshold."""
    thresholds = replace(found.thresholds, **changed)
    grown = found.paths
    if "valid_path" in changed:
        grown = paths.grow(found.trellis, thresholds.valid_path)
    return replace(found, paths=grown, thresholds=thresholds)


def without_som(found: Patterns) -> Forest:
    """Build the forest of the evenly cut segments: the variant Non-SOM."""
    even = som.cut_at_clips(som.even_segments(found.paths.h, len(found.clips)), found.clips)
    return forest.build(even, found.paths, found.thresholds.iou)


def published_bytes(
    library: Library, found: Patterns, built: Forest, *, roots: int = coding.PUBLISHED
) -> tuple[int, float, float]:
    """Code a library as the paper does, as one stream, and decode it again.

    Returns
    -------
    tuple
        Bytes with the index, seconds of coding and of decoding.

    """
    values = library.values
    plan = coding.plan_for(values, library.clips[0].columns, None)
    pieces = []
    for segment, (first, last) in enumerate(built.segments.tolist()):
        parent = None
        if built.parents[segment] >= 0:
            parent = Parent(values, forest.alignment(built, found.paths, segment))
        pieces.append(Piece(last + 1 - first, parent))
    table, parents = coding.table_of(pieces, fresh=True), coding.beside(values, pieces)
    begin = time.process_time()
    payload = _core.mrpa_encode(values, parents, table, plan, coding_limit(), roots)
    coded = time.process_time()
    decoded = np.empty_like(values)
    _core.mrpa_decode(payload, decoded, parents, table, plan, coding_limit())
    done = time.process_time()
    if decoded.tobytes() != values.tobytes():
        raise AssertionError(f"{library.name} does not come back")
    index = _INDEX_BYTES * (2 * len(built.segments) + built.index_entries)
    steps = sum(
        len(_core.encode_differences(np.diff(piece.parent.at) - 1))
        for piece in pieces
        if piece.parent is not None
    )
    return len(payload) + index + steps, coded - begin, done - coded


def coding_limit() -> int:
    """Give the mantissa limit: every difference in context, as in the paper's reference [36]."""
    limit: int = codecs.parameters(codecs.codec("mrpa"))["mantissa_limit"]  # type: ignore[assignment]
    return limit


def together_bytes(library: Library, spec: str) -> Row:
    """Code a library by a codec in chunks; bytes with what chunks need, and seconds."""
    made = codecs.codec(spec)
    streams = [clip.main for clip in library.clips]
    begin = time.process_time()
    coded = made.encode_together(streams, skeleton=library.clips[0].skeleton)
    seconds = time.process_time() - begin
    chunks = [chunk for encoded in coded.encoded for chunk in encoded.chunks]
    return {
        "bytes": sum(len(chunk.payload) + 32 * len(chunk.needs) for chunk in chunks),
        "needs": sum(len(chunk.needs) for chunk in chunks),
        "seconds": seconds,
    }


def alone_bytes(library: Library, spec: str) -> Row:
    """Code the clips of a library one by one; bytes, and seconds both ways."""
    made = codecs.codec(spec)
    begin = time.process_time()
    encoded = [made.encode(clip.main, skeleton=clip.skeleton) for clip in library.clips]
    coded = time.process_time()
    for clip, one in zip(library.clips, encoded, strict=True):
        decoded = made.decode(one.header, one.chunks, clip.columns)
        if decoded.tobytes() != np.ascontiguousarray(clip.values).tobytes():
            raise AssertionError(f"{clip.name} does not come back")
    done = time.process_time()
    size = sum(len(chunk.payload) for one in encoded for chunk in one.chunks)
    return {"bytes": size, "seconds": coded - begin, "decode_seconds": done - coded}


def measure_library(library: Library, progress: Progress) -> Row:
    """Measure all schemes of Tables 4 and 5 on a library, and what goes past the paper."""
    progress(library.name)
    size = library.size
    whole = b"".join(library.files)
    begin = time.process_time()
    found = patterns_of(library)
    built = found.forest()
    analysis = time.process_time() - begin
    coded, encode_seconds, decode_seconds = published_bytes(library, found, built)
    with_roots, _, _ = published_bytes(library, found, built, roots=coding.PREVIOUS)
    non_som, _, _ = published_bytes(library, found, without_som(found))
    app = alone_bytes(library, "app")
    in_context = alone_bytes(library, "app:mantissa_limit=53")
    best = together_bytes(library, "mrpa")
    alone = alone_bytes(library, "mrpa")
    frames = len(found.clips)
    ratios = {
        "gzip": len(gzip.compress(whole, 9)),
        "xz": len(lzma.compress(whole, preset=9)),
        "Non-SOM": non_som,
        "APP": app["bytes"],
        "APP, in context": in_context["bytes"],
        "MRPA as published": coded,
        "the same, roots predicted": with_roots,
        "mrpa, no parents": alone["bytes"],
        "mrpa": best["bytes"],
    }
    return {
        "library": library.name,
        "frames": frames,
        "radius": found.trellis.radius,
        "paths": len(found.paths),
        "segments": len(built.segments),
        "predicted frames": built.predicted_frames,
        "index entries": built.index_entries,
        "ratios": {name: size / count for name, count in ratios.items()},
        "needs": best["needs"],
        "µs a frame": {
            "analysis": 1e6 * analysis / frames,
            "coding as published": 1e6 * encode_seconds / frames,
            "decoding as published": 1e6 * decode_seconds / frames,
            "mrpa": 1e6 * best["seconds"] / frames,
            "decoding mrpa alone": 1e6 * alone["decode_seconds"] / frames,
            "APP": 1e6 * app["seconds"] / frames,
            "decoding APP": 1e6 * app["decode_seconds"] / frames,
        },
    }


def sweep(library: Library, progress: Progress) -> dict[str, list[Row]]:
    """Vary each threshold (Figs. 5 to 8, Tables 1 to 3)."""
    base = patterns_of(library)
    rows: dict[str, list[Row]] = {}
    varied: list[tuple[str, Sequence[float]]] = [
        ("valid_path", VALID_PATHS),
        ("length", LENGTHS),
        ("iou", IOUS),
    ]
    for name, values in varied:
        rows[name] = []
        for value in values:
            progress(f"{library.name}, {name} = {value}")
            found = with_threshold(base, **{name: value})
            built = found.forest()
            size, _, _ = published_bytes(library, found, built)
            rows[name].append(
                {
                    name: value,
                    "inputs": len(found.paths),
                    "segments": built.segments.tolist(),
                    "predicted frames": built.predicted_frames,
                    "index entries": built.index_entries,
                    "ratio": library.size / size,
                }
            )
    return rows
