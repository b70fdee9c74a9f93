"""Coding clips of a library anew together, by a codec that predicts them from each other."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mocapress.api.encoding import coded
from mocapress.codecs import Encoded, Origin
from mocapress.container import Mcz, MczWriter, open_mcz
from mocapress.container.head import Head
from mocapress.errors import VerificationError
from mocapress.library.coding import Coder
from mocapress.library.needs import Need, insert_needs, needing
from mocapress.library.opened import OpenedClip
from mocapress.library.removing import own_clip, store
from mocapress.motion import Clip
from mocapress.source import Source


class _Kept(NamedTuple):
    """A clip with the frames that it has in chunks of its own."""

    opened: OpenedClip
    clip: Clip


def recompress_together(coder: Coder, clips: Sequence[int]) -> dict[int, tuple[int, int]]:
    """Code the chunks of clips with the coder's codec, in one transaction.

    Clips of which chunks need frames of these are coded anew, too, so that no way gets longer. What
    is not motion, or was coded by a lossy codec, stays as it is.

    Returns
    -------
    dict
        For each clip that was asked for or coded, the bytes of its chunks before and afterwards.

    Raises
    ------
    VerificationError
        When what was coded does not come back; nothing is written then.

    """
    sizes = {}
    with coder.db.writing() as connection:
        wanted = [*clips]
        for clip in wanted:
            wanted += [other for other in needing(connection, [clip]) if other not in wanted]
        kept = []
        for clip in wanted:
            opened = OpenedClip(coder.db, clip, coder.models)
            before = sum(entry.end - entry.begin for entry in opened.mcz.entries)
            sizes[clip] = before, before
            lossless = all(opened.codec(index).lossless for index in range(len(opened.streams)))
            if opened.mcz.entries and lossless:
                kept.append(_Kept(opened, own_clip(opened)))
        for group in _alike(kept):
            _code(coder, group)
        for own in kept:
            sizes[own.opened.clip] = sizes[own.opened.clip][0], _verified(coder, own)
    return sizes


def _alike(kept: Sequence[_Kept]) -> list[list[_Kept]]:
    """Give the clips whose first streams have the same columns together."""
    groups: dict[tuple[tuple[str, str], ...], list[_Kept]] = {}
    for one in kept:
        key = tuple((column.name, column.kind) for column in one.clip.columns)
        groups.setdefault(key, []).append(one)
    return [*groups.values()]


def _code(coder: Coder, group: Sequence[_Kept]) -> None:
    made = coder.codec.encode_together(
        [own.clip.main for own in group], skeleton=group[0].clip.skeleton
    )
    connection = coder.db.connection
    for own, encoded in zip(group, made.encoded, strict=True):
        for table in ("chunks", "needs"):
            connection.execute(f"DELETE FROM {table} WHERE clip = ?", [own.opened.clip])  # noqa: S608
        store(connection, own.opened.clip, _mcz(coder, own, encoded), None)
        insert_needs(connection, own.opened.clip, _needs(encoded, made.origins, group))


def _needs(encoded: Encoded, origins: Mapping[bytes, Origin], group: Sequence[_Kept]) -> list[Need]:
    digests = dict.fromkeys(digest for chunk in encoded.chunks for digest in chunk.needs)
    return [
        Need(digest, 0, group[origin.stream].opened.clip, origin.first, origin.frames)
        for digest, origin in ((digest, origins[digest]) for digest in digests)
    ]


def _mcz(coder: Coder, own: _Kept, encoded: Encoded) -> Mcz:
    """Give head and chunks; streams behind the first are coded clip by clip."""
    heads, chunks = [], []
    for index, (name, stream) in enumerate(own.clip.streams.items()):
        made = encoded
        if index:
            made = coder.codec.encode(stream, skeleton=own.clip.skeleton)
        alone = Clip({name: stream}, own.clip.skeleton)
        head, of_stream = coded(alone, name, index, coder.codec, made, None)
        heads.append(head)
        chunks += of_stream
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.head(Head(tuple(heads), own.clip.skeleton))
    for chunk in chunks:
        writer.chunk(chunk)
    writer.end()
    return open_mcz(Source(b"".join(parts), limit=None))


def _verified(coder: Coder, own: _Kept) -> int:
    """See that a clip comes back; give the bytes of its chunks."""
    opened = OpenedClip(coder.db, own.opened.clip, coder.models)
    for index, stream in enumerate(own.clip.streams.values()):
        values = np.ascontiguousarray(stream.values, "<f8")
        if opened.own_rows(index).values.tobytes() != values.tobytes():
            raise VerificationError(f"{opened.facts.name} does not come back; nothing was written")
    return sum(entry.end - entry.begin for entry in opened.mcz.entries)
