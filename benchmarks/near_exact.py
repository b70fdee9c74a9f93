"""What it would cost to have `near` first and exactness on top, in one file.

    python benchmarks/near_exact.py CORPUS/amc/cmu [--clips 01_01,16_15,49_02]

The bytes of `near` are well spent only as far as its values make the exact numbers cheaper. How
much that is at best is measured by two predictions of every number, the same but for `near`:
recursive least squares on the eight numbers before it and on what three channels before it do in
this frame and did in the last, without and with the values of `near` in five frames around. Both
are charged for what they miss by an adaptive Laplace distribution on the grid of the printed
numbers. What a file of both costs beyond `exact` is the bytes of `near`, less those that its values
save.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]
_PAST, _BESIDE, _AROUND = 8, 3, 2
_FADE = 0.998
_DIGITS = 6
"""Significant ones, of CMU's numbers."""


def missed(values: Array, near: Array | None) -> Array:
    """Give by how much the prediction of each of (F, C) values is off."""
    frames, channels = values.shape
    count = _PAST + 2 * _BESIDE + (2 * _AROUND + 1 if near is not None else 0)
    shares = np.zeros((channels, count))
    inverse = np.tile(np.eye(count) * 1e2, (channels, 1, 1))
    steps = np.diff(values, axis=0, prepend=values[:1])
    errors = np.zeros_like(values)
    for f in range(frames):
        features = np.zeros((channels, count))
        for k in range(1, min(_PAST, f) + 1):
            features[:, k - 1] = steps[f - k]
        for k in range(1, _BESIDE + 1):
            features[k:, _PAST + 2 * k - 2] = steps[f, :-k]
            features[k:, _PAST + 2 * k - 1] = steps[f - 1, :-k] if f else 0
        before = values[f - 1] if f else np.zeros(channels)
        if near is not None:
            for k in range(-_AROUND, _AROUND + 1):
                features[:, k - _AROUND - 1] = near[min(max(f + k, 0), frames - 1)] - before
        target = values[f] - before
        errors[f] = target - (shares * features).sum(axis=1)
        gains = np.einsum("cij,cj->ci", inverse, features)
        gains /= (_FADE + (features * gains).sum(axis=1))[:, None]
        shares += gains * errors[f][:, None]
        inverse -= np.einsum("ci,cj->cij", gains, np.einsum("cij,ci->cj", inverse, features))
        inverse /= _FADE
        inverse = (inverse + inverse.transpose(0, 2, 1)) / 2
        traces = np.trace(inverse, axis1=1, axis2=2)
        inverse[traces > 1e6] *= 0.1
    return errors


def bits(errors: Array, grid: Array) -> float:
    """Give what errors cost by Laplace distributions as wide as errors were lately."""
    width = np.full(errors.shape[1], 1.0)
    total = 0.0
    for error, step in zip(np.abs(errors), grid, strict=True):
        wide = np.maximum(width, step / 3)
        total += float((np.log2(2 * wide / step) + error / wide / np.log(2)).clip(0.05).sum())
        width = np.maximum(0.95 * width + 0.05 * np.minimum(error, 100 * wide), 1e-9)
    return total


def rows_of(path: Path, bounds: Sequence[str]) -> list[list[str]]:
    """Give the figures of a clip at each bound."""
    clip = mp.read(path)
    moves = (clip.values != clip.values[0]).any(axis=0)
    values = clip.values[:, moves]
    exponents = np.floor(np.log10(np.maximum(np.abs(values), 1e-3)))
    grid = 10.0 ** (exponents + 1 - _DIGITS)
    exact = mp.codec("exact").encode(clip.main, skeleton=clip.skeleton)
    size = len(exact.header) + sum(len(chunk.payload) for chunk in exact.chunks)
    alone = bits(missed(values, None), grid) / 8
    rows = []
    for bound in bounds:
        codec = mp.codec(f"near:max={bound}")
        made = codec.encode(clip.main, skeleton=clip.skeleton)
        first = len(made.header) + sum(len(chunk.payload) for chunk in made.chunks)
        decoded = codec.decode(made.header, made.chunks, clip.columns)[:, moves]
        saved = alone - bits(missed(values, decoded), grid) / 8
        more = (first - saved) / size
        cells = [path.stem, f"{size}", f"{alone:.0f}", bound, f"{first}", f"{saved:.0f}"]
        rows.append([*cells, f"{100 * more:.1f} %"])
    return rows


def main(argv: Sequence[str] | None = None) -> None:
    """Measure, and print a row for each clip and bound."""
    parser = argparse.ArgumentParser()
    parser.add_argument("corpus", type=Path)
    parser.add_argument("--clips", default="01_01,16_15,49_02")
    parser.add_argument("--max", default="2cm,0.5cm,0.1cm,0.02cm")
    told = parser.parse_args(argv)
    head = ["clip", "`exact`", "prediction alone", "max", "`near`", "saved", "more than `exact`"]
    rows = []
    for name in told.clips.split(","):
        rows += rows_of(next(told.corpus.rglob(f"{name}.amc")), told.max.split(","))
    print(markdown(head, rows), end="")


if __name__ == "__main__":
    main()
