"""Motion files to clips and back."""

import warnings
from collections.abc import Sequence
from pathlib import Path

from mocapress import formats
from mocapress.api.clips import compress_clip
from mocapress.api.loading import load_source
from mocapress.codecs import DEFAULT_CODEC, Codec
from mocapress.container import diffma_json
from mocapress.errors import MocapressError, MotionWarning, ParameterError, UnsupportedError
from mocapress.formats import Format
from mocapress.models import Place
from mocapress.motion import Clip
from mocapress.motion.clip import MOTION
from mocapress.motion.convert import with_rate
from mocapress.motion.soundness import refuse_unsound
from mocapress.source import DIFFMA_JSON, JSON_SUFFIXES, LIMIT, MCZ, Named, Source
from mocapress.source import read as read_motion
from mocapress.storage import ExistsError, write_all, write_whole


def read(
    source: Named,
    *,
    asf_path: str | Path | None = None,
    models: Sequence[Place] = (),
    strict: bool = True,
    limit: int | None = LIMIT,
) -> Clip:
    """Read a motion file: of any format, compressed (``.mcz``; see ``load``), or DiffMA JSON.

    Parameters
    ----------
    source
        A path, the contents, or a binary stream. A skeleton alone (ASF) gives a clip without
        frames.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one:
        that of the same name, of the subject, or the only one in the folder, which is warned of.
        ``metadata`` of the clip says which one was used (``skeleton``) and how it was found
        (``skeleton_found``). One that is broken or does not fit is left away with a warning.
    models
        Where to look for the model that a ``.mcz`` may need, as in ``decompress``.
    strict
        Whether a file that has lost frames is refused: one with fewer rows than it declares, or
        with rows that cannot be read. With ``strict=False`` it is read as far as possible, with a
        ``MotionWarning``; a row that cannot be read between others keeps the values of the one
        before. What loses nothing, such as a row more than declared, always is a warning.
    limit
        Bytes that the numbers of a ``.mcz`` or DiffMA JSON may be, 8 each: 4 GiB by default; None
        for any.

    Raises
    ------
    CorruptError
        When a ``.mcz`` is damaged.
    FormatError
        When the file does not follow its format, or the given ASF cannot be read or is another's:
        with file, place, expected and found.
    OSError
        When it cannot be opened.

    """
    return read_source(Source(source, limit=limit), asf_path, models=models, strict=strict)


def read_source(
    source: Source,
    asf_path: str | Path | None = None,
    *,
    models: Sequence[Place] = (),
    strict: bool = True,
) -> Clip:
    """Read a motion file; see ``read``."""
    if source.kind == MCZ:
        return load_source(source, asf_path=asf_path, models=models, strict=strict)
    if source.kind == DIFFMA_JSON:
        return diffma_json.json_to_clip(source)
    return read_motion(source, asf_path, strict=strict)


def write(
    clip: Clip,
    path: str | Path,
    *,
    to: str | None = None,
    fps: float | None = None,
    codec: str | Codec | None = None,
    force: bool = False,
) -> None:
    """Write a clip to a motion file, as ``.mcz``, or as DiffMA JSON.

    The clip is converted to what the format can hold. What belongs beside the file is written,
    too: the skeleton of an AMC as an ASF of the same name.

    Parameters
    ----------
    clip
        With a skeleton, except for formats that need none.
    path
        Its ending names the format.
    to
        Id of the format, whatever the ending, and its options: ``"glb:max=0.1cm"``.
    fps
        Frames per second, instead of those of the clip. A BVH has to state its frame time: where
        neither the clip nor ``fps`` says it, 120 are assumed, with a ``MotionWarning``.
    codec
        For ``.mcz``, by default ``"exact"``, which loses nothing; and for DiffMA JSON, which always
        loses something: say how much, ``"diffma:bound=4"`` or ``"diffma:max_error=0.1"``.
    force
        Whether to replace existing files.

    Raises
    ------
    ParameterError
        When ``fps`` is no number above 0, a file that loses something is asked for without a codec,
        a codec for a file that has none, or the clip could not be read back.
    ExistsError
        When a file exists and ``force`` is not given.
    UnsupportedError
        When there is no such format to write in, or the clip lacks what it needs.

    """
    path, clip = Path(path), with_rate(clip, fps)
    refuse_unsound(clip)
    if to is None and path.name.lower().endswith(".mcz"):
        write_whole(path, compress_clip(clip, codec or DEFAULT_CODEC).blob, force=force)
        return
    if to is None and path.name.lower().endswith(JSON_SUFFIXES):
        if codec is None:
            wanted = 'how much may be lost, such as codec="diffma:bound=4"'
            raise ParameterError("DiffMA JSON is lossy", file=str(path), expected=wanted)
        text = diffma_json.to_json(clip, codec)
        write_whole(path, diffma_json.named(path.name, text), force=force)
        return
    if codec is not None:
        expected = f"a name in .mcz or {JSON_SUFFIXES[0]}"
        raise ParameterError("codec, but the file has none", file=str(path), expected=expected)
    of = formats.configured(to) if to else formats.for_writing(path.name)
    if of is None:
        known = formats.listed(formats.writable())
        raise UnsupportedError(
            "no format to write clips in", expected=known, found=repr(path.suffix)
        )
    write_all(printed(with_rate(clip, needed=of.timed), of, path), force=force)


def _warn_of_losses(clip: Clip, fitted: Clip, of: Format) -> None:
    """Name the streams that a format does not hold; joints may become points."""
    lost = [name for name in clip.streams if name not in fitted.streams and name != MOTION]
    if lost:
        what = f"{', '.join(lost)} of this clip are not written, which {of.name} does not hold"
        warnings.warn(MotionWarning("lost-streams", MocapressError(what)), stacklevel=3)


def printed(clip: Clip, of: Format, path: Path) -> dict[Path, bytes]:
    """Print a clip in a format: contents by path, of the file itself first.

    Raises
    ------
    ExistsError
        When something else lies where the skeleton would go, and no file of this name beside it:
        then it is not a skeleton that came with this file, but one of others.
    UnsupportedError
        When the clip lacks what the format needs.

    """
    if of.write is None:
        known = formats.listed(formats.writable())
        raise UnsupportedError("no format to write clips in", expected=known, found=of.name)
    fitted = of.fit(clip)
    _warn_of_losses(clip, fitted, of)
    (_, data), *companions = of.write(fitted).items()
    files = {path: data}
    for suffix, contents in companions:
        place = path.with_suffix(suffix)
        if not place.exists() or path.exists():
            files[place] = contents
        elif place.read_bytes() != contents:
            raise ExistsError(
                f"file exists and did not come with {path.name}",
                file=str(place),
                expected="another name for the output, or this file elsewhere",
            )
    return files
