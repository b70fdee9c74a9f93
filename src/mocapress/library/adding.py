"""Adding to a library: clips are coded first, and then written at once, each in a transaction."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from mocapress.api.compressing import taken_apart
from mocapress.api.restoring import contents
from mocapress.container import Companion, Mcz, Original, pack
from mocapress.container.head import Head, split_parts
from mocapress.container.original import write_problems
from mocapress.errors import CorruptError, VerificationError
from mocapress.library import index, names, rows
from mocapress.library.coding import Coded, Coder
from mocapress.library.opened import OpenedClip
from mocapress.library.removing import remove_clips
from mocapress.library.rows import Connection, Facts
from mocapress.library.stored import original_name
from mocapress.motion import Clip
from mocapress.source import MCZ, Source
from mocapress.storage import ExistsError

_SHORT = 512
"""Bytes of a packed layout that may be like others."""
ADDED, REPLACED, UNCHANGED = "added", "replaced", "unchanged"


class Beside(NamedTuple):
    """A file that comes with a clip."""

    name: str
    """In the library."""
    file: Companion
    modified: int | None = None


def _nothing() -> Sequence[Beside]:
    return ()


class Extra(NamedTuple):
    """What comes with a clip."""

    modified: int | None = None
    """When the file was last changed, in nanoseconds since 1970."""
    labels: Sequence[str] = ()
    notes: Mapping[str, str] = MappingProxyType({})
    beside: Callable[[], Sequence[Beside]] = _nothing
    """Gives the companions, once the file is read."""


class Added(NamedTuple):
    """What adding did."""

    clip: int
    """Id of the clip."""
    state: str
    """``added``, ``replaced`` or ``unchanged``."""
    size: int
    """Bytes of the original; 0 where there is none."""
    stored: int = 0
    """Bytes of its own chunks, and of its head."""
    frames: int = 0
    shared: int = 0
    """Frames that are those of other clips; as ``frames``, of the first stream."""
    warning: str | None = None


@dataclass(frozen=True, slots=True)
class Adder:
    """Adds to a library; several threads may share it."""

    coder: Coder
    overwrite: bool = False
    """Whether clips are replaced by others of their names."""
    indexed: bool = True
    """Whether they can be searched for at once."""

    def file(
        self,
        source: Source,
        name: str,
        extra: Extra,
        asf: str | None = None,
        *,
        again: bool = False,
    ) -> Added:
        """Add a motion file, or any other; of a ``.mcz`` what it holds, as it is coded there.

        Parameters
        ----------
        source
            The file; the skeleton beside it is looked for, unless ``asf`` names one.
        name, extra
            What the library is to call it, and what comes with it.
        again
            Whether to add it also where it is there already: with another skeleton.

        Raises
        ------
        ExistsError
            When there is another clip of this name, which is not to be replaced.

        """
        names.checked(name)
        if source.kind == MCZ:

            def taken(without: int | None) -> Coded:
                return self.coder.mcz(source, without)

            return self._write(taken(self._find(name)), name, extra, taken)
        digest = source.digest
        unchanged = None if again else self._unchanged(name, digest, extra)
        if unchanged is not None:
            return unchanged
        parts, warning = taken_apart(source, asf)
        source.warn_of_guess()

        def code(without: int | None) -> Coded:
            return self.coder.file(source, parts, digest, warning, without)

        return self._write(code(self._find(name)), name, extra, code, again=again)

    def clip(self, clip: Clip, name: str, extra: Extra) -> Added:
        """Add a clip; see ``compress_clip``."""
        names.checked(name)
        return self._write(self.coder.clip(clip), name, extra)

    def _find(self, name: str) -> int | None:
        with self.coder.db.reading() as connection:
            return names.find(connection, name)

    def _unchanged(self, name: str, digest: bytes | None, extra: Extra) -> Added | None:
        """Leave a clip that is the same, but for what is said about it."""
        db = self.coder.db
        with db.reading() as connection:
            clip = names.find(connection, name)
            found = None if clip is None else rows.read_clip(connection, clip)
        if clip is None or found is None or digest is None or found[0].sha256 != digest:
            return None
        facts = found[0]
        moved = extra.modified not in (None, facts.modified)
        if moved or extra.labels or extra.notes:
            with db.writing() as connection:
                rows.update_clip(connection, clip, facts._replace(modified=extra.modified))
                rows.insert_labels(connection, clip, extra.labels)
                rows.insert_notes(connection, clip, extra.notes)
        return Added(clip, UNCHANGED, facts.size or 0, frames=facts.frames)

    def _write(
        self,
        made: Coded,
        name: str,
        extra: Extra,
        code: Callable[[int | None], Coded] | None = None,
        *,
        again: bool = False,
    ) -> Added:
        """Write a clip, in one transaction; ``code`` codes it again if others came before."""
        original = made.mcz.original
        digest = original.digest if original else None
        unchanged = None if again else self._unchanged(name, digest, extra)
        if unchanged is not None:
            return unchanged
        db, known = self.coder.db, self.coder.known
        beside = extra.beside()
        entry = index.made_of(made.clip) if self.indexed and made.clip else None
        with db.writing() as connection:
            old = names.find(connection, name)
            if old is not None and not self.overwrite:
                raise ExistsError(
                    "there is a clip of this name; replace=True puts this one in its place",
                    file=name,
                )
            came_meanwhile = known.refresh(connection) > made.newest
            if code and came_meanwhile and self._is_late(connection, made, digest):
                made = code(old)
            labels: Sequence[str] = ()
            if old is not None:
                labels = [
                    label
                    for (label,) in connection.execute(
                        "SELECT label FROM labels WHERE clip = ?", [old]
                    )
                ]
                remove_clips(self.coder, [old])
            clip = self._insert(connection, made, name, extra, beside, labels)
            if code and made.runs and not self._comes_back(clip):
                # What it shares was changed meanwhile; nobody else writes now.
                rows.drop_clip(connection, clip)
                made = code(None)
                clip = self._insert(connection, made, name, extra, beside, labels)
                if made.runs and not self._comes_back(clip):
                    raise VerificationError(f"{name} does not come back; nothing was written")
            if entry is not None:
                index.write(connection, clip, entry)
        return Added(
            clip,
            ADDED if old is None else REPLACED,
            original.size if original else 0,
            sum(entry.end - entry.begin for entry in made.mcz.entries),
            made.shape[0],
            sum(run.frames for run in made.runs if run.stream == 0),
            made.warning,
        )

    def _is_late(self, connection: Connection, made: Coded, digest: bytes | None) -> bool:
        """Say whether clips that were added meanwhile may have some of the frames."""
        hashes = np.empty(0, np.uint32) if made.hashes is None else made.hashes
        known = self.coder.known
        return bool(known.candidates(connection, digest, hashes, made.newest))

    def _comes_back(self, clip: int) -> bool:
        opened = OpenedClip(self.coder.db, clip, self.coder.models)
        assert opened.mcz.original is not None
        if not opened.codec().lossless:
            return True
        try:
            contents(opened, opened.mcz.original)  # which has the digest that was stored
        except CorruptError:
            return False
        return True

    def _insert(
        self,
        connection: Connection,
        made: Coded,
        name: str,
        extra: Extra,
        beside: Sequence[Beside],
        labels: Sequence[str],
    ) -> int:
        mcz = made.mcz
        original = mcz.original
        layout = original.layout() if original and mcz.head and _is_short(original) else None
        head, codec, skeleton = store_head(connection, mcz, layout or b"")
        facts = Facts(
            name,
            made.kind,
            frames=made.shape[0],
            channels=made.shape[1],
            frame_time=_seconds(mcz),
            modified=extra.modified,
            skeleton=skeleton,
            codec=codec,
            head=head,
        )
        if original is not None:
            facts = facts._replace(
                file=None if original_name(facts) == original.name else original.name,
                size=original.size,
                sha256=original.digest,
                problems=write_problems(original.problems) if original.problems else None,
            )
            facts = rows.with_text(connection, facts, original.packed, layout)
        clip = rows.insert_clip(connection, facts)
        rows.insert_chunks(connection, clip, mcz)
        rows.insert_runs(connection, clip, made.runs)
        rows.insert_notes(connection, clip, {**mcz.notes, **extra.notes})
        rows.insert_labels(connection, clip, [*labels, *extra.labels])
        rows.insert_anchors(connection, clip, made.hashes)
        folder = name.rpartition("/")[0]
        own = [Beside(f"{folder}/{file.name}".lstrip("/"), file) for file in mcz.companions]
        for companion in [*own, *beside]:
            rows.insert_belongs(connection, clip, add_companion(connection, companion))
        named = {stream.model for stream in mcz.head.streams} if mcz.head else set()
        for model in made.models:
            if model.digest in named:
                rows.add_model(connection, model)
        return clip


def add_companion(connection: Connection, beside: Beside) -> int:
    """Keep a file that belongs to clips; give its row."""
    names.checked(beside.name)
    kind, _, data = beside.file
    return rows.companion_id(
        connection, beside.name, kind, data, lambda: pack(data), beside.modified
    )


def _is_short(original: Original) -> bool:
    return len(original.packed) <= _SHORT


def store_head(
    connection: Connection, mcz: Mcz, layout: bytes
) -> tuple[bytes | None, str | None, int | None]:
    """Keep what the head of a file says; give its record, the codec and the skeleton's row."""
    if mcz.head is None:
        return None, None, None
    head: Head = mcz.head
    skeleton, streams = split_parts(mcz.head_content)
    number = None
    if head.skeleton is not None:
        number = rows.skeleton_id(
            connection,
            skeleton,
            head.skeleton.name,
            len(head.skeleton.joints),
            streams + layout,
        )
    return rows.packed_head(connection, number, streams), head.streams[0].codec.id or None, number


def _seconds(mcz: Mcz) -> float | None:
    time = mcz.head.streams[0].frame_time if mcz.head else None
    return None if time is None else float(time)
