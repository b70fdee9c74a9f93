"""A compressed file, opened: its streams are decoded as far as they are asked for."""

import zlib
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.codecs import NO_OTHERS, Chunk, Codec, Model, Others
from mocapress.container import CodedChunk, Damage, Entry, Mcz, StreamHead, open_mcz
from mocapress.errors import CorruptError, MissingModelError, MocapressError, ParameterError
from mocapress.models import Place, find_model
from mocapress.source import Source

_RUN = 2**21
"""Numbers that are decoded together where the whole is worked on in parts."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Decoded frames of a stream."""

    values: NDArray[np.float64]
    """(F, C); zeros in rows that are lost, which take no memory as long as nobody writes there."""
    kept: NDArray[np.bool_]
    """(F,) whether a row is what was coded."""

    def filled(self) -> NDArray[np.float64]:
        """Give all rows, NaN in those that are lost."""
        if not self.kept.all():
            self.values[~self.kept] = np.nan
        return self.values


class Opened:
    """A ``.mcz`` file.

    Parameters
    ----------
    source
        The file.
    models
        Where models may be; then beside the file, then in the folders of ``MOCAPRESS_MODELS``.
    salvage
        Whether to go on where something is damaged, and list it in ``damage``.

    Raises
    ------
    CorruptError
        When it is no such file, or what stands before its chunks is damaged.

    """

    def __init__(
        self, source: Source, models: Sequence[Place] = (), *, salvage: bool = False
    ) -> None:
        self.source, self.salvage = source, salvage
        self.mcz: Mcz = open_mcz(source, salvage=salvage)
        self._places = models
        self._codecs: dict[int, Codec] = {}
        self._models: dict[int, Model | None] = {}

    @property
    def damage(self) -> list[Damage]:
        """What could not be read so far."""
        return self.mcz.damage

    def warn_of_losses(self) -> None:
        """Warn of each part of the file that could not be read."""
        for where, error in self.damage:
            what = f"lost: {where} ({error.what})"
            fact = CorruptError(what, file=self.source.name or None, offset=error.offset)
            self.source.warn("lost", fact)

    @property
    def streams(self) -> tuple[StreamHead, ...]:
        """What the file says about its streams."""
        return self.mcz.head.streams if self.mcz.head else ()

    def frames(self, stream: int = 0) -> int:
        """Give how many frames a stream has."""
        return self.mcz.frames(stream)

    def bytes_of(self, stream: int, frames: int) -> int:
        """Give how many bytes so many frames of a stream are, decoded."""
        return 8 * frames * max(len(self.streams[stream].columns), 1)

    def codec(self, stream: int = 0) -> Codec:
        """Give the codec of a stream."""
        if stream not in self._codecs:
            spec, header = self.streams[stream].codec, self.streams[stream].header
            try:
                stored = codecs.from_parameters(spec.id, spec.parameters)
                self._codecs[stream] = stored.as_told(header)
            except ParameterError as error:
                raise CorruptError(f"stream {self.streams[stream].name!r}: {error}") from error
        return self._codecs[stream]

    def model(self, stream: int = 0) -> Model | None:
        """Give the model that a stream needs, if it needs one."""
        if stream not in self._models:
            self._models[stream] = self._find_model(stream)
        return self._models[stream]

    def _find_model(self, stream: int) -> Model | None:
        digest = self.streams[stream].model
        if not digest:
            return None
        folder = self.source.path.parent if self.source.path else None
        model = find_model(digest, self._places, folder)
        try:
            codecs.learner(self.codec(stream), model)
        except ParameterError as error:
            raise CorruptError(f"stream {self.streams[stream].name!r}: {error}") from error
        return model

    def rows(self, stream: int = 0, first: int = 0, last: int | None = None) -> Rows:
        """Decode frames [first, last) of a stream, and as few others as that needs.

        Raises
        ------
        CorruptError
            When a chunk is damaged, unless the file was opened to be salvaged.
        MissingModelError
            When the model that the stream needs is nowhere.
        UnsupportedError
            When they are more than the source's limit allows.

        """
        head = self.streams[stream]
        last = self.mcz.frames(stream) if last is None else last
        self.source.allow(self.bytes_of(stream, max(last - first, 0)))
        groups = _groups(self.mcz.of_stream[stream], first, last, alone=self.salvage)
        if len(groups) == 1 and not self.salvage:
            begin = first - groups[0][0].first
            rows = self._decode(stream, groups[0], last)[begin:]
            return Rows(rows, np.ones(len(rows), np.bool_))
        values = np.zeros((max(last - first, 0), len(head.columns)))
        kept = np.zeros(len(values), np.bool_)
        for group in groups:
            try:
                rows = self._decode(stream, group, last)
                begin, end = max(group[0].first, first), group[0].first + len(rows)
                values[begin - first : end - first] = rows[begin - group[0].first :]
                kept[begin - first : end - first] = True
            except MissingModelError:
                raise
            except MocapressError as error:
                if not self.salvage:
                    raise
                frames = f"frames {group[0].first} to {group[-1].last - 1}"
                self.damage.append(Damage(f"{frames} of stream {head.name}", error))
        if self.salvage:
            self._name_gaps(stream, first, last)
        return Rows(values, kept)

    def run_at(self, stream: int, frame: int) -> tuple[int, int]:
        """Give the frames that are best decoded together with one: whole chunks, not too many."""
        entries, columns = self.mcz.of_stream[stream], len(self.streams[stream].columns)
        last = self.frames(stream)
        if not entries:
            return 0, last
        start = max(bisect_right(entries, frame, key=lambda entry: entry.first) - 1, 0)
        while start > 0 and not entries[start].restart:
            start -= 1
        begin = min(entries[start].first, last)
        most = begin + _RUN // max(columns, 1)
        for entry in entries[start + 1 :]:
            if entry.restart and entry.last > most and entry.first > frame:
                return begin, min(entry.first, last)
        return begin, last

    def _name_gaps(self, stream: int, first: int, last: int) -> None:
        """List frames of which there are no chunks."""
        reached = 0
        for begin, end in [
            *((entry.first, entry.last) for entry in self.mcz.of_stream[stream]),
            (self.mcz.frames(stream), 0),
        ]:
            lost = range(max(reached, first), min(begin, last))
            if lost:
                where = f"frames {lost[0]} to {lost[-1]} of stream {self.streams[stream].name}"
                self.damage.append(Damage(where, CorruptError("no chunk has them")))
            reached = end

    def coded(self, stream: int = 0) -> tuple[Chunk, ...]:
        """Give all chunks of a stream as its codec made them."""
        return tuple(
            Chunk(entry.first, entry.frames, chunk.payload, entry.restart, chunk.needs)
            for entry in self.mcz.of_stream[stream]
            for chunk in [self.mcz.read_chunk(entry)]
        )

    def needed(self, stream: int, digests: Sequence[bytes]) -> Others:  # noqa: ARG002
        """Give the frames of other chunks that chunks of a stream need.

        Raises
        ------
        CorruptError
            When they are nowhere.

        """
        raise CorruptError(
            "a chunk needs frames of other clips, which only its library has",
            expected="a file written by 'mocapress library export', which needs none",
        )

    def _decode(self, stream: int, group: Sequence[Entry], last: int) -> NDArray[np.float64]:
        """Decode successive chunks with one codec header, the first of them a restart.

        Gives their frames up to ``last``.
        """
        if not group[0].restart or any(a.last != b.first for a, b in pairwise(group)):
            raise CorruptError(f"a chunk before frame {group[-1].first} is missing")
        read: list[CodedChunk] = [self.mcz.read_chunk(entry) for entry in group]
        chunks = [
            Chunk(
                chunk.entry.first,
                chunk.entry.frames,
                chunk.payload,
                chunk.entry.restart,
                chunk.needs,
            )
            for chunk in read
        ]
        head = self.streams[stream]
        header = read[0].header if group[0].own_header else head.header
        stop = min(last, group[-1].last) - group[0].first
        digests = [digest for chunk in read for digest in chunk.needs]
        others = self.needed(stream, digests) if digests else NO_OTHERS
        codec, model = self.codec(stream), self.model(stream)
        values = decoded(codec, header, chunks, head, model, stop, others)
        for chunk in read:
            begin = chunk.entry.first - group[0].first
            rows = values[begin : begin + chunk.entry.frames]
            if len(rows) == chunk.entry.frames and digest(rows) != chunk.digest:
                raise CorruptError(
                    f"frames {chunk.entry.first} to {chunk.entry.last - 1}: wrong digest",
                    offset=chunk.entry.begin,
                    expected=f"{chunk.digest:08x}",
                    found=f"{digest(rows):08x}",
                )
        return values


