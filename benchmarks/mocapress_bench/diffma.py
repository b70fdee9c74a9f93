"""``mocapress bench diffma``: the evaluation of the paper (section 3.4) and of our extensions."""

import json
import lzma
import os
import shutil
import subprocess
from collections.abc import Callable, Iterable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from time import perf_counter, thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress import api
from mocapress.codecs.diffma import DiffMA
from mocapress.codecs.diffma.allocation import psnr
from mocapress.codecs.diffma.codec import by_channel
from mocapress.codecs.diffma.document import read_document
from mocapress.container.diffma_json import clip_to_json
from mocapress.errors import MocapressError
from mocapress.motion import Clip

Row = dict[str, Any]

BOUNDS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
TARGET_PSNR = 40.0
# Errors in the units of the file, degrees or lengths.
LARGEST_ERRORS = (0.1, 0.01)
ZFP_TOLERANCE = 0.125
DECODER = Path(__file__).parents[2] / "viewer/diffma/diffma.js"

_SPEED_IN_JAVASCRIPT = """
import { readFileSync } from "node:fs";
const { decode } = await import(process.argv[1]);
const text = readFileSync(0, "utf8");
const started = performance.now();
const document = JSON.parse(text);
const parsed = performance.now() - started;
let best = Infinity;
for (let i = 0; i < 9; i++) {
  const begin = performance.now();
  decode(document);
  best = Math.min(best, performance.now() - begin);
}
console.log(JSON.stringify([parsed / 1e3, best / 1e3]));
"""


def contenders() -> dict[str, DiffMA]:
    """Give the codecs that are measured, by name."""
    found = {f"β = {bound:g}": DiffMA(bound=bound) for bound in BOUNDS}
    target = DiffMA(target_psnr=TARGET_PSNR)
    own = replace(target, per="channel")
    found |= {
        "one β for 40 dB": target,
        "own β for 40 dB": own,
        "own β and order for 40 dB": replace(own, order="auto"),
        "own β for 40 dB, window 128": replace(own, window=128),
        "β = 4, order 1": DiffMA(order="1"),
        "β = 4, own order": DiffMA(order="auto"),
    }
    for error in LARGEST_ERRORS:
        found[f"error ≤ {error:g}, β = 4"] = DiffMA(max_error=error)
        found[f"error ≤ {error:g}, own β"] = DiffMA(max_error=error, per="channel")
    return found


def measure(
    paths: Iterable[Path], root: Path, *, progress: Callable[[str], None] = lambda _: None
) -> tuple[list[Row], list[str]]:
    """Measure clips; give one row per clip and contender, and what could not be measured."""
    rows, notes = [], []
    codecs = contenders()
    for path in paths:
        name = str(path.relative_to(root))
        progress(name)
        try:
            clip = replace(api.read(path), skeleton=None)
        except MocapressError as error:
            notes.append(f"left out, cannot be read: {error}")
            continue
        if not clip.values.size:
            continue
        shape = {"clip": name, "frames": clip.frames, "channels": clip.channels}
        rows += [shape | {"codec": key} | _row(clip, codec) for key, codec in codecs.items()]
        text = path.read_bytes()
        own = {"error": 0.0, "bits": 8 * len(text), "packed_bits": 8 * _packed(text)}
        rows.append(shape | {"codec": "the file"} | _rates(own, clip))
        zfp = _zfp(clip)
        if zfp is None:
            notes.append("not installed: zfpy")
        else:
            rows.append(shape | {"codec": f"zfp {ZFP_TOLERANCE}"} | zfp)
    return rows, list(dict.fromkeys(notes))


def speed(path: Path, repeat: int = 5) -> dict[str, float]:
    """Measure the speed on one clip, million samples per second: the best of several runs.

    For one core, time is processor time, which other processes do not lengthen.
    """
    clip = api.read(path)
    channels = np.tile(by_channel(clip.values), (1, max(1, 2_000_000 // clip.values.size)))
    codec, frames = DiffMA(), channels.shape[1]
    plans = codec.plan(clip.main)
    records = codec.coding.encode(channels, plans)
    text = clip_to_json(clip.with_frames(channels.T, clip.frame_time), codec)
    found = {
        "encode, 1 core": _best(
            lambda: [codec.coding.encode(c[None], plans[:1]) for c in channels],
            repeat,
            thread_time,
        ),
        "decode, 1 core": _best(
            lambda: [codec.coding.decode([r], plans[:1], frames) for r in records],
            repeat,
            thread_time,
        ),
        f"encode, {os.cpu_count()} cores": _best(
            lambda: codec.coding.encode(channels, plans), repeat
        ),
        f"decode, {os.cpu_count()} cores": _best(
            lambda: codec.coding.decode(records, plans, frames), repeat
        ),
        "read JSON, 1 core": _best(lambda: read_document(text), repeat, thread_time),
    }
    node = shutil.which("node")
    if node is not None and DECODER.exists():
        done = subprocess.run(  # noqa: S603
            [node, "--input-type=module", "-e", _SPEED_IN_JAVASCRIPT, DECODER.as_uri()],
            input=text,
            capture_output=True,
            check=True,
        )
        found["JSON.parse, JavaScript"], found["decode, JavaScript"] = json.loads(done.stdout)
    return {what: channels.size / seconds / 1e6 for what, seconds in found.items()}


def _row(clip: Clip, codec: DiffMA) -> Row:
    text = clip_to_json(clip, codec)
    document = read_document(text)
    error = document.decode() - clip.values
    orders = [plan.order for plan in document.plans]
    return _rates(
        {
            "error": float(np.square(error).sum()),
            "bits": 8 * len(text),
            "packed_bits": 8 * _packed(text),
        },
        clip,
    ) | {
        "largest_error": float(np.abs(error).max()),
        "bound": float(np.mean([plan.bound for plan in document.plans])),
        "predicted": sum(order > 0 for order in orders) / len(orders),
    }


def _rates(sums: dict[str, float], clip: Clip) -> Row:
    samples = clip.values.size
    return {
        "psnr": psnr(sums["error"], samples),
        "bits": sums["bits"] / samples,
        "packed_bits": sums["packed_bits"] / samples,
    }


def _packed(data: bytes) -> int:
    return len(lzma.compress(data))


def _zfp(clip: Clip) -> Row | None:
    """Code the (F, C) matrix as single-precision floats, as the paper does."""
    try:
        zfpy: Any = import_module("zfpy")
    except ImportError:
        return None
    values = clip.values.astype(np.float32)
    packed: bytes = zfpy.compress_numpy(values, tolerance=ZFP_TOLERANCE)
    decoded: NDArray[np.float32] = zfpy.decompress_numpy(packed)
    error = decoded.astype(np.float64) - clip.values
    sums = {"bits": 8 * len(packed), "packed_bits": 8 * _packed(packed)}
    return _rates(sums | {"error": float(np.square(error).sum())}, clip) | {
        "largest_error": float(np.abs(error).max())
    }


def _best(
    work: Callable[[], object], repeat: int, clock: Callable[[], float] = perf_counter
) -> float:
    times = []
    for _ in range(repeat):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)
