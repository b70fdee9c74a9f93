"""Rows of a library's tables: once where they are equal, deleted when nothing needs them."""

import hashlib
import sqlite3
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate, pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs import Model
from mocapress.container import Mcz, pack, unpack
from mocapress.container.chunks import write_list
from mocapress.container.skeletons import write_skeleton
from mocapress.errors import CorruptError
from mocapress.library import names
from mocapress.library.schema import ALIKE, version_of
from mocapress.models import model_bytes
from mocapress.motion import Skeleton
from mocapress.records import Writer

Connection = sqlite3.Connection


class Facts(NamedTuple):
    """A row of ``clips`` but for its id and checksum: docs/format/library.md."""

    name: str
    format: str | None = None
    file: str | None = None
    frames: int = 0
    channels: int = 0
    frame_time: float | None = None
    size: int | None = None
    sha256: bytes | None = None
    modified: int | None = None
    skeleton: int | None = None
    text: int | None = None
    codec: str | None = None
    head: bytes | None = None
    problems: bytes | None = None
    layout: bytes | None = None


class Run(NamedTuple):
    """Frames of a stream of a clip that the same stream of another clip has."""

    stream: int
    """Its index."""
    first: int
    frames: int
    source: int
    """Id of the other clip."""
    source_first: int
    """Counted among the frames that the other has in chunks of its own."""

    @classmethod
    def whole(cls, stream: int, frames: int, source: int) -> "Run":
        """Give the run that is all of a stream."""
        return cls(stream, 0, frames, source, 0)


RUN_COLUMNS = ", ".join(Run._fields)


COLUMNS = ", ".join(Facts._fields)
_COLUMNS_BEFORE = ", ".join(Facts._fields[:-1])
_MOST_SAMPLE = 2**14
_MOST_LAYOUT = 128
"""Bytes up to which a layout stands in the row of its clip."""


def hash_of(data: bytes) -> int:
    """Give the hash by which equal texts and skeletons are found."""
    return int.from_bytes(hashlib.sha256(data).digest()[:8], "big", signed=True)


def checksum(facts: Facts) -> int:
    """Give the checksum of a row of ``clips``."""
    told = facts if facts.layout is not None else facts[:-1]  # older versions have no such column
    return zlib.crc32(b"".join(_bytes(value) + b"\0" for value in told))


def _bytes(value: Any) -> bytes:
    if value is None:
        return b""
    if isinstance(value, bytes):
        return value
    if isinstance(value, float):
        return struct.pack("<d", value)
    return str(value).encode(errors="surrogateescape")


def insert_clip(connection: Connection, facts: Facts) -> int:
    """Add a row to ``clips``; give its id."""
    marks = ", ".join(["CAST(? AS TEXT)", *"?" * (len(facts) - 1)])
    made = connection.execute(
        f"INSERT INTO clips({COLUMNS}, checksum) VALUES({marks}, ?)",
        [names.stored(facts.name), *facts[1:], checksum(facts)],
    )
    return int(made.lastrowid or 0)


def update_clip(connection: Connection, clip: int, facts: Facts) -> None:
    """Replace a row of ``clips``."""
    sets = ", ".join(f"{column} = ?" for column in Facts._fields[1:])
    connection.execute(
        f"UPDATE clips SET name = CAST(? AS TEXT), {sets}, checksum = ? WHERE id = ?",  # noqa: S608
        [names.stored(facts.name), *facts[1:], checksum(facts), clip],
    )


def read_clip(connection: Connection, clip: int) -> tuple[Facts, int] | None:
    """Give a row of ``clips`` and its checksum."""
    columns = COLUMNS if version_of(connection) >= ALIKE else f"{_COLUMNS_BEFORE}, NULL"
    row = connection.execute(
        f"SELECT {columns}, checksum FROM clips WHERE id = ?",  # noqa: S608
        [clip],
    ).fetchone()
    return None if row is None else (Facts(*row[:-1]), row[-1])


def text_id(connection: Connection, packed: bytes) -> int:
    """Give the row of a text, which is added where there is none yet."""
    wanted = hash_of(packed)
    row = connection.execute(
        "SELECT id FROM texts WHERE hash = ? AND packed = ?", (wanted, packed)
    ).fetchone()
    if row is None:
        made = connection.execute("INSERT INTO texts(hash, packed) VALUES(?, ?)", (wanted, packed))
        return int(made.lastrowid or 0)
    return int(row[0])


