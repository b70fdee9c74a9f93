"""From clips to compressed files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from mocapress import codecs
from mocapress.api.encoding import as_printed, coded, stored_skeleton
from mocapress.api.opening import Opened
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.codecs.loss import Loss, checked_loss
from mocapress.container import CodedChunk, Head, Mcz, MczWriter, is_storable_time
from mocapress.errors import UnsupportedError, VerificationError
from mocapress.formats.problems import Problem
from mocapress.motion import Clip
from mocapress.motion.soundness import refuse_unsound
from mocapress.source import Source


@dataclass(frozen=True, slots=True)
class Compressed:
    """What compressing made."""

    blob: bytes
    """The ``.mcz`` file."""
    warning: str | None
    """Why the numbers, or a part of them, were not compressed as motion."""
    loss: Loss | None = None
    """What a lossy codec lost, measured from what it decodes to; None where nothing is lost."""
    mcz: Mcz | None = None
    """The file, opened, where that was done to check it."""


def compress_clip(
    clip: Clip,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    model: Model | None = None,
    notes: Mapping[str, str] | None = None,
) -> Compressed:
    """Compress a clip; see ``compress``. The model is for its first stream."""
    refuse_unsound(clip)
    made = checked_codec(codec, model)
    skeleton = stored_skeleton(clip)
    heads, chunks = [], []
    for index, (name, stream) in enumerate(clip.streams.items()):
        if not is_storable_time(stream.frame_time):
            raise UnsupportedError("frame time", found=str(stream.frame_time))
        alone, own = Clip({name: stream}, clip.skeleton), model if index == 0 else None
        way = made if index == 0 or made.lossless else codecs.codec(DEFAULT_CODEC)
        encoded = way.encode(stream, skeleton=clip.skeleton, model=own)
        if not way.lossless:
            alone = as_printed(alone, way, encoded)
        head, of_stream = coded(alone, name, index, way, encoded, own)
        heads.append(head)
        chunks += of_stream
    facts = {**({"name": clip.name} if clip.name else {}), **clip.metadata}
    said = {key: readable(fact) for key, fact in facts.items()} | dict(notes or {})
    whole = Head(tuple(heads), skeleton)
    found = _checked(clip, made, model, _file(whole, said, chunks))
    if found.loss:
        # What was lost is known once the file is decoded, and stands in it.
        found = _checked(clip, made, model, _file(whole, said | found.loss.notes(), chunks))
    return found


def _file(head: Head, notes: Mapping[str, str], chunks: Sequence[CodedChunk]) -> bytes:
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.head(head)
    if notes:
        writer.notes(notes)
    for chunk in chunks:
        writer.chunk(chunk)
    writer.end()
    return b"".join(parts)


def _checked(clip: Clip, codec: Codec, model: Model | None, blob: bytes) -> Compressed:
    """Decode a file, and compare: bits of a lossless codec's values, else their errors."""
    opened = Opened(Source(blob, limit=None), [model] if model else [])
    loss = None
    for index, (name, stream) in enumerate(clip.streams.items()):
        rows = opened.rows(index).values
        if index == 0 and not codec.lossless:
            loss = checked_loss(codec, Clip({name: stream}, clip.skeleton), rows)
        elif rows.tobytes() != stream.values.tobytes():
            raise VerificationError(f"codec {codec.id} does not give back stream {name!r}")
    return Compressed(blob, None, loss, opened.mcz)


def checked_codec(codec: str | Codec, model: Model | None) -> Codec:
    """Make a codec of its text; see that the model is for it."""
    if isinstance(codec, str):
        return codecs.codec_for(codec, model) if model else codecs.codec(codec)
    return codecs.learner(codec, model) if model else codec


def readable(name: str) -> str:
    """Replace what is no UTF-8 in the name of a file."""
    return name.encode(errors="surrogateescape").decode(errors="replace")


def stored_name(path: str) -> str:
    """Give a file's name without folders."""
    return readable(PurePath(path).name)


def problems_told(problems: Sequence[Problem], source: Source) -> str | None:
    """Say where a file departs from its format; None where it does not."""
    file = source.name or None
    return "; ".join(str(problem.error(file)) for problem in problems) or None
