"""Measuring the codec ``patterns``: ARMS, distortion of markers, and ratios; and its rivals."""

import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import codecs
from mocapress.errors import MotionWarning
from mocapress.motion import Clip, Column, Stream
from mocapress.motion.kinematics import positions
from mocapress_bench import patterns_rivals as rivals

Array = NDArray[np.float64]
CMU_FRAMES = 12_000
_MILLIMETRES = 25.4 / 0.45
"""In a unit of AMC where the ASF says ``length 0.45``."""


@dataclass(frozen=True, slots=True)
class MarkerSet:
    """Markers that are measured."""

    name: str
    clip: Clip
    clips: tuple[int, ...]
    """Frames of the clips that stand one behind the other in it."""

    @property
    def values(self) -> Array:
        """(F, 3P), mm."""
        return self.clip.values

    def first(self, frames: int) -> "MarkerSet":
        """Give the first frames."""
        own = self.clip[:frames]
        return MarkerSet(f"{self.name}, {frames} frames", own, (own.frames,))


def of_places(
    name: str, places: Array, labels: Sequence[str], clips: Sequence[int] = ()
) -> MarkerSet:
    """Give a set of (F, P, 3) in mm, of one clip or of several."""
    columns = tuple(
        Column(f"{label}.{k}", i, k, "mm") for i, label in enumerate(labels) for k in "xyz"
    )
    flat = places.reshape(len(places), -1)
    return MarkerSet(
        name,
        Clip({"points": Stream(flat, columns, Fraction(1, 120))}),
        tuple(clips) or (len(places),),
    )


def joints_of(path: Path) -> tuple[list[str], Array]:
    """Give names and positions, (F, J, 3) in mm, of the joints of an AMC."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MotionWarning)
        clip = mp.read(path)
    assert clip.skeleton is not None
    return [joint.name for joint in clip.skeleton.joints], positions(clip) * _MILLIMETRES


def cmu(folder: Path, frames: int = CMU_FRAMES) -> MarkerSet:
    """Give the joint positions of a subject's AMC, in mm: the first frames in file-name order."""
    found: list[Array] = []
    labels: list[str] = []
    for path in sorted(folder.glob("*.amc")):
        labels, places = joints_of(path)
        found.append(places)
        if sum(map(len, found)) >= frames:
            break
    sizes = [len(own) for own in found]
    sizes[-1] -= sum(sizes) - frames
    return of_places(f"CMU {folder.name}", np.concatenate(found)[:frames], labels, sizes)


def of_c3d(path: Path) -> MarkerSet:
    """Give the markers of a C3D, without those that no label names."""
    found = mp.markers(mp.read(path))
    named = [i for i, label in enumerate(found.labels) if not label.startswith("*")]
    labels = [found.labels[i].rpartition(":")[2] for i in named]
    return of_places(path.stem[:6], found.positions[:, named], labels)


def text_of(values: Array) -> bytes:
    """Give the source text: every coordinate as ``%.3f`` and a character behind it."""
    return b"".join((" ".join(f"{v:.3f}" for v in row) + "\n").encode() for row in values.tolist())


def distances(values: Array, decoded: Array) -> Array:
    """Give how far markers are off, (F, P)."""
    moved = (decoded - values).reshape(len(values), -1, 3)
    away: Array = np.sqrt((moved * moved).sum(axis=2))
    return away


def arms_of(away: Array) -> float:
    """Give ARMS (Eq. 3)."""
    return float(np.sqrt((away * away).mean(axis=1)).mean())


Row = dict[str, str | float]


def row_of(name: str, data: MarkerSet, text: int, decoded: Array, size: float) -> Row:
    """Give the figures of a way."""
    away = distances(data.values, decoded)
    by_marker = away.mean(axis=0)
    return {
        "way": name,
        "ratio to text": text / size,
        "ratio to float32": 4 * data.values.size / size,
        "ARMS, mm": arms_of(away),
        "best marker": float(by_marker.min()),
        "worst marker": float(by_marker.max()),
        "99 % of frames": float(np.percentile(np.sqrt((away * away).mean(axis=1)), 99)),
        "bytes": size,
    }


def of_codec(data: MarkerSet, text: int, spec: str, name: str = "") -> Row:
    """Measure a codec: header and payloads, and what comes back."""
    codec = codecs.codec(spec)
    start = time.process_time()
    encoded = codec.encode(data.clip.main)
    middle = time.process_time()
    decoded = codec.decode(encoded.header, encoded.chunks, data.clip.columns)
    end = time.process_time()
    header, payload = len(encoded.header), sum(len(chunk.payload) for chunk in encoded.chunks)
    frames = data.clip.frames
    found = codec.measure(data.clip, encoded, text)
    return row_of(name or f"`{spec}`", data, text, decoded, header + payload) | {
        "of which database": found["database_bytes"],
        "lengths, indices": found["length_bytes"] + found["index_bytes"],
        "places": found["place_bytes"],
        "root": found["root_bytes"],
        "encode, s": middle - start,
        "decode, µs/frame": 1e6 * (end - middle) / frames,
    }


