"""Removing clips from a library, and coding them anew; what others share of them stays whole."""

import tempfile
from collections.abc import Sequence
from typing import BinaryIO

import numpy as np

from mocapress.api.clips import compress_clip
from mocapress.codecs import Codec, Model
from mocapress.container import Mcz, open_mcz
from mocapress.container.head import Head, write_parts
from mocapress.errors import ParameterError
from mocapress.library import rows
from mocapress.library.coding import Coder, shared, without_runs
from mocapress.library.needs import needing
from mocapress.library.opened import OpenedClip, inherited
from mocapress.library.rows import Connection, Facts
from mocapress.library.sharing import Values, anchors
from mocapress.motion import Clip, Stream
from mocapress.source import Source


def remove_clips(coder: Coder, clips: Sequence[int]) -> None:
    """Remove clips, in one transaction; what refers to them is coded anew."""
    with coder.db.writing() as connection:
        for clip in clips:
            _hand_over(connection, coder, clip, clips)
        with tempfile.TemporaryFile() as spool:
            left = _dependents(connection, clips)
            kept = [_kept(coder, clip, spool) for clip in left]
            # Of clips that are coded again frames are counted anew, so what needs them is lost.
            orphans = [
                OpenedClip(coder.db, clip, coder.models)
                for clip in needing(connection, [*clips, *left])
            ]
            for opened in orphans:
                for index in range(len(opened.streams)):
                    np.save(spool, opened.own_rows(index).values, allow_pickle=False)
            for clip in clips:
                connection.execute("DELETE FROM runs WHERE source = ? OR clip = ?", (clip, clip))
            for opened in orphans:
                for table in ("chunks", "needs"):
                    connection.execute(f"DELETE FROM {table} WHERE clip = ?", [opened.clip])  # noqa: S608
            for clip in left:
                rows.drop_contents(connection, clip)
            for clip in clips:
                rows.drop_clip(connection, clip)
            spool.seek(0)
            for opened in kept:
                values = [np.load(spool, allow_pickle=False) for _ in opened.streams]
                _code_again(connection, coder, opened, _clip(opened, values))
            for opened in orphans:
                values = [np.load(spool, allow_pickle=False) for _ in opened.streams]
                made = _coded(_clip(opened, values), opened.codec(), opened.model())
                store(connection, opened.clip, made, opened.model())


def recompress(coder: Coder, clip: int) -> tuple[int, int]:
    """Code the chunks of a clip with the coder's codec, in one transaction.

    Returns
    -------
    tuple
        Bytes of its chunks before and afterwards.

    Raises
    ------
    ParameterError
        When the codec is lossy, or the clip was: what is kept must not change.

    """
    if not coder.codec.lossless:
        raise ParameterError("a lossy codec would lose what the library keeps", expected="exact")
    with coder.db.reading():
        opened = OpenedClip(coder.db, clip, coder.models)
        if not opened.mcz.entries:
            return 0, 0
        if not all(opened.codec(stream).lossless for stream in range(len(opened.streams))):
            raise ParameterError(
                "a lossy clip stays as it is", file=opened.facts.name, expected="a lossless one"
            )
        before = [entry.end - entry.begin for entry in opened.mcz.entries]
        made = _coded(own_clip(opened), coder.codec, coder.model)
        seen = opened.facts.head
    with coder.db.writing() as connection:
        found = rows.read_clip(connection, clip)
        if found is None or found[0].head != seen:  # somebody was quicker
            return sum(before), sum(before)
        for table in ("chunks", "needs"):
            connection.execute(f"DELETE FROM {table} WHERE clip = ?", [clip])  # noqa: S608
        store(connection, clip, made, coder.model)
    return sum(before), sum(entry.end - entry.begin for entry in made.entries)


def own_clip(opened: OpenedClip) -> Clip:
    """Give the frames that a clip has in chunks of its own."""
    return _clip(opened, [opened.own_rows(index).values for index in range(len(opened.streams))])


def _clip(opened: OpenedClip, values: Sequence[Values]) -> Clip:
    """Give the streams of a clip with other frames."""
    head = opened.mcz.head
    assert head is not None
    streams = {
        stream.name: Stream(of_stream, stream.columns, stream.frame_time)
        for stream, of_stream in zip(head.streams, values, strict=True)
    }
    return Clip(streams, head.skeleton)


