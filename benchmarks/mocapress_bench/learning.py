"""Codecs with models that were learned from other clips than they are measured on."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from mocapress.codecs import Codec, Model
from mocapress.errors import FormatError, ParameterError
from mocapress.models import load_model, train
from mocapress.motion import Clip
from mocapress.source import Source, read
from mocapress_bench.contenders import Tool, contenders
from mocapress_bench.rivals import Rival

_STRONGEST = 9


@dataclass(frozen=True, slots=True)
class Learned:
    """A contender: a codec, and for each clip the model to code it with."""

    name: str
    codec: Codec
    models: dict[Path, Model]


def cross_validated(
    paths: Sequence[Path],
    only: str,
    *,
    folds: int,
    most_frames: int,
    progress: Callable[[str], None] = lambda _: None,
) -> list[Learned]:
    """Train on the clips of other folders: no model has seen a clip of its folder (subject).

    Parameters
    ----------
    paths
        All clips.
    only
        As in ``contenders``; if empty, codecs with levels are used at their strongest.
    folds
        Number of folds. Folders are dealt to folds in the order of their names, and each fold's
        clips are coded with a model of the other folds. With at least as many folds as folders,
        each fold is one folder.
    most_frames
        Number of frames that a model learns from, taken from all the other folders in turn.

    Raises
    ------
    ParameterError
        When there are fewer than two folders or folds.

    """
    folders = sorted({path.parent for path in paths})
    folds = min(folds, len(folders))
    if folds < 2:
        raise ParameterError("folds", expected="at least two, and folders for them", found="one")
    learned = [Learned(f"{name} + model", codec, {}) for name, codec in _learners(only).items()]
    for fold in range(folds):
        inside = set(folders[fold::folds])
        own = [path for path in paths if path.parent in inside]
        others = [path for path in paths if path.parent not in inside]
        for one in learned:
            progress(f"training {one.codec.id}, fold {fold + 1} of {folds}")
            model = train(_bounded(others, most_frames), one.codec)
            one.models.update(dict.fromkeys(own, model))
    return learned


def given(paths: Sequence[Path], only: str, file: Path) -> list[Learned]:
    """Use a model from a file. The caller must know that it has not seen these clips.

    Raises
    ------
    ParameterError
        When none of the codecs can use it.

    """
    model = load_model(file)
    learned = [
        Learned(f"{name} + model", codec, dict.fromkeys(paths, model))
        for name, codec in _learners(only).items()
        if codec.id == model.codec
    ]
    if not learned:
        raise ParameterError("--model", expected=f"{model.codec} among the codecs", found="none")
    return learned


def _learners(only: str) -> dict[str, Codec]:
    found: dict[str, Codec] = {}
    for name, contender in contenders(only)[0].items():
        if isinstance(contender, Tool | Rival) or not contender.can.trains:
            continue
        if only or getattr(contender, "level", _STRONGEST) == _STRONGEST:
            found[name] = contender
    return found


def _bounded(paths: Sequence[Path], most_frames: int) -> Iterator[Clip]:
    """Read clips, one of each folder in turn, up to ``most_frames``; the last clip is cut."""
    by_folder: dict[Path, list[Path]] = {}
    for path in paths:
        by_folder.setdefault(path.parent, []).append(path)
    left = most_frames
    for path in (path for turn in zip_longest(*by_folder.values()) for path in turn if path):
        if left <= 0:
            return
        try:
            clip = read(Source(path))
        except FormatError:
            continue  # said when it is measured
        yield clip[:left]
        left -= clip.frames
