"""``mocapress bench lossless``: every clip, with every lossless codec and tool."""

import hashlib
import os
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from mocapress.api import Opened
from mocapress.api.compressing import motion_file, smallest, unfit
from mocapress.api.encoding import CodedStream
from mocapress.api.restoring import layout_of
from mocapress.codecs import Chunk, Codec, Model
from mocapress.container import StreamHead
from mocapress.errors import FormatError
from mocapress.formats.layout import Layout
from mocapress.models import model_bytes
from mocapress.source import Source
from mocapress_bench.contenders import Tool, contenders
from mocapress_bench.learning import Learned
from mocapress_bench.rivals import Rival

Row = dict[str, Any]
T = TypeVar("T")


@contextmanager
def _on_one_processor() -> Iterator[None]:
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    usual = os.sched_getaffinity(0)
    # Several processes that measure on one machine take different ones.
    os.sched_setaffinity(0, {sorted(usual)[os.getpid() % len(usual)]})
    try:
        yield
    finally:
        os.sched_setaffinity(0, usual)


@_on_one_processor()
def measure(
    paths: Iterable[Path],
    root: Path,
    *,
    only: str = "",
    learned: Iterable[Learned] = (),
    repeat: int = 1,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[list[Row], list[str]]:
    """Measure clips; give one row per clip and contender, and what could not be measured.

    Times are the best of ``repeat``. ``encode_us_per_frame`` and ``decode_us_per_frame`` are the
    codec's own work on the matrix (a tool's: its work on the file); ``compress_s`` and
    ``decompress_s`` are the whole way from file bytes to file bytes. ``counts`` says what
    ``compressed_bytes`` counts: the ``file``, or only its ``values``, without the text around
    them. A codec's file is as ``compress`` makes it: a small one may be that of a general-purpose
    compressor, while the times are still the codec's. ``model_bytes`` is the size of a model's
    file, counted once for all clips that share it. Where the system can hold a process to one
    processor, everything runs on one.
    """
    chosen, missing = contenders(only)
    notes = [f"not installed: {name}" for name in missing]
    rows: list[Row] = []
    counted: set[tuple[str, bytes]] = set()
    for path in paths:
        progress(str(path.relative_to(root)))
        data = path.read_bytes()
        clip_row: Row = {"clip": str(path.relative_to(root)), "raw_bytes": len(data)}
        try:
            clip_row |= _shape(data, path)
            clip_rows = []
            for name, contender in chosen.items():
                if isinstance(contender, Tool):
                    row = _tool_row(data, contender, repeat, clip_row["frames"])
                elif isinstance(contender, Rival):
                    row = _rival_row(data, path, contender, repeat)
                else:
                    row = _codec_row(data, path, contender, repeat)
                clip_rows.append(row | {"codec": name})
            for one in learned:
                model = one.models[path]
                row = _codec_row(data, path, one.codec, repeat, model) | {"codec": one.name}
                if (one.name, model.digest) not in counted:
                    counted.add((one.name, model.digest))
                    row["model_bytes"] = len(model_bytes(model))
                clip_rows.append(row)
        except FormatError as error:
            notes.append(f"left out, cannot be read: {error}")
            continue
        rows += [clip_row | row for row in clip_rows]
    return rows, notes


def peak_memory(path: Path, contender: str) -> dict[str, float]:
    """Measure in a separate process how much memory compressing and restoring a file adds, MB."""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "mocapress_bench.peak", str(path), contender],
        capture_output=True,
        text=True,
        check=True,
    )
    before, after = (float(word) for word in done.stdout.split())
    return {"peak_mb": after - before}


def _shape(data: bytes, path: Path) -> Row:
    source = Source(data, str(path))
    parts = source.split()
    if len(parts.clip.streams) > 1 or parts.stored is not None:
        raise FormatError(
            "not rows of channels alone; benchmarks/markers.py measures such files",
            file=str(path),
            expected="AMC or BVH",
            found=source.kind,
        )
    return {"format": source.kind, "frames": parts.clip.frames, "channels": parts.clip.channels}


