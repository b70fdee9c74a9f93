"""Learn what core/exact/kinematics.cpp knows of the skeleton of CMU clips, and say how it helps.

    python benchmarks/kinematic_weights.py corpus/amc/cmu \
        --write core/exact/data/skeleton_cmu_1.txt
    python benchmarks/kinematic_weights.py corpus/amc/cmu --measure

docs/exact_kinematics.md explains the model. Geometry is the mean of the skeletons, weights are
fitted to stretches of clips, both of subjects that are not left out; what is measured are those
left out. The same clips give the same numbers: nothing is drawn by chance.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

import mocapress
from mocapress.codecs.exact import Exact, skeletons
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.kinematics import positions, rotations

Array = NDArray[np.float64]

LEFT_OUT = "02 06 07 09 10 11 35 43 60 141"
MOST_CLIPS = 4  # of a subject
WINDOW = 16  # frames
WINDOWS = 3  # of a clip
STEP = 1e-3  # degrees and lengths: how far a channel is moved to see what it moves
KINDS = ("tx", "ty", "tz", "rx", "ry", "rz")
BONES_OF_LIMBS = (1, 3, 3, 7, 7, 4, 4)
LAWFUL = ("thorax", "head", "rthumb", "lthumb")  # what laws predict is no matter here
USUAL = np.log(1e-2)  # a resistance of which nothing is known
HEAD = (
    "// CMU, version 1: the bones of the skeleton of the CMU motion capture database, then its "
    "channels.\n// Written by benchmarks/kinematic_weights.py.\n// bone: parent, axis x y z, "
    "start x y z, end x y z, place of tx ty tz rx ry rz, mass, inertia\n"
)
FAITH = 1e-3  # in the start of the fit, per squared unit of a logarithm


class Bone(NamedTuple):
    """A joint with channels; joints without any are part of their children's start."""

    name: str
    parent: int
    axis: Array  # (3,) degrees
    start: Array  # (3,) in the parent's frame
    end: Array  # (3,)
    channels: tuple[str, ...]


