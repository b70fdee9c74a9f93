"""Models that codecs have learned from clips: learning them, their files, finding them again."""

import os
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

from mocapress import codecs
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.codecs.fallback import naming_faults
from mocapress.container import Mcm, pack_model, parse_model, peek_model
from mocapress.container.mcm import LONGEST_FILE, LONGEST_HEADER
from mocapress.errors import (
    CorruptError,
    LimitError,
    MissingModelError,
    MocapressError,
    ParameterError,
)
from mocapress.motion import Clip
from mocapress.source import Named, Source, read
from mocapress.storage import write_whole

__all__ = ["Place", "find_model", "load_model", "model_bytes", "save_model", "train"]

FOLDERS_VARIABLE = "MOCAPRESS_MODELS"
"""The environment variable that names folders of models, separated as in ``PATH``."""

Place = Model | str | Path
"""Where a model may be: it itself, its file, or a folder with ``.mcm`` files."""


def train(sources: Iterable[Named | Clip], codec: str | Codec = DEFAULT_CODEC) -> Model:
    """Learn a model from clips, for compressing clips like these.

    Parameters
    ----------
    sources
        Clips, or motion files: paths, contents or streams; read one at a time.
    codec
        A codec that learns, or its text; where this names no level, the strongest is taken.
        Levels 1 to 5 of ``exact`` learn nothing.

    Raises
    ------
    ParameterError
        When the codec does not learn, or there are no clips.
    FormatError
        When a file cannot be read.
    VerificationError
        When the codec fails.

    """
    made = codecs.codec_for(codec, None) if isinstance(codec, str) else codec
    learner = codecs.learner(made)
    clips = (source if isinstance(source, Clip) else read(Source(source)) for source in sources)
    first = next(clips, None)
    if first is None:
        raise ParameterError("nothing to learn from", expected="at least one clip")
    with naming_faults(made):
        return learner.learn(chain([first], clips))


def model_bytes(model: Model) -> bytes:
    """Give the contents of a model's file."""
    return pack_model(Mcm(model.codec, model.digest), model.payload)


def save_model(model: Model, path: str | Path, *, force: bool = False) -> None:
    """Write a model to a ``.mcm`` file.

    Raises
    ------
    ExistsError
        When the file exists and ``force`` is not given.

    """
    write_whole(path, model_bytes(model), force=force)


def load_model(source: str | Path | bytes, *, limit: int | None = None) -> Model:
    """Read a model from a ``.mcm`` file, or its bytes.

    Parameters
    ----------
    source
        The file.
    limit
        Bytes that the model may have, unpacked; None for as many as any model may: 8 MiB.

    Raises
    ------
    CorruptError
        When it is not such a file, or a damaged one.
    LimitError
        When it is larger than ``limit`` allows.

    """
    try:
        header, payload = parse_model(
            source if isinstance(source, bytes) else _front(Path(source), LONGEST_FILE)
        )
        if limit is not None and len(payload) > limit:
            raise LimitError(limit, len(payload))
        model = Model(header.codec, payload)
        if model.digest != header.digest:
            raise CorruptError(
                "wrong digest of the model", expected=header.digest.hex(), found=model.digest.hex()
            )
    except MocapressError as error:
        error.file = None if isinstance(source, bytes) else str(source)
        raise
    return model


def find_model(digest: bytes, places: Iterable[Place], folder: Path | None = None) -> Model:
    """Find the model that a file names.

    Parameters
    ----------
    digest
        The name.
    places
        Where to look first.
    folder
        Where to look then: the file's own. At last come the folders of ``MOCAPRESS_MODELS``.

    Raises
    ------
    MissingModelError
        When it is nowhere; says where it was looked for.
    CorruptError
        When it is there, and damaged.

    """
    named = os.environ.get(FOLDERS_VARIABLE, "").split(os.pathsep)
    folders = ([folder] if folder else []) + [Path(name) for name in named if name]
    looked: list[Place] = [*places, *folders]
    others: list[str] = []
    damaged: MocapressError | None = None
    for place in looked:
        if isinstance(place, Model):
            found: Iterable[Path | Model] = [place]
        elif Path(place) in folders or Path(place).is_dir():
            found = _in_folder(digest, Path(place), others)
        else:
            found = [load_model(place)]
        for one in found:
            try:
                model = one if isinstance(one, Model) else load_model(one)
            except MocapressError as error:
                damaged = damaged or error  # there may be a sound copy elsewhere
                continue
            if model.digest == digest:
                return model
            others.append(_name(place))
    if damaged is not None:
        raise damaged
    raise MissingModelError(
        f"model {digest.hex()} is needed",
        expected=f"it in {', '.join(dict.fromkeys(map(_name, looked)))}"
        if looked
        else f"it given, beside the file, or in a folder that {FOLDERS_VARIABLE} names",
        found=_few(list(dict.fromkeys(others))) or "no models",
    )


def _in_folder(digest: bytes, folder: Path, others: list[str]) -> Iterator[Path]:
    """Give the files whose headers name a model; what is there instead is added to ``others``."""
    for path in _model_files(folder):
        try:
            header = peek_model(_front(path, LONGEST_HEADER))
        except (MocapressError, OSError) as error:
            others.append(f"{path} ({error})")
            continue
        if header.digest == digest:
            yield path
        else:
            others.append(str(path))


def _model_files(folder: Path) -> Iterator[Path]:
    try:
        yield from sorted(path for path in folder.iterdir() if path.suffix.lower() == ".mcm")
    except OSError:
        return


def _front(path: Path, most: int) -> bytes:
    with path.open("rb") as file:
        return file.read(most)


def _few(names: list[str], most: int = 5) -> str:
    left = len(names) - most
    return ", ".join(names[:most]) + (f" and {left} more" if left > 0 else "")


def _name(place: Place) -> str:
    return f"model {place.digest.hex()}" if isinstance(place, Model) else str(place)
