"""Learns what coders of `near` begin with, from clips of the CMU database.

    python benchmarks/near_start.py CORPUS/amc/cmu core/near/data

Writes figure_1.txt and start_{fine,middling,coarse}_1.txt, of which the core is built. Of the
subjects of near_acl.tsv, by which `near` is measured, none is learned from.
"""

import argparse
from collections.abc import Iterator, Sequence
from math import gcd, inf, log2
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core
from mocapress.codecs.near.figure import RADIUS, figure_of
from mocapress.codecs.near.goal import Goal, Measure
from mocapress.codecs.near.header import COARSE, STEPS_PER_OCTAVE, joints_of, pack_header
from mocapress.codecs.near.turning import KNOWN, Turning
from mocapress.motion import Clip
from mocapress.motion.units import centimetres_per_unit, figure_size

Values = NDArray[np.float64]

SUBJECTS = ("02", "06", "07", "08", "10", "11", "12", "20", "39", "43", "55", "83")
LONGEST, APART = 350, 700
"""Frames of a window, and from one to the next within a clip."""
STRIDE = 29
"""From one window to the next that is learned from."""
SCALES = {"fine": (0.0085, 0.012), "middling": (0.085, 0.04, 0.28), "coarse": (1.6, 1.1)}
"""Centimetres; windows take them in turn."""
CURVES = {"root": 2, "rhumerus": 4, "lhumerus": 4, "rfemur": 1, "lfemur": 1}
"""Orders of the curves' axes: heading outermost; those that are best for most clips."""
WEIGHTS = {"upperneck": 4.0, "lowerneck": 1.5, "head": 1.3, "lhumerus": 1.2, "rhumerus": 1.2}
GROUP, REACH = 64, 6
SHORT_SPANS = 1.2e-3
"""Of the figure's size: scales at which spans are no longer short."""
SOURCES = 20
WORTH = {"fine": 50, "middling": 200, "coarse": 50}
"""Observations that count as seen."""
CAUTION, ROUNDS = 1 / 800, 3


class Window:
    """Some frames of a clip, and how its curves are measured."""

    def __init__(self, clip: Clip) -> None:
        assert clip.skeleton is not None
        unit = centimetres_per_unit(clip.skeleton)
        assert unit is not None
        self.unit, self.size = unit, figure_size(clip.skeleton)
        self.measure = Measure(
            Goal(True, 1.0, inf, RADIUS / unit, self.size),
            figure_of(clip.skeleton, clip.columns, clip.values),
            clip.columns,
        )
        self.turnings: list[Turning] = []
        named = [(column.joint, column.kind) for column in clip.columns]
        for first, places, axes, *_ in _core.near_turnable(self.measure.core, named):
            order = CURVES.get(clip.columns[first].name.partition(".")[0])
            if order is not None:
                self.turnings.append((first, places, axes, order, 1))
        self.curves = _core.near_turned_measure(self.measure.core, self.turnings)
        self.names = [joint.name for joint in clip.skeleton.joints]
        self.joints = joints_of(clip.columns, clip.skeleton)
        self.values = np.ascontiguousarray(clip.values)
        self.turned = _core.near_turned(self.measure.core, self.values, self.turnings)

    def levers(self) -> Values:
        """Give the logarithms of the channels' levers, (C,); NaN of one that rests."""
        weights = np.array([WEIGHTS.get(name, 1.0) for name in self.names])
        squares = _core.near_levers(self.curves, np.ascontiguousarray(self.turned[::8]), weights)
        moves = (self.turned != self.turned[0]).any(axis=0)
        return np.where(moves & (squares > 1e-8), np.log2(np.maximum(squares, 1e-8)) / 2, np.nan)


