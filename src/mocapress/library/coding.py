"""Coding what is to be added: as a ``.mcz``, and as runs of what the library has."""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapress.api.clips import compress_clip
from mocapress.api.compressing import compress_parts, motion_file, unfit, with_other_numbers
from mocapress.api.encoding import coded_streams
from mocapress.api.opening import Opened
from mocapress.api.restoring import contents
from mocapress.codecs import Codec, Model
from mocapress.codecs.fallback import first_that_works
from mocapress.container import Mcz, MczWriter, open_mcz
from mocapress.errors import MocapressError, VerificationError
from mocapress.formats import Split, recognise
from mocapress.library.database import Database
from mocapress.library.opened import OpenedClip
from mocapress.library.rows import Run
from mocapress.library.sharing import Hashes, Known, Values, anchors, find_runs
from mocapress.models import Place
from mocapress.motion import Clip
from mocapress.source import Source


@dataclass(frozen=True, slots=True)
class Coded:
    """What a library is to hold of a clip."""

    mcz: Mcz
    """With the frames that are in no run."""
    kind: str | None = None
    """Id of the original's format; None where there is no original."""
    shape: tuple[int, ...] = (0, 0)
    """Frames and channels of its first stream."""
    runs: tuple[Run, ...] = ()
    hashes: Hashes | None = None
    """Anchors of the frames in its chunks; None where others are not to share them."""
    warning: str | None = None
    models: tuple[Model, ...] = ()
    """Those that decoding may need."""
    newest: int = 0
    """The newest clip of the library when it was coded."""
    clip: Clip | None = None
    """All its frames; None where it has none."""