def skeleton_hash(skeleton: Skeleton) -> int:
    """Give the hash by which a skeleton is found."""
    writer = Writer()
    write_skeleton(writer, skeleton)
    return hash_of(bytes(writer.data))


def skeleton_id(
    connection: Connection, record: bytes, name: str, joints: int, sample: bytes = b""
) -> int:
    """Give the row of a skeleton, which is added where there is none yet; see ``write_parts``.

    ``sample`` is what its clips are likely to have: a head and a layout.
    """
    wanted = hash_of(record)
    # There are few: an index would cost more than it brings.
    for number, packed in connection.execute(
        "SELECT id, record FROM skeletons WHERE hash = ?", [wanted]
    ):
        if unpack(packed, "skeleton", len(record)) == record:
            return int(number)
    made = connection.execute(
        "INSERT INTO skeletons(name, joints, hash, record, sample) VALUES(?, ?, ?, ?, ?)",
        (name, joints, wanted, pack(record), _packed_sample(sample)),
    )
    return int(made.lastrowid or 0)


def _packed_sample(sample: bytes) -> bytes | None:
    if not 0 < len(sample) <= _MOST_SAMPLE:
        return None
    packed = pack(sample)
    return zlib.crc32(packed).to_bytes(4, "little") + packed


def sample_of(connection: Connection, skeleton: int | None) -> bytes:
    """Give what heads and layouts of the clips of a skeleton are packed beside.

    Raises
    ------
    CorruptError
        When it is damaged.

    """
    if skeleton is None or version_of(connection) < ALIKE:
        return b""
    row = connection.execute("SELECT sample FROM skeletons WHERE id = ?", [skeleton]).fetchone()
    if row is None or row[0] is None:
        return b""
    crc, packed = row[0][:4], row[0][4:]
    if zlib.crc32(packed).to_bytes(4, "little") != crc:
        raise CorruptError(f"damaged: row {skeleton} of skeletons")
    return unpack(packed, "sample", _MOST_SAMPLE)


def packed_head(connection: Connection, skeleton: int | None, streams: bytes) -> bytes:
    """Give the streams of a head as a clip of a skeleton has them; see ``write_parts``."""
    return pack(streams, beside=sample_of(connection, skeleton))


def with_text(connection: Connection, facts: Facts, packed: bytes, layout: bytes | None) -> Facts:
    """Say where the text of a clip is: in its row, where little of it is its own.

    Parameters
    ----------
    connection
        Of the library.
    facts
        Of the clip.
    packed
        The text as a ``.mcz`` has it.
    layout
        The same, not packed, where it is one that may be like others of its skeleton.

    """
    if layout is not None and len(layout) <= _MOST_SAMPLE and facts.skeleton is not None:
        alike = pack(layout, beside=sample_of(connection, facts.skeleton))
        if len(alike) <= _MOST_LAYOUT:
            return facts._replace(layout=alike)
    return facts._replace(text=text_id(connection, packed))


def add_model(connection: Connection, model: Model) -> None:
    """Keep a model, where it is not kept yet."""
    connection.execute(
        "INSERT OR IGNORE INTO models(digest, codec, file) VALUES(?, ?, ?)",
        (model.digest, model.codec, model_bytes(model)),
    )


def companion_id(
    connection: Connection,
    name: str,
    kind: str,
    data: bytes,
    packed: Callable[[], bytes],
    modified: int | None,
) -> int:
    """Give the row of a companion, which is added, or changed where its contents are others."""
    digest = hashlib.sha256(data).digest()
    row = connection.execute(
        "SELECT id, sha256, text FROM companions WHERE name = CAST(? AS TEXT)",
        [names.stored(name)],
    ).fetchone()
    if row is not None and row[1] == digest:
        return int(row[0])
    text = text_id(connection, packed())
    values = (kind, len(data), digest, modified, text)
    if row is None:
        made = connection.execute(
            "INSERT INTO companions(name, format, size, sha256, modified, text) "
            "VALUES(CAST(? AS TEXT), ?, ?, ?, ?, ?)",
            (names.stored(name), *values),
        )
        return int(made.lastrowid or 0)
    connection.execute(
        "UPDATE companions SET format = ?, size = ?, sha256 = ?, modified = ?, text = ? "
        "WHERE id = ?",
        (*values, row[0]),
    )
    drop_text(connection, row[2])
    return int(row[0])