def windows(corpus: Path) -> Iterator[Window]:
    """Give what is learned from."""
    for subject in SUBJECTS:
        for path in sorted((corpus / subject).glob("*.amc")):
            clip = mp.read(path)
            if " ".join(column.name for column in clip.columns) != KNOWN:
                continue
            for start in range((clip.frames % APART) // 3, clip.frames, APART):
                if clip.frames - start >= 2 * GROUP:
                    yield Window(clip[start : start + LONGEST])


def mixed(all_windows: Sequence[Window]) -> list[Window]:
    """Give windows in an order in which those of a subject are far apart: the last count most."""
    count = len(all_windows)
    stride = next(each for each in range(STRIDE, STRIDE + count) if gcd(each, count) == 1)
    return [all_windows[i * stride % count] for i in range(count)]


def write(path: Path, numbers: Sequence[float], width: int) -> None:
    """Write numbers parted by commas."""
    lines = [
        ",".join(f"{number:g}" for number in numbers[first : first + width])
        for first in range(0, len(numbers), width)
    ]
    path.write_text(",\n".join(lines) + "\n")
    print(path, len(numbers))


def figure(all_windows: Sequence[Window], folder: Path) -> NDArray[np.int64]:
    """Write the known figure, and give the exponents of its steps."""
    levers = np.nanmean(np.stack([window.levers() for window in all_windows]), axis=0)
    levers = np.where(np.isnan(levers), np.nanmin(levers), levers)
    exponents: NDArray[np.int64] = (
        np.rint(-levers * STEPS_PER_OCTAVE / COARSE).astype(np.int64) * COARSE
    )
    firsts = np.median(np.stack([window.turned[0] for window in all_windows]), axis=0)
    joints = all_windows[0].joints
    numbers: list[float] = [len(exponents)]
    for exponent, joint, first in zip(exponents, joints.of_column, firsts, strict=True):
        numbers += [int(exponent), joint, joints.parents[joint], round(float(first), 2)]
    numbers.append(len(all_windows[0].turnings))
    for turning in all_windows[0].turnings:
        numbers += turning[:4]
    write(folder / "figure_1.txt", numbers, 16)
    return exponents


def sources(window: Window) -> list[list[int]]:
    """Give the columns that foretell each, the nearest first, as docs/format/near.md says."""
    of, parents = window.joints

    def parent(joint: int) -> int:
        return parents[joint] if joint >= 0 else -1

    found = []
    for column, own in enumerate(of):
        above = [own]
        while len(above) < 5:
            above.append(parent(above[-1]))
        beside = {joint for joint in (parent(own), parent(parent(own))) if joint >= 0}
        near = [
            other
            for other in range(column - 1, -1, -1)
            if of[other] == 0 or of[other] in above or parent(of[other]) in beside
        ]
        found.append(near)
    return found


def header_of(window: Window, exponents: NDArray[np.int64], scale: float, start: int) -> bytes:
    """Give the header of a window at a scale in the file's units."""
    relative = scale / window.size
    base = round(log2(scale) * STEPS_PER_OCTAVE)
    return pack_header(
        True,
        relative < SHORT_SPANS,
        (0.0, 0.0),
        6 if relative < 2e-4 else 4,
        [base + int(each) for each in exponents],
        window.joints,
        window.turnings,
        start=start,
        known=True,
    )


def waves_of(
    window: Window, exponents: NDArray[np.int64], scale: float, start: int
) -> Iterator[Values]:
    """Give the waves of moves and averages of spans, (G, 63, 2, C), in steps, as decoded."""
    k, t = np.mgrid[0:GROUP, 0:GROUP]
    cosines = np.sqrt(2 / GROUP) * np.cos(np.pi * k * (2 * t + 1) / (2 * GROUP))
    header = header_of(window, exponents, scale, start)
    _, decoded, _ = _core.near_encode(
        window.measure.core,
        window.curves,
        window.values,
        header,
        scale,
        0.12,
        False,
        np.ones(window.measure.points),
        np.full(window.measure.points, inf),
        np.full(window.values.shape[1], inf),
        np.zeros(window.values.shape, np.uint8),
        0,
    )
    drawn = _core.near_turned(window.measure.core, decoded, window.turnings)
    drawn /= 2.0 ** ((round(log2(scale) * STEPS_PER_OCTAVE) + exponents) / STEPS_PER_OCTAVE)
    frames = len(drawn) // GROUP * GROUP
    triangle = np.array([*range(1, REACH + 2), *range(REACH, 0, -1)]) / (REACH + 1) ** 2
    length = 64 if scale / window.size < SHORT_SPANS else 256
    for first in range(0, frames, length):
        span = drawn[first : min(first + length, frames)]
        before = np.repeat(drawn[[max(0, first - 1)]], REACH, axis=0)
        if first:
            before = drawn[first - REACH : first]
        padded = np.concatenate([before, span, np.repeat(span[-1:], REACH, axis=0)])
        smooth = [weight * padded[i : i + len(span)] for i, weight in enumerate(triangle)]
        averaged = np.sum(smooth, axis=0)
        both = np.stack([span, averaged]).reshape(2, -1, GROUP, span.shape[1])
        yield np.einsum("kt,fgtc->gkfc", cosines[1:], both)


def assumed(
    all_windows: Sequence[Window],
    exponents: NDArray[np.int64],
    scales: Sequence[float],
    start: int,
) -> list[tuple[int, int, float, float, float, float, float]]:
    """Learn how columns foretell each other: see NearLearning."""
    waves: list[Values] = []
    for i, window in enumerate(all_windows):
        scale = scales[i % len(scales)] / window.unit
        waves += waves_of(window, exponents, scale, start)
    whole = np.concatenate(waves)
    moving = (whole[:, :, 0] != 0).any(axis=(0, 1))
    told = []
    for column, near in enumerate(sources(all_windows[0])):
        used = [source for source in near if moving[source]][:SOURCES]
        if not used or not moving[column]:
            continue
        features = whole[:, :, :, used].transpose(0, 1, 3, 2).reshape(*whole.shape[:2], -1)
        wanted = whole[:, :, 0, column]
        shares = np.zeros(features.shape[2])
        products = np.zeros((len(shares), len(shares)))
        # What each source is coarser in steps than the channel is already in the waves.
        for _ in range(ROUNDS):
            rest: Values = np.pad((wanted - features @ shares) ** 2, ((0, 0), (2, 2)))
            size = wanted.shape[1]
            energy = np.sum([rest[:, i : i + size] for i in range(5)], axis=0)
            weights = 1 / (1 + energy / 5)
            weighed = features * weights[:, :, None]
            count = weights.size
            products = np.einsum("gka,gkb->ab", weighed, features, optimize=True) / count
            targets = np.einsum("gka,gk->a", weighed, wanted) / count
            ridge = CAUTION * np.eye(len(shares))
            shares = np.linalg.solve(products + ridge, targets)
        for i, source in enumerate(used):
            one, other = products[2 * i, 2 * i], products[2 * i + 1, 2 * i + 1]
            if min(one, other) < 1e-6:
                continue
            like = products[2 * i, 2 * i + 1] / np.sqrt(one * other)
            pair = (float(shares[2 * i]), float(shares[2 * i + 1]))
            told.append((column, source, *pair, 4 * log2(one), 4 * log2(other), float(like)))
    return sorted(told)


def learned(
    all_windows: Sequence[Window],
    exponents: NDArray[np.int64],
    scales: Sequence[float],
    told: Sequence[tuple[int, int, float, float, float, float, float]],
    worth: int,
) -> bytes:
    """Code the windows one after the other, and give what was learned."""
    learning = _core.NearLearning(told, worth)
    for i, window in enumerate(all_windows):
        scale = scales[i % len(scales)] / window.unit
        header = header_of(window, exponents, scale, 0)
        learning.learn(window.measure.core, window.curves, window.values, header, scale, 0.12)
    return bytes(learning.pack())


def main(argv: Sequence[str] | None = None) -> None:
    """Learn and write."""
    parser = argparse.ArgumentParser()
    parser.add_argument("corpus", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", choices=SCALES, help="this start alone")
    asked = parser.parse_args(argv)
    all_windows = mixed(list(windows(asked.corpus)))
    print(len(all_windows), "windows,", sum(len(each.values) for each in all_windows), "frames")
    exponents = figure(all_windows, asked.folder)
    for start, (name, scales) in enumerate(SCALES.items(), 1):
        if asked.only in (None, name):
            told = assumed(all_windows, exponents, scales, start)
            packed = learned(all_windows, exponents, scales, told, WORTH[name])
            write(asked.folder / f"start_{name}_1.txt", list(packed), 24)


if __name__ == "__main__":
    main()