def _coded(clip: Clip, codec: Codec, model: Model | None) -> Mcz:
    """Code a clip: head and chunks."""
    return open_mcz(Source(compress_clip(clip, codec, model=model).blob))


def store(connection: Connection, clip: int, made: Mcz, model: Model | None) -> None:
    """Put a new head and new chunks in the place of those of a clip."""
    found = rows.read_clip(connection, clip)
    assert found is not None
    assert made.head is not None
    facts = _coded_as(connection, found[0], made.head)
    rows.update_clip(connection, clip, facts)
    rows.insert_chunks(connection, clip, made)
    if model is not None:
        rows.add_model(connection, model)


def _coded_as(connection: Connection, facts: Facts, head: Head) -> Facts:
    """Give the facts of a clip with another head; its skeleton stays."""
    streams = rows.packed_head(connection, facts.skeleton, write_parts(head)[1])
    return facts._replace(head=streams, codec=head.streams[0].codec.id)


def _hand_over(connection: Connection, coder: Coder, clip: int, removed: Sequence[int]) -> None:
    """Give the chunks of a clip that is removed to one whose frames are all of them, if there is.

    Nothing is coded again then, and a lossy clip stays what it is.
    """
    for (other,) in connection.execute(
        "SELECT DISTINCT clip FROM runs WHERE source = ? AND first = 0 ORDER BY clip", [clip]
    ).fetchall():
        heir = None if other in removed else OpenedClip(coder.db, other, coder.models)
        source = None if heir is None else heir.whole_source()
        if heir is None or source is None or source.clip != clip or source.runs:
            continue
        head = inherited(heir, source)
        facts = _coded_as(connection, heir.facts, head)
        rows.update_clip(connection, other, facts)
        connection.execute("DELETE FROM runs WHERE clip = ?", [other])
        for table, column in (
            ("chunks", "clip"),
            ("needs", "clip"),
            ("needs", "source"),
            ("anchors", "clip"),
            ("runs", "source"),
        ):
            connection.execute(
                f"UPDATE {table} SET {column} = ? WHERE {column} = ?",  # noqa: S608
                (other, clip),
            )
        kept = connection.execute("SELECT hashes FROM anchors WHERE clip = ?", [other]).fetchone()
        if kept:
            coder.known.learn(other, np.frombuffer(kept[0], "<u4"))
        return


def _dependents(connection: Connection, clips: Sequence[int]) -> list[int]:
    """Give the clips whose runs lead to these, and those whose runs lead to them, and so on.

    The frames of a clip in chunks of its own are counted anew when it is coded again, so runs that
    lead to it have to be, too.
    """
    found: dict[int, None] = {}
    pending = [*clips]
    while pending:
        clip = pending.pop()
        for (other,) in connection.execute(
            "SELECT DISTINCT clip FROM runs WHERE source = ?", [clip]
        ):
            if other not in found and other not in clips:
                found[other] = None
                pending.append(other)
    return sorted(found)


def _kept(coder: Coder, clip: int, spool: BinaryIO) -> OpenedClip:
    """Put the frames of a clip aside, and give what else is known of it."""
    opened = OpenedClip(coder.db, clip, coder.models)
    for index in range(len(opened.streams)):
        np.save(spool, opened.rows(index).values, allow_pickle=False)
    return opened


def _code_again(connection: Connection, coder: Coder, opened: OpenedClip, clip: Clip) -> None:
    """Code all frames of a clip, as far as no other has them."""
    coder.known.refresh(connection)
    found = coder.known.candidates(connection, opened.facts.sha256, anchors(clip.values))
    runs = [*shared(coder.db, clip, found, coder.models)]
    rest, model = without_runs(clip, runs), opened.model()
    store(connection, opened.clip, _coded(rest, opened.codec(), model), model)
    rows.insert_runs(connection, opened.clip, runs)
    if rest.values.size:
        hashes = anchors(rest.values)
        rows.insert_anchors(connection, opened.clip, hashes)
        coder.known.learn(opened.clip, hashes)
