"""Clips of a library as ``.mcz`` files of their own."""

from dataclasses import replace

from mocapress.api.clips import compress_clip
from mocapress.container import Companion, Head, Mcz, MczWriter, open_mcz, pack, unpack
from mocapress.container.limits import most_companions
from mocapress.library.database import Database
from mocapress.library.opened import OpenedClip, inherited
from mocapress.motion import Clip, Stream
from mocapress.source import Source


def export(db: Database, opened: OpenedClip) -> bytes:
    """Give a clip as a ``.mcz`` that holds everything it needs but models.

    Chunks are taken as they are. A clip with runs of others is coded again, unless its frames are
    all that another has in its chunks; so is one of which chunks need frames of others.
    """
    head, chunks = _coded(opened)
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    if head is not None:
        writer.head(head)
    if opened.mcz.original is not None:
        original = opened.mcz.original
        if opened.facts.layout is not None:
            original = replace(original, packed=pack(original.layout()))
        writer.original(original)
    for companion in companions(db, opened.clip):
        writer.companion(companion)
    if opened.mcz.notes:
        writer.notes(opened.mcz.notes)
    for entry in chunks.entries:
        writer.stored_chunk(entry, chunks.ranges.read(entry.begin, entry.end))
    writer.end()
    return b"".join(parts)


def _coded(opened: OpenedClip) -> tuple[Head | None, Mcz]:
    """Give the head with all frames, and the file that has the chunks."""
    head = opened.mcz.head
    if head is None or not (opened.runs or opened.dependent):
        return head, opened.mcz
    other = opened.whole_source()
    if other is not None and not other.dependent:
        return inherited(opened, other), other.mcz
    streams = {
        stream.name: Stream(opened.rows(index).values, stream.columns, stream.frame_time)
        for index, stream in enumerate(opened.streams)
    }
    clip = Clip(streams, head.skeleton)
    made = open_mcz(Source(compress_clip(clip, opened.codec(), model=opened.model()).blob))
    return made.head, made


def companions(db: Database, clip: int) -> list[Companion]:
    """Give the companions of a clip.

    Raises
    ------
    CorruptError
        When one is damaged.

    """
    rows = db.connection.execute(
        "SELECT format, name, size, packed FROM companions "
        "JOIN texts ON texts.id = companions.text "
        "WHERE companions.id IN (SELECT companion FROM belongs WHERE clip = ?) "
        "ORDER BY companions.id",
        [clip],
    )
    return [
        Companion(
            kind,
            name.rpartition("/")[2],
            unpack(packed, "companion", min(size, most_companions(len(packed)))),
        )
        for kind, name, size, packed in rows
    ]
