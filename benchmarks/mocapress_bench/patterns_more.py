"""More of the codec ``patterns``: lengths of bones, its root, other clips, and pictures."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import codecs
from mocapress.motion import Clip
from mocapress_bench import patterns_rivals as rivals
from mocapress_bench.patterns import (
    MarkerSet,
    Row,
    arms_of,
    at_arms,
    distances,
    of_codec,
    of_places,
    row_of,
    text_of,
)

Array = NDArray[np.float64]
_MOMENTS = 6
_SECONDS = 12.0


def decoded_by(data: MarkerSet, spec: str) -> tuple[Clip, dict[str, float]]:
    """Code and decode a set; what the codec measures comes with it."""
    codec = codecs.codec(spec)
    encoded = codec.encode(data.clip.main)
    values = codec.decode(encoded.header, encoded.chunks, data.clip.columns)
    stream = replace(data.clip.main, values=values)
    clip = Clip({"points": stream})
    return clip, codec.measure(clip, encoded, 0)


def bone_lengths(data: MarkerSet, spec: str) -> Iterator[Row]:
    """Measure how far distances that stay in a set are off, before and after they are kept."""
    decoded, _ = decoded_by(data, spec)
    known = mp.bones(data.clip)
    ways = {
        "as decoded": decoded,
        "constant, mean lengths of what was decoded": mp.constant_lengths(decoded),
        "constant, mean lengths of the original": mp.constant_lengths(decoded, known),
    }
    for name, clip in ways.items():
        drift = np.abs(mp.bone_drift(data.clip, clip, known))
        spread = float(np.mean([bone.spread for bone in mp.bones(clip)]))
        yield {
            "lengths": name,
            "bones": float(len(known)),
            "off on average, mm": float(np.nanmean(drift)),
            "99 %": float(np.nanpercentile(drift, 99)),
            "largest": float(np.nanmax(drift)),
            "spread, mm": spread,
            "ARMS, mm": arms_of(distances(data.values, clip.values)),
        }


def roots(data: MarkerSet, spec: str) -> Iterator[Row]:
    """Set the root's cosines beside its absolute coordinates, as Fig. 7 codes them.

    The paper does not say how these are entropy coded; here they are rounded so that the error is
    the same, and take the entropy of the differences from frame to frame.
    """
    decoded, facts = decoded_by(data, spec)
    labels = [column.name.rpartition(".")[0] for column in data.clip.columns[::3]]
    errors = decoded.values - data.values
    places = errors.reshape(len(errors), -1, 3)
    root = int(np.sqrt((places**2).mean(axis=(0, 2))).argmin())
    error = float(np.sqrt((places[:, root] ** 2).mean()))
    step = error * np.sqrt(12)
    own = data.values[:, 3 * root : 3 * root + 3]
    bits = 0.0
    for column in np.rint(own / step).T:
        _, counts = np.unique(np.diff(column), return_counts=True)
        share = counts / counts.sum()
        bits += float(-(counts * np.log2(share)).sum())
    yield {
        "root": f"cosines, marker {labels[root]}",
        "bytes": facts["root_bytes"],
        "error, mm": error,
    }
    yield {"root": "every frame, entropy of differences", "bytes": bits / 8, "error, mm": error}


def seen(path: Path) -> MarkerSet:
    """Give the markers of a C3D that are there in all frames, in mm."""
    found = mp.markers(mp.read(path))
    kept = np.flatnonzero(found.valid.all(axis=0)).tolist()
    scale = {"m": 1000.0, "cm": 10.0}.get(found.unit, 1.0)
    labels = [f"{i} {found.labels[i].rpartition(':')[2]}" for i in kept]
    return of_places(path.stem, found.positions[:, kept] * scale, labels)


def brief(data: MarkerSet, target: float) -> Iterator[Row]:
    """Measure the codec and plain transform coding on a set that nothing was chosen by."""
    text = len(text_of(data.values))
    yield of_codec(data, text, f"patterns:arms={target:g}", f"{data.name}: patterns")
    for name, way in (("DCT", rivals.dct), ("KLT and DCT", rivals.klt_dct)):
        yield row_of(f"{data.name}: {name}", data, text, *at_arms(way, data, target))


def draw(data: MarkerSet, spec: str, folder: Path) -> Sequence[Path]:
    """Draw markers' ways over time, and frames side by side: original and decoded."""
    from matplotlib.figure import Figure

    decoded, facts = decoded_by(data, spec)
    rate = float(data.clip.fps or 120)
    shown = slice(0, int(_SECONDS * rate))
    away = distances(data.values, decoded.values).mean(axis=0)
    chosen = np.argsort(away)[[0, len(away) // 2, -1]].tolist()
    labels = [column.name.rpartition(".")[0] for column in data.clip.columns[::3]]
    figure = Figure(figsize=(11, 6), layout="constrained")
    for axes, marker in zip(figure.subplots(3, 1, sharex=True), chosen, strict=True):
        for axis, colour in zip(range(3), ("tab:red", "tab:green", "tab:blue"), strict=True):
            column = 3 * marker + axis
            seconds = np.arange(len(data.values[shown])) / rate
            axes.plot(seconds, data.values[shown, column], color=colour, alpha=0.35, linewidth=3)
            axes.plot(seconds, decoded.values[shown, column], color=colour, linewidth=0.8)
        axes.set_ylabel("mm")
        axes.set_title(f"{labels[marker]}: off by {away[marker]:.1f} mm on average", fontsize=9)
    axes.set_xlabel("s; broad: original, thin: decoded; x red, y green, z blue")
    ways = folder / f"{_file(data.name)}_ways.png"
    figure.savefig(ways, dpi=90)

    tied = mp.bones(data.clip)
    figure = Figure(figsize=(11, 5), layout="constrained")
    grid = figure.subplots(2, _MOMENTS)
    frames = np.linspace(0, len(data.values) - 1, _MOMENTS + 2).astype(int)[1:-1]
    up = _up(data)
    for row, (name, clip) in enumerate((("original", data.clip), ("decoded", decoded))):
        for axes, frame in zip(grid[row], frames.tolist(), strict=True):
            places = clip.values[frame].reshape(-1, 3)
            across = 0 if up != 0 else 1
            for bone in tied:
                ends = places[[bone.near, bone.far]]
                axes.plot(ends[:, across], ends[:, up], color="0.6", linewidth=1)
            axes.plot(places[:, across], places[:, up], ".", markersize=4)
            middle = data.values[frame].reshape(-1, 3).mean(axis=0)
            axes.set_xlim(middle[across] - 900, middle[across] + 900)
            axes.set_ylim(middle[up] - 1200, middle[up] + 1200)
            axes.set_aspect("equal")
            axes.set_axis_off()
            axes.set_title(f"{name}, frame {frame}", fontsize=8)
    figure.suptitle(f"{data.name}, ARMS {facts['arms']:.2f} mm", fontsize=10)
    beside = folder / f"{_file(data.name)}_frames.png"
    figure.savefig(beside, dpi=90)
    return ways, beside


def _up(data: MarkerSet) -> int:
    """Give the axis along which markers differ most in height while they stay: y or z."""
    places = data.values.reshape(len(data.values), -1, 3)
    heights = places.mean(axis=0).std(axis=0)
    return 1 if heights[1] > heights[2] else 2


def _file(name: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in name.lower())
