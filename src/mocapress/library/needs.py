"""Frames that chunks of a library need of other chunks: where they are, and decoding them."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs import digest_of
from mocapress.errors import CorruptError
from mocapress.library.rows import Connection

if TYPE_CHECKING:
    from mocapress.library.opened import OpenedClip

_DEEPEST = 32
_MOST_FRAMES = 1 << 20
"""That are decoded in a row because others need them; no writer comes near."""
_KEPT = 64


class Need(NamedTuple):
    """Frames that chunks of a clip need."""

    digest: bytes
    stream: int
    """Index of the stream, in both clips."""
    source: int
    """Id of the clip that has them, which may be the same."""
    source_first: int
    """Counted among the frames that this clip has in chunks of its own."""
    frames: int


NEED_COLUMNS = ", ".join(Need._fields)


def insert_needs(connection: Connection, clip: int, needs: Sequence[Need]) -> None:
    """Say where the frames are that chunks of a clip need."""
    connection.executemany(
        "INSERT INTO needs(clip, digest, stream, source, source_first, frames) "
        "VALUES(?, ?, ?, ?, ?, ?)",
        [(clip, *need) for need in needs],
    )


def find_need(connection: Connection, clip: int, digest: bytes) -> Need | None:
    """Say where frames are that a clip needs."""
    row = connection.execute(
        f"SELECT {NEED_COLUMNS} FROM needs WHERE clip = ? AND digest = ?",  # noqa: S608
        (clip, digest),
    ).fetchone()
    return None if row is None else Need(*row)


def needing(connection: Connection, clips: Sequence[int]) -> list[int]:
    """Give the other clips of which chunks need frames of these."""
    found = {
        int(clip)
        for source in clips
        for (clip,) in connection.execute("SELECT clip FROM needs WHERE source = ?", [source])
    }
    return sorted(found - {*clips})


class Ancestry:
    """What is being decoded because something else needs it: shared by the clips that it leads to.

    A library from elsewhere may lead in circles, or ask for the same frames without end.
    """

    def __init__(self) -> None:
        self._depth = 0
        self._frames = 0
        self._kept: dict[bytes, NDArray[np.float64]] = {}

    @contextmanager
    def entered(self, need: Need, name: str) -> Iterator[None]:
        """Go one step further up.

        Raises
        ------
        CorruptError
            Where that leads too far.

        """
        if self._depth == 0:
            self._frames = 0
        self._frames += need.frames
        if self._depth >= _DEEPEST or not 0 < need.frames <= _MOST_FRAMES - self._frames:
            raise CorruptError("damaged: chunks that need each other without end", file=name)
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1

    def kept(self, digest: bytes) -> NDArray[np.float64] | None:
        """Give frames that were decoded lately."""
        return self._kept.get(digest)

    def keep(self, digest: bytes, rows: NDArray[np.float64]) -> None:
        """Keep frames for a while: neighbouring chunks often need the same."""
        while len(self._kept) >= _KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[digest] = rows


def needed_rows(
    opened: "OpenedClip", stream: int, digests: Sequence[bytes]
) -> Mapping[bytes, NDArray[np.float64]]:
    """Decode what chunks of a clip need.

    Raises
    ------
    CorruptError
        When it is not there, or not what it was.

    """
    return {digest: _rows(opened, stream, digest) for digest in digests}


def _rows(opened: "OpenedClip", stream: int, digest: bytes) -> NDArray[np.float64]:
    kept = opened.ancestry.kept(digest)
    if kept is not None:
        return kept
    name = opened.facts.name
    need = find_need(opened.db.connection, opened.clip, digest)
    if need is None or need.stream != stream:
        raise CorruptError("frames that a chunk needs are nowhere", file=name)
    with opened.ancestry.entered(need, name):
        source = opened if need.source == opened.clip else opened.other(need.source)
        last = need.source_first + need.frames
        there = stream < len(source.streams) and need.source_first >= 0
        if not there or last > source.own_frames(stream):
            raise CorruptError("frames that a chunk needs are not there", file=name)
        rows = source.own_rows(stream, need.source_first, last).values
    if digest_of(rows) != digest:
        raise CorruptError(f"frames of clip {source.facts.name}, which it needs, differ", file=name)
    opened.ancestry.keep(digest, rows)
    return rows