def decoded(
    codec: Codec,
    header: bytes,
    chunks: Sequence[Chunk],
    head: StreamHead,
    model: Model | None,
    stop: int,
    others: Others = NO_OTHERS,
) -> NDArray[np.float64]:
    """Decode the first ``stop`` frames of successive chunks, the first a restart: (stop, C).

    Raises
    ------
    CorruptError
        When they do not follow the codec's format.

    """
    values = codec.decode(header, chunks, head.columns, model=model, others=others, stop=stop)
    expected = stop, len(head.columns)
    if values.shape != expected:
        raise CorruptError("decoded values", expected=str(expected), found=str(values.shape))
    return values


def digest(rows: NDArray[np.float64]) -> int:
    """Give what a chunk's values are recognised by: CRC-32 of the little-endian doubles."""
    return zlib.crc32(np.ascontiguousarray(rows, dtype="<f8").data)


def _groups(entries: Sequence[Entry], first: int, last: int, *, alone: bool) -> list[list[Entry]]:
    """Give the chunks that hold frames [first, last) and those that these need.

    Chunks of one codec header come together; ``alone``: only those that need each other.
    """
    if last <= first or not entries:
        return []
    start = max(bisect_right(entries, first, key=lambda entry: entry.first) - 1, 0)
    stop = bisect_left(entries, last, key=lambda entry: entry.first)
    while start > 0 and not entries[start].restart:
        start -= 1
    groups: list[list[Entry]] = []
    for entry in entries[start:stop]:
        own = entry.own_header or bool(groups and groups[-1][0].own_header)
        if not groups or (entry.restart and (alone or own)):
            groups.append([])
        groups[-1].append(entry)
    return groups
