"""Fit the laws of core/exact/law.cpp on a folder of CMU clips, and say how far they reach.

    python benchmarks/solver_laws.py corpus/amc/cmu --write core/exact/data

The laws are explained in docs/exact_laws.md. Subjects that are left out of the fits are what the
printed tables are about. The same clips give the same numbers: nothing is drawn by chance.
"""

import argparse
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import mocapress
from solver_law_fits import (
    HOLDS,
    Array,
    Branch,
    Chain,
    at,
    branches,
    chain,
    middle_law,
    middle_terms,
    spread,
    thumb,
    twist_law,
    twist_terms,
    twists,
    y_errors,
)

CHAINS = {
    "spine": ("lowerback", "upperback", "thorax"),
    "neck": ("lowerneck", "upperneck", "head"),
}
HANDS = {"left": ("lhand", "lthumb", 1), "right": ("rhand", "rthumb", -1)}
BRANCHES = {"spine": 4, "neck": 8}
MOST_FITTED = 30000  # frames of a chain
MOST_TWISTS = 12000  # of a twist
LARGEST = 85  # degrees; angles beyond lie near the singularity of z, y, x


def read(folder: Path) -> dict[str, list[mocapress.Clip]]:
    """Read a folder's clips by subject, the first part of their names."""
    clips = defaultdict(list)
    for path in sorted(folder.rglob("*.amc")):
        clips[path.stem.split("_")[0]].append(mocapress.read(path))
    return dict(clips)


def columns(clips: Sequence[mocapress.Clip], names: Sequence[str]) -> Array:
    """Give named columns of clips one after the other, (F, C)."""
    found = []
    for clip in clips:
        places = {column.name: i for i, column in enumerate(clip.columns)}
        if all(name in places for name in names):
            found.append(clip.values[:, [places[name] for name in names]])
    return np.concatenate(found) if found else np.empty((0, len(names)))


def chain_angles(clips: Sequence[mocapress.Clip], name: str) -> Array:
    """Give the nine angles of a chain where no angle is near the singularity."""
    names = [f"{joint}.r{axis}" for joint in CHAINS[name] for axis in "xyz"]
    angles = columns(clips, names)
    return angles[(np.abs(angles) < LARGEST).all(axis=1)]


def quartiles(errors: Array) -> str:
    """Give the quartiles of errors in radians, in thousandths of a degree."""
    return " / ".join(
        np.format_float_positional(1000 * np.degrees(q), 2, fractional=False, trim="-")
        for q in np.quantile(errors, [0.25, 0.5, 0.75])
    )


def chain_row(axes: Chain, laws: Sequence[Branch], twist: Array, middle: Array) -> str:
    """Say how far the laws of a chain reach."""
    errors = np.stack([y_errors(axes, law) for law in laws], axis=1)
    best = np.where(errors.min(axis=1) < 2 * HOLDS, errors.argmin(axis=1), -1)
    shares = " / ".join(f"{100 * (best == i).mean():.1f}" for i in range(len(laws)))
    last = np.abs(twist_terms(axes) @ twist - twists(axes.second, axes.third))
    before = np.abs(middle_terms(axes) @ middle - twists(axes.first, axes.second))
    return (
        f"{len(best)} | {100 * (best >= 0).mean():.2f} | {shares} | "
        f"{quartiles(last)} | {quartiles(before)} |"
    )


def thumb_share(clips: Sequence[mocapress.Clip]) -> float:
    """Give the share of frames in which both thumb laws hold to the rounding of the angles."""
    held = []
    for hand, name, side in HANDS.values():
        angles = columns(clips, [f"{hand}.rx", f"{hand}.rz", f"{name}.rx", f"{name}.rz"])
        off = thumb(angles[:, :2], side) - angles[:, 2:]
        off -= 360 * np.round(off / 360)
        size = np.maximum(np.abs(angles).max(axis=1, keepdims=True), 1e-9)
        held.append((np.abs(off) < 2 * 10 ** (np.floor(np.log10(size)) - 5)).all(axis=1))
    return float(np.concatenate(held).mean())


def table(name: str, laws: list[Branch], twist: Array, middle: Array) -> str:
    """Write a data file of the format (docs/format/exact.md)."""
    text = (
        f"// {name.capitalize()}, version 1: the branches of the y law (35 numbers of g, 35 of h), "
        "the twist of the\n// last joint (22), that of the middle joint (12). Written by "
        "benchmarks/solver_laws.py.\n"
    )
    parts = [
        (f"branch {i}, {'gh'[half]}", numbers)
        for i, branch in enumerate(laws)
        for half, numbers in enumerate(branch)
    ]
    for what, values in (
        *parts,
        ("twist of the last joint", twist),
        ("twist of the middle joint", middle),
    ):
        numbers = [f"{value:.10g}" for value in values]
        rows = [", ".join(numbers[i : i + 6]) for i in range(0, len(numbers), 6)]
        text += f"// {what}\n" + "".join(f"  {row},\n" for row in rows)
    return text


def main() -> None:
    """Fit, report, and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="AMC clips named SUBJECT_NUMBER.amc")
    parser.add_argument("--leave-out", default="09,16,35", help="subjects that are not fitted on")
    parser.add_argument("--write", type=Path, help="the folder of data files")
    arguments = parser.parse_args()
    clips = read(arguments.folder)
    left_out = arguments.leave_out.split(",")
    fitted = [clip for subject in clips if subject not in left_out for clip in clips[subject]]
    laws, twist, middle = {}, {}, {}
    for name in CHAINS:
        angles = chain_angles(fitted, name)
        axes = chain(angles[spread(np.arange(len(angles)), MOST_FITTED)])
        laws[name] = branches(axes, BRANCHES[name])
        some = at(axes, spread(np.arange(len(axes.first)), MOST_TWISTS))
        twist[name], middle[name] = twist_law(some), middle_law(some)
        print(f"\n{name}: frames in which the y law holds, in %; twists off by, in 0.001 degrees\n")
        print("| subject | frames | any branch | by branch | last twist | middle twist |")
        print("|---|---:|---:|---|---|---|")
        print(f"| fitted on | {chain_row(axes, laws[name], twist[name], middle[name])}")
        for subject in left_out:
            own = chain(chain_angles(clips[subject], name))
            print(f"| {subject} | {chain_row(own, laws[name], twist[name], middle[name])}")
    print("\nthumbs: frames in which both angles hold to the rounding, in %\n")
    print("| subject | share |\n|---|---:|")
    for subject, own_clips in clips.items():
        print(f"| {subject} | {100 * thumb_share(own_clips):.2f} |")
    for name in CHAINS if arguments.write else ():
        text = table(name, laws[name], twist[name], middle[name])
        (arguments.write / f"{name}_1.txt").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
