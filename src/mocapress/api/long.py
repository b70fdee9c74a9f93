"""Files that are larger than is held in memory at once: compressed a run of frames at a time."""

import hashlib
import os
import tempfile
import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.api.clips import checked_codec, problems_told, stored_name
from mocapress.api.encoding import LONGEST_CHUNK, coded_chunks, stream_head
from mocapress.api.opening import Opened
from mocapress.api.plain import compress_plain
from mocapress.api.repetition import Repetition, may_be_smaller
from mocapress.api.restoring import pieces
from mocapress.codecs import Codec
from mocapress.codecs.fallback import first_that_works
from mocapress.container import Head, MczWriter, Original, is_storable_time, pack
from mocapress.errors import CorruptError, FormatError, VerificationError
from mocapress.formats.contract import LongSplit
from mocapress.models import Place
from mocapress.motion import Clip
from mocapress.records import Ranges
from mocapress.source import MCZ, Source

LONG = 2**23
"""Bytes from which on a file is worked on in parts where its format can."""
_CHUNK = 2**18
"""Numbers that are decoded together, and"""
_RUN = 2**21
"""encoded together."""
_PART = 2**20
_HELD = 2**27
"""Bytes up to which a file is compressed as a whole, in the general-purpose way."""

Values = NDArray[np.float64]


class LongFile:
    """A compressed file on the disk, under a name of its own that is gone with this object."""

    def __init__(self) -> None:
        descriptor, name = tempfile.mkstemp(prefix="mocapress-")
        self.path, self.warning = Path(name), ""
        self.repetition = Repetition()
        """Of the numbers in it, where the file is not too large to be held."""
        self._descriptor = descriptor
        weakref.finalize(self, self.path.unlink, missing_ok=True)

    def write(self, data: bytes) -> None:
        """Append bytes."""
        left = memoryview(data)
        while left:
            left = left[os.write(self._descriptor, left) :]

    def close(self) -> None:
        """Have nothing more to write."""
        os.close(self._descriptor)

    def __len__(self) -> int:
        """Give the number of bytes."""
        return self.path.stat().st_size

    def __iter__(self) -> Iterator[bytes]:
        """Give the bytes, part after part."""
        with self.path.open("rb") as file:
            while part := file.read(_PART):
                yield part


def compress_long(
    source: Source, codec: str | Codec, notes: Mapping[str, str] | None = None
) -> LongFile | None:
    """Compress a file in parts; None where that is not for it, and ``compress_source`` is.

    What was written is read again, and the original that comes back compared with the file, part
    after part.
    """
    made = checked_codec(codec, None)
    of = source.format
    if of is None or of.split_long is None or source.size < LONG or not made.lossless:
        return None
    try:
        parts = of.split_long(source, source.name or None)
    except FormatError:
        return None
    if not all(is_storable_time(stream.frame_time) for stream in parts.clip.streams.values()):
        return None
    digest = _digest(source)
    found, failure = first_that_works(
        made, lambda way: _written(source, parts, digest, way, notes or {})
    )
    if found is not None:
        if source.size <= _HELD and may_be_smaller(found.repetition, len(found), source, made):
            plain = compress_plain(source, notes or {})
            if len(plain) < len(found):
                found = LongFile()
                found.write(plain)
                found.close()
        told = problems_told(parts.problems, source)
        found.warning = "; ".join(filter(None, (failure, told)))
    return found


def restored_long(
    source: Source, models: Sequence[Place] = ()
) -> tuple[int, Iterator[bytes]] | None:
    """Give the size and the parts of a large original; None where it is not large, or not exact.

    The parts may be asked for once; the last of them comes with an error where they are not the
    file that was compressed.
    """
    if source.kind != MCZ:
        return None
    opened = Opened(source, models)
    original = opened.mcz.original
    if original is None or original.size < LONG or opened.mcz.companions:
        return None
    if opened.streams and not opened.codec().lossless:
        return None
    return original.size, pieces(opened, original)


def _digest(file: Ranges) -> bytes:
    made = hashlib.sha256()
    for start in range(0, file.size, _PART):
        made.update(file.read(start, min(start + _PART, file.size)))
    return made.digest()


def _written(
    source: Source, parts: LongSplit, digest: bytes, codec: Codec, notes: Mapping[str, str]
) -> LongFile:
    file = LongFile()
    writer = MczWriter(file.write)
    streams = parts.clip.streams
    ways = {
        name: _way(codec, stream.channels, parts.frames[place] // min(parts.frames))
        for place, (name, stream) in enumerate(streams.items())
    }
    heads = {
        name: stream_head(name, stream, ways[name], frames=parts.frames[place])
        for place, (name, stream) in enumerate(streams.items())
    }
    writer.head(Head(tuple(heads.values()), None))
    record, name = parts.stored.record(), stored_name(source.name)
    writer.original(
        Original(parts.stored.format, name, source.size, digest, parts.problems, pack(record))
    )
    if notes:
        writer.notes(notes)
    for place, first, run in _runs(parts):
        own = list(streams)[place]
        stream = replace(streams[own], values=run)
        encoded = ways[own].encode(stream)
        clip = Clip({own: stream})
        if place == 0 and source.size <= _HELD:
            file.repetition.add(run)
        for chunk in coded_chunks(
            clip, heads[own], place, ways[own], encoded, None, first=first, own_header=True
        ):
            writer.chunk(chunk)
    writer.end()
    file.close()
    _check(source, file)
    return file


def _way(codec: Codec, columns: int, times: int) -> Codec:
    """Give a codec whose chunks hold enough numbers to be worth a header of their own."""
    chunk = getattr(codec, "chunk", None)
    if chunk is None:
        return codec
    frames = max(_CHUNK // columns, chunk) // max(times, 1) * max(times, 1)
    changed: dict[str, Any] = {"chunk": min(max(frames, 1), LONGEST_CHUNK)}
    return codecs.from_parameters(codec.id, {**codecs.parameters(codec), **changed})


def _runs(parts: LongSplit) -> Iterator[tuple[int, int, Values]]:
    """Gather rows: the stream's place, the first frame, and the rows that are coded together."""
    names = {name: place for place, name in enumerate(parts.clip.streams)}
    waiting: dict[str, list[Values]] = {name: [] for name in names}
    first = dict.fromkeys(names, 0)

    def gathered(name: str, least: int) -> Iterator[tuple[int, int, Values]]:
        rows = waiting[name]
        if sum(part.size for part in rows) < least:
            return
        run = np.concatenate(rows) if len(rows) > 1 else rows[0]
        waiting[name] = []
        begin = first[name]
        first[name] += len(run)
        yield names[name], begin, run

    for part in parts.parts():
        for name, rows in part.items():
            waiting[name].append(rows)
            yield from gathered(name, _RUN)
    for name in names:
        yield from gathered(name, 1)


def _check(source: Source, file: LongFile) -> None:
    """See that the file comes back, reading no more of either than a part at a time."""
    try:
        opened = Opened(Source(file.path, limit=None))
        original = opened.mcz.original
        assert original is not None
        place = 0
        for piece in pieces(opened, original):
            if source.read(place, place + len(piece)) != piece:
                raise CorruptError("the file does not come back")
            place += len(piece)
    except CorruptError as error:
        raise VerificationError(f"a check failed ({error.what}); please report this") from error
