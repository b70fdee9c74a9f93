"""Clips of a library, opened: what they have in chunks of their own, and what others have."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from mocapress.api.opening import Opened, Rows
from mocapress.codecs import Model, Others
from mocapress.container import Damage, Head
from mocapress.container.limits import most_values
from mocapress.errors import CorruptError
from mocapress.library.database import Database
from mocapress.library.needs import Ancestry, needed_rows
from mocapress.library.rows import RUN_COLUMNS, Facts, Run
from mocapress.library.stored import StoredMcz
from mocapress.models import Place, load_model


class OpenedClip(Opened):
    """A clip of a library: what it has in chunks of its own, and its runs of other clips.

    Parameters
    ----------
    db, clip
        The library, and the clip's id.
    models
        Where models may be that the library lacks.
    salvage
        Whether to go on where something is damaged, and list it in ``damage``.
    ancestry
        Of the clip of which chunks need this one.

    Raises
    ------
    CorruptError
        When it is damaged.
    ParameterError
        When there is no such clip.

    """

    def __init__(
        self,
        db: Database,
        clip: int,
        models: Sequence[Place] = (),
        *,
        salvage: bool = False,
        ancestry: Ancestry | None = None,
    ) -> None:
        self.db, self.clip = db, clip
        self.stored = StoredMcz(db, clip, salvage=salvage)
        self._others: dict[int, OpenedClip] = {}
        self.ancestry = Ancestry() if ancestry is None else ancestry
        self._given = models
        super().__init__(self.stored, models, salvage=salvage)
        names = {stream.model for stream in self.streams} - {b""}
        kept = [self._kept_model(digest) for digest in sorted(names)]
        self._places = [*models, *(model for model in kept if model is not None)]
        self.runs = [*self._find_runs()]
        self._check_runs()

    @property
    def facts(self) -> Facts:
        """What the library says of the clip."""
        return self.stored.facts

    def _kept_model(self, digest: bytes) -> Model | None:
        row = self.db.connection.execute(
            "SELECT file FROM models WHERE digest = ?", [digest]
        ).fetchone()
        return None if row is None else load_model(row[0])

    def _find_runs(self) -> Iterator[Run]:
        # Where the clip has all its frames itself, nothing else is asked.
        if not self.streams or (len(self.streams) == 1 and super().frames() == self.facts.frames):
            return
        for row in self.db.connection.execute(
            f"SELECT {RUN_COLUMNS} FROM runs WHERE clip = ? ORDER BY stream, first",  # noqa: S608
            [self.clip],
        ):
            yield Run(*row)

    def _check_runs(self) -> None:
        """See that the runs lie one behind the other, before memory is asked for them."""
        fault = CorruptError("damaged: the runs of other clips", file=self.facts.name)
        values = 0
        for index, stream in enumerate(self.streams):
            reached = 0
            for run in self.runs_of(index):
                if run.first < reached or run.frames < 1 or run.source_first < 0:
                    raise fault
                reached = run.first + run.frames
            frames = self.frames(index)
            values += frames * max(len(stream.columns), 1)
            if reached > frames:
                raise fault
        shared = self.runs and values > most_values(self.db.path.stat().st_size)
        unknown = any(run.stream not in range(len(self.streams)) for run in self.runs)
        if shared or unknown:
            raise fault
        if self.streams and self.frames() != self.facts.frames and not self.salvage:
            raise fault

    def runs_of(self, stream: int) -> list[Run]:
        """Give the runs of a stream, in the order of its frames."""
        return [run for run in self.runs if run.stream == stream]

    def whole_source(self) -> "OpenedClip | None":
        """Give the clip whose frames in chunks are all the frames of this one, if there is one."""
        sources = {run.source for run in self.runs}
        if len(sources) != 1:
            return None
        other = self.other(*sources)
        # Decoders go by the columns, too.
        alike = [stream.columns for stream in other.streams] == [
            stream.columns for stream in self.streams
        ]
        whole = [
            Run.whole(index, other.own_frames(index), other.clip)
            for index in range(len(other.streams))
            if other.own_frames(index)
        ]
        nothing_own = not any(self.own_frames(index) for index in range(len(self.streams)))
        return other if alike and nothing_own and whole == self.runs and not other.runs else None

    def own_frames(self, stream: int = 0) -> int:
        """Give how many frames of a stream are in chunks of the clip."""
        return super().frames(stream)

    def own_rows(self, stream: int = 0, first: int = 0, last: int | None = None) -> Rows:
        """Decode frames of a stream that are in chunks of the clip, counted among these."""
        return super().rows(stream, first, last)

    def frames(self, stream: int = 0) -> int:
        """Give how many frames a stream has."""
        return self.own_frames(stream) + sum(run.frames for run in self.runs_of(stream))

    def rows(self, stream: int = 0, first: int = 0, last: int | None = None) -> Rows:
        """Decode frames [first, last) of a stream; see ``Opened.rows``."""
        if not self.runs_of(stream):
            return super().rows(stream, first, last)
        last = self.frames(stream) if last is None else last
        values = np.zeros((max(last - first, 0), len(self.streams[stream].columns)))
        kept = np.zeros(len(values), np.bool_)
        for begin, end, source, source_first in self._pieces(stream):
            start, stop = max(begin, first), min(end, last)
            if start < stop:
                offset = source_first - begin
                rows = self._rows_of(source, stream, start + offset, stop + offset)
                place = values[start - first : stop - first]
                np.copyto(place, rows.values, where=rows.kept[:, None])
                kept[start - first : stop - first] = rows.kept
        return Rows(values, kept)

    def _pieces(self, stream: int) -> list[tuple[int, int, int, int]]:
        """Give all frames in pieces: first, behind the last, whose, and where among these."""
        pieces = []
        reached = own = 0
        end = Run(stream, self.frames(stream), 0, self.clip, 0)
        for run in [*self.runs_of(stream), end]:
            if run.first > reached:
                pieces.append((reached, run.first, self.clip, own))
                own += run.first - reached
            reached = run.first + run.frames
            pieces.append((run.first, reached, run.source, run.source_first))
        return pieces

    def _rows_of(self, clip: int, stream: int, first: int, last: int) -> Rows:
        if clip == self.clip:
            return self.own_rows(stream, first, last)
        other = self.other(clip)
        columns = len(self.streams[stream].columns)
        if (
            stream >= len(other.streams)
            or last > other.own_frames(stream)
            or len(other.streams[stream].columns) != columns
        ):
            raise CorruptError("damaged: a run of frames that are not there", file=self.facts.name)
        seen = len(other.damage)
        rows = other.own_rows(stream, first, last)
        self.damage.extend(
            Damage(f"{where} of clip {other.facts.name}", error)
            for where, error in other.damage[seen:]
        )
        return rows

    def other(self, clip: int) -> "OpenedClip":
        """Open another clip of the library, of which this one has or needs frames."""
        if clip not in self._others:
            self._others[clip] = OpenedClip(
                self.db, clip, self._given, salvage=self.salvage, ancestry=self.ancestry
            )
        return self._others[clip]

    def needed(self, stream: int, digests: Sequence[bytes]) -> Others:
        """Decode the frames of other chunks that chunks of a stream need."""
        return needed_rows(self, stream, digests)

    @property
    def dependent(self) -> bool:
        """Whether chunks of the clip need frames of others, of this clip or of another."""
        return any(entry.dependent for entry in self.mcz.entries)


def inherited(heir: OpenedClip, other: OpenedClip) -> Head:
    """Give the head of a clip that has the chunks of another for its own."""
    assert heir.mcz.head is not None
    streams = (
        replace(own, frames=coded.frames, codec=coded.codec, model=coded.model, header=coded.header)
        for own, coded in zip(heir.streams, other.streams, strict=True)
    )
    return Head(tuple(streams), heir.mcz.head.skeleton)