def _codec_row(
    data: bytes, path: Path, codec: Codec, repeat: int, model: Model | None = None
) -> Row:
    source = Source(path)
    parts, split_s = _best(source.split, repeat)
    clip = parts.clip
    encoded, encode_s = _best(
        lambda: codec.encode(clip.main, skeleton=clip.skeleton, model=model), repeat
    )
    blob, pack_s = _best(
        lambda: motion_file(
            parts,
            Source(data, path.name),
            [CodedStream(codec, encoded)],
            model,
            with_skeleton=source.used is None,
        ),
        repeat,
    )
    kept = smallest(source, parts, None if unfit(parts, len(data)) else blob, codec)
    (layout, chunks, head), open_s = _best(lambda: _open(blob), repeat)
    values, decode_s = _best(
        lambda: codec.decode(head.header, chunks, head.columns, model=model), repeat
    )
    restored, join_s = _best(lambda: layout.join(values), repeat)
    payload = sum(len(chunk.payload) for chunk in encoded.chunks) if kept is blob else 0
    frames = max(clip.frames, 1)
    return {
        "counts": "file",
        "compressed_bytes": len(kept),
        "payload_bytes": payload,
        "index_bytes": encoded.index_bytes,
        "model_bytes": 0,
        "header_bytes": len(kept) - payload,
        "encode_us_per_frame": 1e6 * encode_s / frames,
        "decode_us_per_frame": 1e6 * decode_s / frames,
        "compress_s": split_s + encode_s + pack_s,
        "decompress_s": open_s + decode_s + join_s,
        **_proof(data, restored),
    }


def _open(blob: bytes) -> tuple[Layout, tuple[Chunk, ...], StreamHead]:
    """Read all of a file that decoding and printing need."""
    opened = Opened(Source(blob))
    original = opened.mcz.original
    assert original is not None
    return layout_of(opened, original, opened.mcz.frames()), opened.coded(), opened.streams[0]


def _rival_row(data: bytes, path: Path, rival: Rival, repeat: int) -> Row:
    (clip, layout, *_), split_s = _best(lambda: Source(data, str(path)).split(), repeat)
    packed, encode_s = _best(lambda: rival.compress(clip.values), repeat)
    values, decode_s = _best(lambda: rival.decompress(packed, (clip.frames, clip.channels)), repeat)
    restored, join_s = _best(lambda: layout.join(values), repeat)
    frames = max(clip.frames, 1)
    return {
        "counts": "values",
        "compressed_bytes": len(packed),
        "payload_bytes": len(packed),
        "index_bytes": 0,
        "model_bytes": 0,
        "header_bytes": 0,
        "encode_us_per_frame": 1e6 * encode_s / frames,
        "decode_us_per_frame": 1e6 * decode_s / frames,
        "compress_s": split_s + encode_s,
        "decompress_s": decode_s + join_s,
        **_proof(data, restored),
    }


def _tool_row(data: bytes, tool: Tool, repeat: int, frames: int) -> Row:
    packed, compress_s = _best(lambda: tool.compress(data), repeat)
    restored, decompress_s = _best(lambda: tool.decompress(packed), repeat)
    return {
        "counts": "file",
        "compressed_bytes": len(packed),
        "payload_bytes": len(packed),
        "index_bytes": 0,
        "model_bytes": 0,
        "header_bytes": 0,
        "encode_us_per_frame": 1e6 * compress_s / max(frames, 1),
        "decode_us_per_frame": 1e6 * decompress_s / max(frames, 1),
        "compress_s": compress_s,
        "decompress_s": decompress_s,
        **_proof(data, restored),
    }


def _proof(data: bytes, restored: bytes) -> Row:
    digest = hashlib.sha256(restored).hexdigest()
    return {"exact": digest == hashlib.sha256(data).hexdigest(), "sha256": digest}


def _best(work: Callable[[], T], repeat: int) -> tuple[T, float]:
    times = []
    for _ in range(repeat):
        start = perf_counter()
        result = work()
        times.append(perf_counter() - start)
    return result, float(np.min(times))