def at_arms(
    way: rivals.Way, data: MarkerSet, target: float, first: float = 8.0
) -> tuple[Array, float]:
    """Find the step at which a way has the target ARMS, from below."""
    low, high = 0.0, np.inf
    step, best = first, None
    for _ in range(12):
        decoded, size = way(data.values, step, data.clips)
        if arms_of(distances(data.values, decoded)) <= target:
            low, best = step, (decoded, size)
        else:
            high = step
        step = 2 * step if np.isinf(high) else (low + high) / 2
    assert best is not None
    return best


def compared(
    data: MarkerSet, target: float, progress: Callable[[str], None] = lambda _: None
) -> Iterator[Row]:
    """Measure the codec, as published and past that, and its rivals."""
    text = text_of(data.values)
    size = len(text)
    for spec in (
        f"patterns:arms={target:g}",
        f"patterns:arms={target:g},hierarchy=rigid",
        f"patterns:arms={target:g},rule=pca",
        f"patterns:arms={target:g},mode=published",
        "patterns:mode=published,theta=0.1,cluster=0.01",
        "patterns:mode=published,theta=3.0,rule=ratio",
    ):
        progress(spec)
        yield of_codec(data, size, spec)
    for name, way in (("DCT per coordinate", rivals.dct), ("KLT and DCT", rivals.klt_dct)):
        progress(name)
        yield row_of(f"{name}, at this ARMS", data, size, *at_arms(way, data, target))
    for name, other, parameter in (
        ("global PCA, 95 % of the variance", rivals.global_pca, 0.95),
        ("every 12th frame", rivals.subsampled, 12),
        ("Arikan 2006, bound 0.1", rivals.arikan, 0.1),
        ("Arikan 2006, bound 10", rivals.arikan, 10.0),
    ):
        progress(name)
        yield row_of(name, data, size, *other(data.values, parameter, data.clips))
    progress("xz, zip")
    yield row_of("xz of the text", data, size, data.values, float(rivals.xzipped(text)))
    yield row_of("zip of the text", data, size, data.values, float(rivals.zipped(text)))


def growth(data: MarkerSet, target: float, parts: int = 4) -> Iterator[Row]:
    """Measure how the ratio grows with the frames, and when a part is repeated (Fig. 11)."""
    frames = data.clip.frames // parts
    for i in range(1, parts + 1):
        own = data.first(i * frames)
        yield of_codec(own, len(text_of(own.values)), f"patterns:arms={target:g}", own.name)
    once = data.values[:frames]
    labels = [column.name.rpartition(".")[0] for column in data.clip.columns[::3]]
    for i in range(2, parts + 1):
        again = of_places("", np.tile(once, (i, 1)).reshape(i * frames, -1, 3), labels)
        name = f"{data.name}, the first {frames} frames {i} times"
        yield of_codec(again, len(text_of(again.values)), f"patterns:arms={target:g}", name)


def weighted(data: MarkerSet, marker: str) -> Iterator[Row]:
    """Measure a marker's errors at three weights (Fig. 8)."""
    place = [column.name for column in data.clip.columns[::3]].index(f"{marker}.x")
    for weight in (0.1, 1.0, 10.0):
        codec = codecs.codec(f"patterns:weights={marker}:{weight:g}")
        encoded = codec.encode(data.clip.main)
        decoded = codec.decode(encoded.header, encoded.chunks, data.clip.columns)
        away = distances(data.values, decoded)
        size = len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)
        yield {
            "weight": weight,
            f"error of {marker}, mm": float(away[:, place].mean()),
            "ARMS, mm": arms_of(away),
            "bytes": float(size),
        }


def told(rows: Sequence[Row]) -> str:
    """Give rows as Markdown; the first says what the columns are."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    lines = ["| " + " | ".join(keys) + " |", "|---" + "|---:" * (len(keys) - 1) + "|"]
    for row in rows:
        cells = [row.get(key, "") for key in keys]
        shown = [
            cell if isinstance(cell, str) else f"{cell:.0f}" if cell >= 1000 else f"{cell:.3g}"
            for cell in cells
        ]
        lines.append("| " + " | ".join(shown) + " |")
    return "\n".join(lines) + "\n"
