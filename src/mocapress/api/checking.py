"""Whether a compressed file is sound."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from mocapress import codecs
from mocapress.api.opening import Opened
from mocapress.api.restoring import pieces
from mocapress.codecs.loss import LOSS_NOTES
from mocapress.container import CHANNELS, Damage, diffma_json
from mocapress.errors import MissingModelError, MocapressError
from mocapress.models import Place
from mocapress.source import DIFFMA_JSON, LIMIT, Named, Source


@dataclass(frozen=True, slots=True)
class Checked:
    """What ``verify`` found."""

    raw_bytes: int
    """Of the original file; without one, of the numbers."""
    damage: tuple[Damage, ...]
    """Everything that is damaged: sections, chunks, the original; nothing of a sound file."""
    loss: Mapping[str, str] = field(default_factory=dict)
    """Of a lossy file, its codec and the errors that it states (``mp.read(...).metadata``)."""


def verify(source: Named, *, models: Sequence[Place] = (), limit: int | None = LIMIT) -> Checked:
    """Read and decode all of a compressed file, and check every checksum and digest.

    Parameters
    ----------
    source
        A ``.mcz`` or a DiffMA JSON: a path, the contents or a binary stream.
    models
        Where to look for the model that the file may need, as in ``decompress``.
    limit
        Bytes that may be restored, of the file, and of its numbers, 8 each: 4 GiB by default; None
        for any number.

    Raises
    ------
    CorruptError
        When it is no such file, or nothing in it can be read.
    MissingModelError
        When the model that the file needs is nowhere.
    UnsupportedError
        When more would be restored than ``limit`` allows.

    """
    return verify_source(Source(source, limit=limit), models)


def verify_source(source: Source, models: Sequence[Place] = ()) -> Checked:
    """Check a file; see ``verify``."""
    if source.kind == DIFFMA_JSON:  # a layout is not needed to be sound
        return Checked(diffma_json.json_to_clip(source).values.nbytes, ())
    return verify_opened(Opened(source, models, salvage=True))


def verify_opened(opened: Opened) -> Checked:
    """Check a file that was opened to be salvaged; see ``verify``."""
    original, size = opened.mcz.original, 0
    if original is not None:
        opened.source.allow(original.size)
    for index, head in enumerate(opened.streams):
        if head.kind == CHANNELS:
            size += _decoded(opened, index)
    if original is not None:
        size = original.size
        try:
            if not opened.damage:
                opened.salvage = False  # nothing is lost
                for _ in pieces(opened, original):
                    pass
        except MissingModelError:
            raise
        except MocapressError as error:
            opened.damage.append(Damage("the original file", error))
    return Checked(size, tuple(opened.damage), loss_of(opened))


def loss_of(opened: Opened) -> dict[str, str]:
    """Give the codec of a lossy file, and what it says of its errors; nothing of a lossless one."""
    if not opened.streams or opened.codec().lossless:
        return {}
    said = {key: opened.mcz.notes[key] for key in LOSS_NOTES if key in opened.mcz.notes}
    return {"codec": codecs.spec(opened.codec()), **said}


def _decoded(opened: Opened, stream: int) -> int:
    """Decode a stream; give the bytes of its numbers."""
    frame, last = 0, opened.frames(stream)
    opened.source.allow(opened.bytes_of(stream, last))
    while frame < last:
        begin, end = opened.run_at(stream, frame)
        opened.rows(stream, max(begin, frame), end)
        frame = end
    return 8 * last * len(opened.streams[stream].columns)
