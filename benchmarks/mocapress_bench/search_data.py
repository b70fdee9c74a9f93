"""Labelled clips to search in: HDM05 cuts, and takes of CMU."""

import csv
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.errors import MocapressError, ParameterError
from mocapress.motion.kinematics import positions, rotations
from mocapress.search.qssd import bone_turns
from mocapress.search.standard import standard_motion

Array = NDArray[np.float64]

RATE = 120
"""Frames a second of all clips here; an AMC does not say it."""
EVERY = 4
"""One frame in so many is looked at: 30 a second."""


@dataclass(frozen=True, slots=True, eq=False)
class Take:
    """A labelled clip."""

    path: Path
    label: str
    actor: str
    clip: mp.Clip
    turns: Array
    """(F, J, 4) rotations relative to the parents, without the root's; 30 frames a second."""
    bones: Array
    """(F, 15, 4) turns of bones between standard joints; 30 frames a second."""
    places: Array
    """(F, J, 3) positions of joints, centimetres, y up; 30 frames a second."""


def take_of(path: Path, clip: mp.Clip, label: str, actor: str) -> Take:
    """Take a clip's joints at 30 frames a second."""
    few = clip.with_frames(clip.values[::EVERY], clip.frame_time)
    unit = clip.skeleton.length_unit if clip.skeleton else None
    scale = 2.54 / unit if unit else 1.0
    return Take(
        path,
        label,
        actor,
        clip,
        rotations(few, local=True)[:, 1:],
        bone_turns(standard_motion(clip).places),
        scale * positions(few),
    )


def read_cuts(folder: Path, progress: Callable[[str], None] = lambda _: None) -> list[Take]:
    """Read a folder of cuts with ``labels.tsv`` (file, class, actor)."""
    with (folder / "labels.tsv").open() as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    named = [(folder / row["file"], row["class"], row["actor"]) for row in rows]
    return _takes(named, progress)


def read_trials(
    labels: Path, folder: Path, least: int = 3, progress: Callable[[str], None] = lambda _: None
) -> list[Take]:
    """Read those of CMU's trials that a table labels (trial, class), classes of so many and more.

    A trial's actor is its subject.
    """
    with labels.open() as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    classes = [row["class"] for row in rows]
    named = [
        (folder / trial[:-3] / f"{trial}.amc", label, trial[:-3])
        for trial, label in ((row["trial"], row["class"]) for row in rows)
        if classes.count(label) >= least
    ]
    return _takes(named, progress)


def _takes(named: Iterable[tuple[Path, str, str]], progress: Callable[[str], None]) -> list[Take]:
    takes: list[Take] = []
    for path, label, actor in named:
        progress(path.name)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", mp.MotionWarning)
                made = take_of(path, mp.read(path), label, actor)
        except MocapressError as error:
            raise ParameterError(f"{path.name} cannot be searched: {error}") from error
        if takes and made.turns.shape[1] != takes[0].turns.shape[1]:
            raise ParameterError(
                f"{path.name} has other joints than {takes[0].path.name}",
                expected=str(takes[0].turns.shape[1] + 1),
                found=str(made.turns.shape[1] + 1),
            )
        takes.append(made)
    return takes


def labels_of(takes: Sequence[Take]) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Give labels and actors."""
    return np.array([take.label for take in takes]), np.array([take.actor for take in takes])
