"""What each way of choosing parents saves on raw takes, beside the best that there could be.

Usage: python benchmarks/mrpa_stages.py FOLDER [FOLDER ...]

Each folder is a library: of its clips with the same columns those that have most frames together,
up to ``MOST_FRAMES``. Pieces of ``PIECE`` frames, evenly spread, are predicted beside a parent of
as many frames that has no frame in common with them. As in ``mrpa``, each column goes on by the
best share of its last step, and takes the best share of its parent off before; a number takes
log2(2 n + 1) bits, n being by how many steps of its last printed digit the prediction is off. What
a parent saves is told in percent of the bits without one, and again less the 32 bytes that name
each parent, where pieces that it does not help have none:

- ``pose``: the stretch of the library whose postures are nearest (Eq. 2), as published;
- ``residual``: whose steps of steps are nearest, each column in units of its own;
- ``prototype``: the mean of the 4 or 16 nearest stretches, so that their noise averages out;
- ``parts``: a parent for each chain of joints by itself;
- ``cycle``: the nearest stretch of the same clip before the piece;
- ``oracle``: of the stretches at every ``STRIDE``-th frame the one that saves most, whatever it
  looks like; of prototypes, the mean of the 8 that save most.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.codecs.mrpa import trellis
from mocapress.motion import Clip
from mocapress.motion.number_format import NumberKind
from mocapress_bench.inputs import clips_in
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]
PIECE, STRIDE, PIECES, MOST_FRAMES = 60, 4, 40, 4000
KNOWN = 2
"""Frames before a piece that its prediction begins with."""
NAME_BITS = 8 * 32
ALPHAS = (0.0, 0.25, 0.5, 0.75, 0.875, 1.0, 1.25)
BETAS = (0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 1.0)
"""Those of core/mrpa/codec.cpp."""
WAYS = (
    "pose", "residual", "prototype of 4 by pose", "prototype of 16 by pose",
    "prototype of 4 by residual", "parts by pose", "parts by residual", "cycle by residual",
    "oracle", "oracle of prototypes", "oracle of parts",
)  # fmt: skip


def library(folder: Path) -> list[Clip]:
    """Give the clips of the columns that most frames have."""
    groups: dict[tuple[str, ...], list[Clip]] = {}
    for path in clips_in(folder):
        clip = mp.read(path, strict=False)
        if clip.skeleton is not None and clip.frames > PIECE + KNOWN:
            groups.setdefault(tuple(c.name for c in clip.columns), []).append(clip)
    if not groups:
        return []
    found = max(groups.values(), key=lambda own: sum(clip.frames for clip in own))
    frames = np.cumsum([clip.frames for clip in found])
    kept = found[: int(np.searchsorted(frames, MOST_FRAMES)) + 1]
    left = MOST_FRAMES - sum(clip.frames for clip in kept[:-1])
    return [*kept[:-1], kept[-1][:left]]


def parts_of(clip: Clip) -> list[list[int]]:
    """Give the columns of each chain of joints from one branch to the next."""
    assert clip.skeleton is not None
    joints = clip.skeleton.joints
    children = [sum(other.parent == j for other in joints) for j in range(len(joints))]
    chain = list(range(len(joints)))
    for j, joint in enumerate(joints):
        if joint.parent >= 0 and children[joint.parent] == 1:
            chain[j] = chain[joint.parent]
    groups: dict[int, list[int]] = {}
    for c, column in enumerate(clip.columns):
        groups.setdefault(chain[column.joint] if column.joint >= 0 else -1, []).append(c)
    return list(groups.values())


def units_of(clip: Clip) -> Array:
    """Give the step of the last printed digit of each number, (F, C)."""
    units = np.empty(clip.values.shape)
    for c, column in enumerate(clip.columns):
        digits = column.decimal.digits if column.decimal else 6
        if column.decimal and column.decimal.kind in (NumberKind.FIXED, NumberKind.TRIMMED):
            units[:, c] = 10.0**-digits
        else:
            magnitude = np.abs(clip.values[:, c])
            units[:, c] = 10.0 ** (np.floor(np.log10(np.maximum(magnitude, 1e-9))) + 1 - digits)
    return units


def guess(rows: Array, alpha: Array | float) -> Array:
    """Predict each frame behind the known ones: the last, and a share of its step."""
    found: Array = rows[1:-1] + alpha * (rows[1:-1] - rows[:-2])
    return found


def step(parent: Array, alpha: Array | float) -> Array:
    """Give what a parent, (PIECE, C), moves in a frame beyond the share of its last step."""
    moved = np.diff(parent, axis=0, prepend=parent[:1])
    before = np.concatenate([np.zeros_like(moved[:1]), moved[:-1]])
    found: Array = moved - alpha * before
    return found


def cost(away: Array, unit: Array) -> Array:
    """Give the ideal bits of each column."""
    found: Array = np.log2(2 * np.rint(np.abs(away) / unit) + 1).sum(axis=0)
    return found


class Pieces:
    """A library, and what parents save on pieces of it."""

    def __init__(self, clips: Sequence[Clip]) -> None:
        self.values = np.ascontiguousarray(np.concatenate([clip.values for clip in clips]))
        self.clips = np.repeat(np.arange(len(clips)), [clip.frames for clip in clips])
        self.parts = parts_of(clips[0])
        self.units = np.concatenate([units_of(clip) for clip in clips])
        weight = trellis.weights(clips[0].columns, clips[0].skeleton)
        self.poses = np.where(np.isfinite(self.values), self.values, 0) * weight
        bends = np.zeros_like(self.values)
        bends[1:-1] = np.diff(self.poses, n=2, axis=0)
        spread = bends.std(axis=0)
        self.bends = bends / np.where(spread > 0, spread, 1)
        same = self.clips[: -PIECE - KNOWN] == self.clips[PIECE + KNOWN :]
        self.inside = np.flatnonzero(same) + KNOWN

    def bits(self, start: int) -> tuple[Array, Array]:
        """Give the bits of each column of a piece without a parent, and the shares of steps."""
        rows, unit = self.piece(start)
        costs = np.stack([cost(rows[KNOWN:] - guess(rows, alpha), unit) for alpha in ALPHAS])
        return costs.min(axis=0), np.array(ALPHAS)[costs.argmin(axis=0)]

    def gains(self, start: int, parent: Array, alone: tuple[Array, Array]) -> Array:
        """Give the bits that each column of a piece saves beside a parent, (PIECE, C)."""
        rows, unit = self.piece(start)
        best, alphas = alone
        tried = [(alphas, beta) for beta in BETAS] + [(alpha, 1.0) for alpha in ALPHAS]
        costs = [
            cost(rows[KNOWN:] - guess(rows, alpha) - beta * step(parent, alpha), unit)
            for alpha, beta in tried
        ]
        found: Array = np.maximum(best - np.min(costs, axis=0), 0)
        return found

    def piece(self, start: int) -> tuple[Array, Array]:
        """Give the frames of a piece with those before it, and the unit of each number."""
        end = start + PIECE
        return self.values[start - KNOWN : end], self.units[start:end]

    def taken(self, at: int) -> Array:
        """Give the stretch that begins at a frame."""
        return self.values[at : at + PIECE]

    def allowed(self, start: int) -> NDArray[np.int64]:
        """Give where stretches begin that have no frame in common with a piece."""
        kept: NDArray[np.int64] = self.inside[np.abs(self.inside - start) >= PIECE]
        return kept

    def apart(self, of: Array, start: int, columns: Sequence[int]) -> Array:
        """Give how far each allowed stretch is from a piece, by the Manhattan distance."""
        rows = of[:, columns].astype(np.float32)
        total = np.zeros(len(self.inside), np.float32)
        for t in range(PIECE):
            total += np.abs(rows[self.inside + t] - rows[start + t]).sum(axis=1)
        found: Array = total[np.abs(self.inside - start) >= PIECE]
        return found


def savings(own: Pieces, progress: Callable[[str], None]) -> tuple[float, dict[str, Array]]:
    """Give the bits of all pieces without parents, and what each way saves: gross and net."""
    whole = list(range(own.values.shape[1]))
    saved = {way: np.zeros(2) for way in WAYS}
    total = 0.0

    def note(way: str, gains: Sequence[float]) -> None:
        saved[way] += sum(gains), sum(max(gain - NAME_BITS, 0) for gain in gains)

    for start in own.inside[np.linspace(0, len(own.inside) - 1, PIECES).astype(int)].tolist():
        progress(f"frame {start}")
        allowed = own.allowed(start)
        if not len(allowed):
            continue

        alone = own.bits(start)
        total += float(alone[0].sum())

        def gain(parent: Array, columns: Sequence[int], start: int = start) -> float:
            return float(own.gains(start, parent, alone)[columns].sum())  # noqa: B023

        for name, of in (("pose", own.poses), ("residual", own.bends)):
            apart = own.apart(of, start, whole)
            order = allowed[np.argsort(apart, kind="stable")]
            note(name, [gain(own.taken(int(order[0])), whole)])
            for count in (4, 16) if name == "pose" else (4,):
                mean = np.mean([own.taken(int(at)) for at in order[:count]], axis=0)
                note(f"prototype of {count} by {name}", [gain(mean, whole)])
            nearest = [allowed[own.apart(of, start, part).argmin()] for part in own.parts]
            note(
                f"parts by {name}",
                [gain(own.taken(int(a)), p) for a, p in zip(nearest, own.parts, strict=True)],
            )
            if name == "residual":
                before = (own.clips[allowed] == own.clips[start]) & (allowed < start)
                if before.any():
                    cycle = int(allowed[before][apart[before].argmin()])
                    note("cycle by residual", [gain(own.taken(cycle), whole)])
        candidates = allowed[::STRIDE]
        gains = np.array([own.gains(start, own.taken(int(at)), alone) for at in candidates])
        sums = gains.sum(axis=1)
        note("oracle", [float(sums.max())])
        note("oracle of parts", [float(gains[:, p].sum(axis=1).max()) for p in own.parts])
        best = candidates[np.argsort(-sums, kind="stable")[:8]]
        mean = np.mean([own.taken(int(at)) for at in best], axis=0)
        note("oracle of prototypes", [gain(mean, whole)])
    return total, saved


def main() -> None:
    """Measure each folder."""
    columns = [["parent, % saved"], *([way] for way in WAYS)]
    for folder in map(Path, sys.argv[1:]):
        clips = library(folder)
        if sum(clip.frames for clip in clips) < 4 * PIECE:
            print(f"{folder}: too little", file=sys.stderr)
            continue
        own = Pieces(clips)

        def progress(text: str, folder: Path = folder) -> None:
            print(folder.name, text, file=sys.stderr, flush=True)

        total, saved = savings(own, progress)
        rate = round(float(clips[0].fps or 120))
        bits = total / (PIECES * PIECE * own.values.shape[1])
        columns[0].append(f"{folder.name}, {len(own.values)} frames, {rate} Hz, {bits:.2f} bits")
        for row, way in zip(columns[1:], WAYS, strict=True):
            gross, net = 100 * saved[way] / total
            row.append(f"{gross:.2f} / {net:.2f}")
        head = columns[0]
        print(markdown(head, columns[1:]), flush=True)


if __name__ == "__main__":
    main()