def insert_chunks(connection: Connection, clip: int, mcz: Mcz) -> None:
    """Add the chunks of a file as they are."""
    if not mcz.entries:
        return
    sections = [mcz.ranges.read(entry.begin, entry.end) for entry in mcz.entries]
    places = pairwise(accumulate(map(len, sections), initial=0))
    moved = [
        entry._replace(begin=begin, end=end)
        for entry, (begin, end) in zip(mcz.entries, places, strict=True)
    ]
    connection.execute(
        "INSERT INTO chunks VALUES(?, ?, ?)", (clip, write_list(moved), b"".join(sections))
    )


def insert_runs(connection: Connection, clip: int, runs: Sequence[Run]) -> None:
    """Add runs of a clip."""
    connection.executemany(
        "INSERT INTO runs(clip, stream, first, frames, source, source_first) "
        "VALUES(?, ?, ?, ?, ?, ?)",
        [(clip, *run) for run in runs],
    )


def insert_notes(connection: Connection, clip: int, notes: Mapping[str, str]) -> None:
    """Set what is said about a clip."""
    connection.executemany(
        "INSERT OR REPLACE INTO notes VALUES(?, ?, ?)",
        [(clip, key, value) for key, value in notes.items()],
    )


def insert_labels(connection: Connection, clip: int, labels: Sequence[str]) -> None:
    """Give a clip labels beside those that it has."""
    connection.executemany(
        "INSERT OR IGNORE INTO labels VALUES(?, ?)", [(clip, label) for label in labels]
    )


def insert_belongs(connection: Connection, clip: int, companion: int) -> None:
    """Say that a clip has a companion."""
    connection.execute("INSERT OR IGNORE INTO belongs VALUES(?, ?)", (clip, companion))


def insert_anchors(connection: Connection, clip: int, hashes: NDArray[np.uint32] | None) -> None:
    """Keep by what frames of a clip are found."""
    if hashes is not None:
        data = hashes.astype("<u4").tobytes()
        connection.execute("INSERT INTO anchors VALUES(?, ?)", (clip, data))


def drop_contents(connection: Connection, clip: int) -> None:
    """Delete what a clip has in chunks and runs, and by what it is found."""
    for table in ("chunks", "runs", "needs", "anchors"):
        connection.execute(f"DELETE FROM {table} WHERE clip = ?", [clip])  # noqa: S608


def drop_clip(connection: Connection, clip: int) -> None:
    """Delete a clip that no other refers to, and what only it needed."""
    drop_contents(connection, clip)
    found = read_clip(connection, clip)
    if found is None:
        return
    facts = found[0]
    companions = connection.execute(
        "SELECT companion FROM belongs WHERE clip = ?", [clip]
    ).fetchall()
    for table in ("belongs", "labels", "notes"):
        connection.execute(f"DELETE FROM {table} WHERE clip = ?", [clip])  # noqa: S608
    connection.execute("DELETE FROM clips WHERE id = ?", [clip])
    drop_text(connection, facts.text)
    if facts.skeleton is not None:
        connection.execute(
            "DELETE FROM skeletons WHERE id = ? AND NOT EXISTS"
            "(SELECT 1 FROM clips WHERE skeleton = skeletons.id)",
            [facts.skeleton],
        )
    for (companion,) in companions:
        row = connection.execute(
            "DELETE FROM companions WHERE id = ? AND NOT EXISTS"
            "(SELECT 1 FROM belongs WHERE companion = companions.id) RETURNING text",
            [companion],
        ).fetchone()
        drop_text(connection, row and row[0])


def drop_text(connection: Connection, text: int | None) -> None:
    """Delete a text that nothing needs any more."""
    if text is not None:
        connection.execute(
            "DELETE FROM texts WHERE id = ? "
            "AND NOT EXISTS(SELECT 1 FROM clips WHERE text = texts.id) "
            "AND NOT EXISTS(SELECT 1 FROM companions WHERE text = texts.id)",
            [text],
        )
