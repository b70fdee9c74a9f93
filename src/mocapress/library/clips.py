"""Clips of a library as its users see them. Imports little, so that lists are quick."""

import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mocapress.errors import ParameterError
from mocapress.library import names

if TYPE_CHECKING:
    from mocapress.library.reading import Reading
    from mocapress.motion import Clip

_FACTS = (
    "id, clips.name, format, frames, channels, frame_time, size, sha256, modified, codec, "
    "(SELECT name FROM skeletons WHERE skeletons.id = clips.skeleton), "
    "(SELECT group_concat(label, char(0)) FROM labels WHERE labels.clip = clips.id)"
)


@dataclass(frozen=True, slots=True)
class StoredClip:
    """A clip in a library: facts about it now, its numbers when they are asked for.

    Attributes
    ----------
    library
        Path of its library.
    id
        Stays the clip's as long as it is there, and is never another's.
    name
        In the library.
    format
        Id of the original's format; empty where it is no motion, or there is no original.
    frames
        Number of frames, F.
    channels
        Number of channels, C.
    frame_time
        Seconds, rounded to a double; None where the source does not say.
    size
        Bytes of the original; None where there is none.
    sha256
        Of the original file.
    modified
        When the original was last changed, in nanoseconds since 1970.
    codec
        With its parameters.
    skeleton
        Name of the skeleton.
    labels
        Of the clip, in order.

    """

    library: "Reading | None" = field(repr=False, compare=False)
    id: int
    name: str
    format: str
    frames: int
    channels: int
    frame_time: float | None
    size: int | None
    sha256: str | None
    modified: int | None
    codec: str | None
    skeleton: str | None
    labels: tuple[str, ...]

    @property
    def _open(self) -> "Reading":
        assert self.library is not None  # only lists are made without
        return self.library

    @property
    def duration(self) -> float | None:
        """Seconds; None where the frame time is not known."""
        return None if self.frame_time is None else self.frames * self.frame_time

    @property
    def notes(self) -> dict[str, str]:
        """What is said about the clip."""
        with self._open.db.reading() as connection:
            return dict(
                connection.execute(
                    "SELECT key, value FROM notes WHERE clip = ? ORDER BY key", [self.id]
                )
            )

    def load(self, frames: slice | None = None, *, columns: Sequence[str] | None = None) -> "Clip":
        """Give the clip, or some of it; see ``Library.load``."""
        return self._open.load(self, frames, columns=columns)

    def read_bytes(self) -> bytes:
        """Give the original file; see ``Library.read_bytes``."""
        return self._open.read_bytes(self)


def select(
    library: "Reading | None",
    connection: sqlite3.Connection,
    patterns: Sequence[str] = (),
    *,
    label: str | None = None,
    min_duration: float | None = None,
    skeleton: str | None = None,
    order: str = "name",
) -> list[StoredClip]:
    """Give clips that fulfil all conditions; see ``Library.clips``."""
    where, values = _condition(patterns, label, min_duration, skeleton)
    rows = connection.execute(
        f"SELECT {_FACTS} FROM clips WHERE {where} ORDER BY {order}",  # noqa: S608
        values,
    )
    return [_stored(library, row) for row in rows]


def names_of(
    connection: sqlite3.Connection, patterns: Sequence[str] = (), *, label: str | None = None
) -> list[str]:
    """Give the names of clips that fulfil all conditions, in order."""
    where, values = _condition(patterns, label)
    rows = connection.execute(
        f"SELECT name FROM clips WHERE {where} ORDER BY name",  # noqa: S608
        values,
    )
    return [name for (name,) in rows]


def _condition(
    patterns: Sequence[str],
    label: str | None = None,
    min_duration: float | None = None,
    skeleton: str | None = None,
) -> tuple[str, list[Any]]:
    """Give the SQL that all conditions make, and its parameters."""
    where, values = names.condition(patterns)
    conditions = [f"({where})"]
    if label is not None:
        conditions.append("id IN (SELECT clip FROM labels WHERE label = ?)")
        values.append(label)
    if min_duration is not None:
        conditions.append("frames * frame_time >= ?")
        values.append(min_duration)
    if skeleton is not None:
        conditions.append("skeleton IN (SELECT id FROM skeletons WHERE name GLOB ?)")
        values.append(skeleton)
    return " AND ".join(conditions), values


def by_id(library: "Reading", connection: sqlite3.Connection, clip: int) -> StoredClip:
    """Give the clip of an id.

    Raises
    ------
    ParameterError
        When there is none.

    """
    row = connection.execute(
        f"SELECT {_FACTS} FROM clips WHERE id = ?",  # noqa: S608
        [clip],
    ).fetchone()
    if row is None:
        raise ParameterError("no such clip", file=library.location, found=f"id {clip}")
    return _stored(library, row)


def _stored(library: "Reading | None", row: Sequence[Any]) -> StoredClip:
    number, name, kind, frames, channels, time, size, sha256, modified, codec, skeleton, labels = (
        row
    )
    return StoredClip(
        library,
        number,
        name,
        kind or "",
        frames,
        channels,
        time,
        size,
        None if sha256 is None else sha256.hex(),
        modified,
        codec,
        skeleton,
        tuple(sorted(labels.split("\0"))) if labels else (),
    )