def clips_of(folder: Path, subjects: Sequence[str], most: int | None) -> list[Clip]:
    """Read clips of subjects that move the skeleton, spread over those that there are."""
    clips = []
    for subject in subjects:
        paths = sorted((folder / subject).glob("*.amc"))
        every = 1 if most is None else max(1, len(paths) // most)
        chosen = paths[::every][:most]
        clips += [
            clip for clip in map(mocapress.read, chosen) if skeletons.skeleton_of(clip.columns)
        ]
    return clips


def bones_of(clip: Clip) -> list[Bone]:
    """Give the bones of a clip's skeleton in the order of its columns."""
    joints = clip.skeleton.joints
    order = list(dict.fromkeys(column.joint for column in clip.columns))
    bones = []
    for j in order:
        joint, start, parent = joints[j], np.array(joints[j].offset), joints[j].parent
        while parent >= 0 and parent not in order:
            start, parent = start + joints[parent].offset, joints[parent].parent
        ends = joint.ends or tuple(k.offset for k in joints if k.parent == j)
        end = np.zeros(3) if joint.parent < 0 else np.array(ends[0])
        place = -1 if parent < 0 else order.index(parent)
        kinds = tuple(column.kind for column in clip.columns if column.joint == j)
        bones.append(Bone(joint.name, place, np.array(joint.axis), start, end, kinds))
    return bones


def mean_bones(clips: Sequence[Clip]) -> list[Bone]:
    """Give the mean skeleton; a subject counts once, frames of axes in whole degrees."""
    of_subjects = {clip.skeleton.joints: bones_of(clip) for clip in clips}
    return [
        own[0]._replace(
            axis=np.round(np.median([bone.axis for bone in own], axis=0)) + 0.0,
            start=np.round(np.mean([bone.start for bone in own], axis=0), 3) + 0.0,
            end=np.round(np.mean([bone.end for bone in own], axis=0), 3) + 0.0,
        )
        for own in zip(*of_subjects.values(), strict=True)
    ]


def skeleton_of(bones: Sequence[Bone]) -> Skeleton:
    return Skeleton(
        tuple(
            Joint(b.name, b.parent, tuple(b.start), b.channels, tuple(b.axis), ends=(tuple(b.end),))
            for b in bones
        ),
        "fixed",
    )


def moved_by(bones: Sequence[Bone], clip: Clip, poses: Array) -> Array:
    """Give how channels move bones: (F, B, 6, C), ends' places and frames' turns, per unit."""
    places = {name: b for b, name in enumerate(bone.name for bone in bones)}
    columns = tuple(
        replace(c, joint=places[clip.skeleton.joints[c.joint].name]) for c in clip.columns
    )
    count, frames = len(columns), len(poses)
    nudges = STEP * np.vstack([np.eye(count), -np.eye(count)])
    nudged = (poses[:, None] + nudges).reshape(-1, count)
    stood = Clip.of(nudged, columns, skeleton=skeleton_of(bones))
    ends = positions(stood, end_sites=True)[:, len(bones) :].reshape(frames, 2, count, -1, 3)
    turns = rotations(stood).reshape(frames, 2, count, -1, 4)
    (w, x), (v, y) = ((turns[:, s, ..., :1], turns[:, s, ..., 1:]) for s in (0, 1))
    both = np.stack([ends[:, 0] - ends[:, 1], 2 * (v * x - w * y - np.cross(x, y))], axis=-2)
    moves = both.reshape(frames, count, len(bones), 6) / (2 * STEP)
    return np.moveaxis(moves, 1, -1)


class Stretches(NamedTuple):
    """Frames to fit on: F in windows, channels that move."""

    moves: Array  # (F, B, 6, C)
    deltas: Array  # (F, C) second differences
    steps: Array  # (F, C) of the numbers as they are written


def stretches_of(bones: Sequence[Bone], clips: Sequence[Clip], moving: Array) -> Stretches:
    parts: list[tuple[Array, Array, Array]] = []
    for clip in clips:
        values = clip.values[len(clip.values) // 4 :][: WINDOW * WINDOWS + 2]
        if len(values) < WINDOW * WINDOWS + 2 or not move(values)[moving].all():
            continue
        poses = 2 * values[1:-1] - values[:-2]
        size = np.floor(np.log10(np.maximum(np.abs(values[2:]), 1e-6)))
        parts.append(
            (
                moved_by(bones, clip, poses)[..., moving],
                (values[2:] - poses)[:, moving],
                10 ** (size - 5)[:, moving],
            )
        )
    return Stretches(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def move(values: Array) -> Array:
    """Tell which columns move, rounding noise apart."""
    return (np.ptp(values, axis=0) > 0) & (np.median(np.abs(values), axis=0) > 1e-10)


class Weights(NamedTuple):
    """What is learned, in logarithms; left and right have the same."""

    masses: Array  # (B,)
    inertias: Array  # (B,)
    resistances: Array  # (C,)


class Mirror:
    """The weights as one vector of what is to be learned."""

    def __init__(self, bones: Sequence[Bone]) -> None:
        names = [bone.name for bone in bones]
        sides = [n[1:] if f"l{n[1:]}" in names and f"r{n[1:]}" in names else n for n in names]
        channels = [
            (side, k) for side, bone in zip(sides, bones, strict=True) for k in bone.channels
        ]
        self.parts = [np.unique(np.array(key), return_inverse=True)[1] for key in (sides, sides)]
        keys = list(dict.fromkeys(channels))
        self.parts.append(np.array([keys.index(channel) for channel in channels]))
        self.sizes = [part.max() + 1 for part in self.parts]

    def start(self) -> Array:
        return np.concatenate(
            [np.zeros(self.sizes[0]), np.zeros(self.sizes[1]), np.full(self.sizes[2], USUAL)]
        )

    def weights(self, vector: Array) -> Weights:
        pieces = np.split(vector, np.cumsum(self.sizes)[:-1])
        return Weights(*(piece[part] for piece, part in zip(pieces, self.parts, strict=True)))

    def vector(self, gradient: Weights) -> Array:
        return np.concatenate(
            [
                np.bincount(part, weights=own, minlength=size)
                for own, part, size in zip(gradient, self.parts, self.sizes, strict=True)
            ]
        )


def errors_of(precision: Array, deltas: Array) -> tuple[Array, Array, Array]:
    """Give what the means given earlier channels leave, and the factors: precision = M' D M."""
    upper = np.linalg.cholesky(precision[:, ::-1, ::-1])[:, ::-1, ::-1]
    roots = np.diagonal(upper, axis1=1, axis2=2)
    regression = upper.swapaxes(1, 2) / roots[:, :, None]
    return np.einsum("tij,tj->ti", regression, deltas), regression, roots**2


def precision_of(stretches: Stretches, weights: Weights, moving: Array) -> Array:
    each = np.exp(np.stack([weights.masses, weights.inertias], axis=1)).repeat(3, axis=1)
    frames, _, _, count = stretches.moves.shape
    flat = stretches.moves.reshape(frames, -1, count)
    return flat.swapaxes(1, 2) @ (flat * each.reshape(1, -1, 1)) + np.diag(
        np.exp(weights.resistances[moving])
    )


def bits_of(errors: Array, steps: Array, counts: Array) -> tuple[float, Array]:
    """Give bits per frame, by the logarithm of each window's mean square, and their slopes."""
    squares = (errors**2 + steps**2).reshape(-1, WINDOW, errors.shape[1]).mean(axis=1)
    bits = float((np.log2(squares) / 2 * counts).sum(axis=1).mean())
    slopes = errors * counts / squares.repeat(WINDOW, axis=0) / len(errors) / np.log(2)
    return bits, slopes


def fit(bones: Sequence[Bone], stretches: Stretches, moving: Array) -> Weights:
    mirror = Mirror(bones)
    counts = counted(bones)[moving]
    start = mirror.start()
    frames, _, _, count = stretches.moves.shape
    flat = stretches.moves.reshape(frames, -1, count)

    def cost(vector: Array) -> tuple[float, Array]:
        weights = mirror.weights(vector)
        precision = precision_of(stretches, weights, moving)
        errors, regression, pivots = errors_of(precision, stretches.deltas)
        bits, slopes = bits_of(errors, stretches.steps, counts)
        # d precision = sum of dX, X = dM M^-1 strictly lower: docs/exact_kinematics.md
        inverse = np.linalg.inv(regression)
        inner = np.tril(np.einsum("ti,tj->tij", slopes / pivots, errors), -1)
        slope = inverse @ inner @ inverse.swapaxes(1, 2)
        by_rows = np.einsum("trc,trc->r", flat @ slope, flat).reshape(-1, 2, 3).sum(axis=2)
        resistances = np.zeros(len(moving))
        resistances[moving] = np.einsum("tcc->c", slope)
        gradient = Weights(
            by_rows[:, 0] * np.exp(weights.masses),
            by_rows[:, 1] * np.exp(weights.inertias),
            resistances * np.exp(weights.resistances),
        )
        off = vector - start
        return bits + FAITH * off @ off, mirror.vector(gradient) + 2 * FAITH * off

    found = minimize(cost, start, jac=True, method="L-BFGS-B", options={"maxiter": 120})
    print(f"{frames} frames, {found.nit} steps")
    return mirror.weights(found.x)


def counted(bones: Sequence[Bone]) -> Array:
    """Give 1 for each channel that no law predicts, else 0."""
    return np.array([float(b.name not in LAWFUL) for b in bones for _ in b.channels])


def report(
    name: str, bones: Sequence[Bone], stretches: Stretches, weights: Weights, moving: Array
) -> None:
    precision = precision_of(stretches, weights, moving)
    counts = counted(bones)[moving]
    errors, _, _ = errors_of(precision, stretches.deltas)
    plain, _ = bits_of(stretches.deltas, stretches.steps, counts)
    left, _ = bits_of(errors, stretches.steps, counts)
    print(
        f"{name}: the guesses take {plain - left:.1f} bits a frame off second differences "
        f"({counts.sum():.0f} channels, {len(errors)} frames)"
    )


def table(bones: Sequence[Bone], weights: Weights) -> str:
    """Write the data file of the format (docs/format/exact.md)."""
    rows, channels = [], []
    limbs = np.repeat(np.arange(len(BONES_OF_LIMBS)), BONES_OF_LIMBS)
    for b, bone in enumerate(bones):
        places = [-1] * 6
        for kind in bone.channels:
            places[KINDS.index(kind)] = len(channels)
            resistance = np.exp(weights.resistances[len(channels)])
            channels.append(f"  {b}, {limbs[b]}, {resistance:.4g},\n")
        mass, inertia = np.exp(weights.masses[b]), np.exp(weights.inertias[b])
        numbers = [bone.parent, *bone.axis, *bone.start, *bone.end, *places, mass, inertia]
        told = ", ".join(f"{number:.4g}" for number in numbers)
        rows.append(f"  {told},  // {bone.name}\n")
    return HEAD + "".join(rows) + "// channel: bone, limb, resistance\n" + "".join(channels)


def measure(clips: Sequence[Clip]) -> None:
    """Print bytes at level 9 with the skeleton and without, which is where angles have no unit."""
    totals = np.zeros(2)
    for clip in clips:
        bare = clip.with_columns(tuple(replace(c, unit="") for c in clip.columns))
        for i, own in enumerate((clip, bare)):
            totals[i] += sum(len(chunk.payload) for chunk in Exact(level=9).encode(own.main).chunks)
    print(f"{len(clips)} clips: {totals[1]:.0f} bytes without, {totals[0]:.0f} with the skeleton")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="of folders of AMC clips, one per subject")
    parser.add_argument("--leave-out", default=LEFT_OUT, help="subjects")
    parser.add_argument("--write", type=Path, help="the data file to write")
    parser.add_argument("--measure", action="store_true", help="code the clips that are left out")
    options = parser.parse_args()
    left_out = options.leave_out.split()
    subjects = sorted(p.name for p in options.folder.iterdir() if p.is_dir())
    if options.measure:
        return measure(clips_of(options.folder, [s for s in subjects if s in left_out], None))
    clips = clips_of(options.folder, [s for s in subjects if s not in left_out], MOST_CLIPS)
    bones = mean_bones(clips)
    moving = np.mean([move(clip.values) for clip in clips], axis=0) > 1 / 2
    stretches = stretches_of(bones, clips, moving)
    weights = fit(bones, stretches, moving)
    report("fitted", bones, stretches, weights, moving)
    others = clips_of(options.folder, left_out, MOST_CLIPS)
    report("left out", bones, stretches_of(bones, others, moving), weights, moving)
    if options.write:
        options.write.write_text(table(bones, weights), encoding="utf-8")
    return None


if __name__ == "__main__":
    main()