@dataclass(frozen=True, slots=True)
class Coder:
    """Codes clips for a library."""

    db: Database
    known: Known
    codec: Codec
    model: Model | None = None
    models: Sequence[Place] = ()
    """Where models may be that ``.mcz`` files need."""

    def file(
        self,
        source: Source,
        parts: Split | None,
        digest: bytes,
        warning: str | None = None,
        without: int | None = None,
    ) -> Coded:
        """Code a file that was taken apart; nothing is shared with the clip ``without``."""
        kind = source.format.id if source.format else ""
        newest = 0
        hashes: Hashes | None = None
        runs: tuple[Run, ...] = ()
        clip = parts.clip if parts is not None and parts.clip.frames else None
        if parts is not None and clip is not None and not unfit(parts, source.size):
            newest, hashes, runs = self._runs(clip, digest, without)
        if parts is not None and clip is not None and runs:
            blob, failure = first_that_works(
                self.codec, lambda way: self._rest(source, parts, runs, way)
            )
            if blob is not None:
                rest = self._anchors(clip, runs)
                problems = [str(problem.error(source.name)) for problem in parts.problems]
                why = "; ".join(filter(None, (failure, *problems))) or None
                mcz = open_mcz(Source(blob))
                return Coded(
                    mcz, kind, clip.values.shape, runs, rest, why, self._models, newest, clip
                )
        made = compress_parts(
            source, parts, self.codec, with_skeleton=True, model=self.model, warning=warning
        )
        mcz = made.mcz or open_mcz(Source(made.blob))
        shape = clip.values.shape if clip else (0, 0)
        if not self.codec.lossless or mcz.head is None or not clip or not clip.values.size:
            hashes = None
        return Coded(mcz, kind, shape, (), hashes, made.warning, self._models, newest, clip)

    def clip(self, clip: Clip) -> Coded:
        """Code a clip."""
        made = compress_clip(clip, self.codec, model=self.model)
        mcz = made.mcz or open_mcz(Source(made.blob))
        hashes = self._anchors(clip, ())
        return Coded(mcz, None, clip.values.shape, (), hashes, None, self._models, clip=clip)

    def mcz(self, source: Source, without: int | None = None) -> Coded:
        """Take a ``.mcz`` as it is, once all of it is decoded and checked.

        Where another clip than ``without`` has all its frames, its chunks are left out.
        """
        opened = Opened(source, self.models)
        mcz = opened.mcz
        data = contents(opened, mcz.original) if mcz.original else b""
        newest = sys.maxsize  # where nothing is looked for, nothing can come too late
        if mcz.head is None:
            of = recognise(data, mcz.original.name if mcz.original else "")
            return Coded(mcz, of.id if of else "", newest=newest)
        values = [
            opened.rows(index).values if stream.columns else np.empty((opened.frames(index), 0))
            for index, stream in enumerate(opened.streams)
        ]
        first = values[0]
        lossless = all(opened.codec(index).lossless for index in range(len(opened.streams)))
        kind = mcz.original.format if mcz.original else None
        hashes = anchors(first) if first.size and lossless else None
        stream = opened.streams[0]
        clip = Clip.of(first, stream.columns, stream.frame_time, mcz.head.skeleton)
        if mcz.original is not None and hashes is not None:
            newest, runs = self._all_there(mcz.original.digest, hashes, values, without)
            if runs:
                rest = _without_chunks(mcz)
                return Coded(rest, kind, first.shape, runs, None, None, (), newest, clip)
        models = [opened.model(index) for index in range(len(opened.streams))]
        kept = tuple(model for model in models if model is not None)
        return Coded(mcz, kind, first.shape, (), hashes, None, kept, newest, clip)

    def _all_there(
        self, digest: bytes, hashes: Hashes, values: Sequence[Values], without: int | None
    ) -> tuple[int, tuple[Run, ...]]:
        """Give the newest clip, and runs that are all of another clip with the same numbers."""
        with self.db.reading() as connection:
            newest = self.known.refresh(connection)
            candidates = self.known.candidates(connection, digest, hashes)
            for other in candidates:
                if other != without and self._has(other, values):
                    frames = [len(stream) for stream in values]
                    runs = (Run.whole(i, n, other) for i, n in enumerate(frames) if n)
                    return newest, tuple(runs)
        return newest, ()

    def _has(self, other: int, values: Sequence[Values]) -> bool:
        """Say whether the chunks of a clip hold these numbers of all streams, without loss."""
        try:
            opened = OpenedClip(self.db, other, self.models)
            numbers = range(len(opened.streams))
            shapes = [(opened.own_frames(i), len(opened.streams[i].columns)) for i in numbers]
            return (
                shapes == [stream.shape for stream in values]
                and all(opened.codec(i).lossless for i in numbers)
                and all(
                    opened.own_rows(i).values.tobytes() == values[i].tobytes()
                    for i in numbers
                    if values[i].size
                )
            )
        except MocapressError:
            return False  # it is damaged, or gone

    @property
    def _models(self) -> tuple[Model, ...]:
        return () if self.model is None else (self.model,)

    def _runs(
        self, clip: Clip, digest: bytes, without: int | None
    ) -> tuple[int, Hashes, tuple[Run, ...]]:
        """Give the newest clip of the library, the anchors of a clip, and its runs."""
        hashes = anchors(clip.values)
        with self.db.reading() as connection:
            newest = self.known.refresh(connection)
            candidates = self.known.candidates(connection, digest, hashes)
            wanted = [other for other in candidates if other != without]
            if not self.codec.lossless:
                return newest, hashes, self._same_file(clip, digest, wanted)
            return newest, hashes, tuple(shared(self.db, clip, wanted, self.models))

    def _same_file(self, clip: Clip, digest: bytes, candidates: Sequence[int]) -> tuple[Run, ...]:
        """Find the equal file that was coded in the same way: a lossy codec gives the same."""
        frames = [stream.frames for stream in clip.streams.values()]
        for other in candidates:
            opened = OpenedClip(self.db, other, self.models)
            own = [opened.own_frames(index) for index in range(len(opened.streams))]
            if opened.facts.sha256 == digest and own == frames and opened.codec() == self.codec:
                return tuple(
                    Run.whole(index, of_stream, other)
                    for index, of_stream in enumerate(frames)
                    if of_stream
                )
        return ()

    def _rest(self, source: Source, parts: Split, runs: Sequence[Run], way: Codec) -> bytes:
        """Code the frames that are in no run, and the layout of all."""
        rest = without_runs(parts.clip, runs)
        model = self.model if way is self.codec else None
        streams = coded_streams(rest, way, model, parts.clip)
        if not way.lossless:  # it has the numbers of another clip, and is printed as that
            like = OpenedClip(self.db, runs[0].source, self.models)
            parts = with_other_numbers(parts, like.streams[0].columns)
            rest = rest.with_columns(parts.clip.columns)
        blob = motion_file(parts._replace(clip=rest), source, streams, model)
        opened = Opened(Source(blob), [model] if model else [])
        for index, (coded, stream) in enumerate(zip(streams, rest.streams.values(), strict=True)):
            decoded = opened.rows(index).values
            if coded.codec.lossless and decoded.tobytes() != stream.values.tobytes():
                raise VerificationError(f"codec {way.id} does not give the frames back")
        return blob

    def _anchors(self, clip: Clip, runs: Sequence[Run]) -> Hashes | None:
        own = without_runs(clip, runs).values
        return anchors(own) if self.codec.lossless and own.size else None


def _without_chunks(mcz: Mcz) -> Mcz:
    """Give a file that is the same but for its frames."""
    assert mcz.head is not None
    streams = [replace(stream, frames=0, model=b"") for stream in mcz.head.streams]
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.head(replace(mcz.head, streams=tuple(streams)))
    if mcz.original is not None:
        writer.original(mcz.original)
    for companion in mcz.companions:
        writer.companion(companion)
    if mcz.notes:
        writer.notes(mcz.notes)
    writer.end()
    return open_mcz(Source(b"".join(parts)))


def shared(
    db: Database, clip: Clip, candidates: Sequence[int], models: Sequence[Place]
) -> Iterator[Run]:
    """Give the runs of all streams of a clip."""
    for index, stream in enumerate(clip.streams.values()):
        yield from find_runs(db, index, stream.values, candidates, models)


def without_runs(clip: Clip, runs: Sequence[Run]) -> Clip:
    """Give a clip with only the frames that are in no run."""
    streams = {}
    for index, (name, stream) in enumerate(clip.streams.items()):
        free = np.ones(stream.frames, np.bool_)
        for run in runs:
            if run.stream == index:
                free[run.first : run.first + run.frames] = False
        streams[name] = stream if free.all() else replace(stream, values=stream.values[free])
    return replace(clip, streams=streams)
