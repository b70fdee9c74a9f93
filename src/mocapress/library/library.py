"""A library, open: what users of Python do with it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mocapress.api.clips import checked_codec
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.container import Companion
from mocapress.errors import ParameterError
from mocapress.library import database, names, rows
from mocapress.library.adding import (
    ADDED,
    UNCHANGED,
    Added,
    Adder,
    Beside,
    Extra,
    add_companion,
)
from mocapress.library.clips import StoredClip, by_id
from mocapress.library.coding import Coder
from mocapress.library.database import WAIT, Database
from mocapress.library.finding import Finding
from mocapress.library.index import is_wanted
from mocapress.library.reading import APPEND, READ, Which
from mocapress.library.removing import recompress, remove_clips
from mocapress.library.searching import Reindexed, reindex
from mocapress.models import Place, load_model
from mocapress.motion import Clip, Skeleton
from mocapress.source import LIMIT, Named, Source


def open_library(
    path: str | Path,
    mode: str = READ,
    *,
    wait: float = WAIT,
    models: Sequence[Place] = (),
    limit: int | None = LIMIT,
) -> "Library":
    """Open a library, one file that holds many clips, or a folder of them, a sharded library.

    Parameters
    ----------
    path
        Of the file, usually ``.mocapdb``. A folder, a URL such as ``s3://bucket/folder``, or a name
        that ends with ``/`` is that of a sharded library, which needs ``mocapress[cluster]``.
    mode
        ``"r"`` to read; ``"a"`` to read and write, and to make the file where there is none.
    wait
        Seconds to wait for another process that is writing.
    models
        Where models may be that clips need and the library lacks, as in ``decompress``.
    limit
        Bytes that may be restored of a clip, of its file, and of its numbers, 8 each: 4 GiB by
        default; None for any number.

    Returns
    -------
    Library
        To be closed, or used in a ``with`` statement.

    Raises
    ------
    CorruptError
        When the file is no library, or a damaged one.
    UnsupportedError
        When it is one of a later version.
    OSError
        When it cannot be opened.

    """
    if mode not in (READ, APPEND):
        raise ParameterError("mode", expected="'r' or 'a'", found=repr(mode))
    if is_sharded(path):
        from mocapress.library.sharded import open_sharded

        return open_sharded(str(path), mode, wait=wait, models=models, limit=limit)
    path = Path(path)
    if mode == APPEND and not path.exists():
        database.create(path)
    return Library(Database(path, writable=mode == APPEND, wait=wait, limit=limit), models)


def is_sharded(path: str | Path) -> bool:
    """Say whether a name is that of a sharded library: a URL or a folder."""
    text = str(path)
    return "://" in text or text.endswith("/") or Path(text).is_dir()


class Library(Finding):
    """A library, open; see ``open_library``. Threads may share it, and so may forked processes.

    Its clips are in the order of their names: ``len(lib)``, ``lib[0]``, ``lib[10:20]``, and a loop
    over them. ``lib["walk.amc"]`` is the clip of this name.
    """

    def add(
        self,
        source: Named | Clip,
        name: str | None = None,
        *,
        codec: str | Codec = DEFAULT_CODEC,
        model: Model | str | Path | None = None,
        asf_path: str | Path | None = None,
        labels: Sequence[str] = (),
        notes: Mapping[str, str] | None = None,
        replace: bool = False,
        index: bool | None = None,
    ) -> StoredClip:
        """Add a file or a clip, in one transaction; it was decoded and compared before.

        Parameters
        ----------
        source
            A path, the contents, or a binary stream, of a motion file or any other; or of a
            ``.mcz``, which is taken as it is coded; or a clip.
        name
            A relative path with ``/`` between its parts; without it, the file's name, or the
            clip's.
        codec, model, asf_path, notes
            As in ``compress``. The skeleton of an AMC is kept, too, and so is its file.
        labels
            Words by which the clip is to be found.
        replace
            Whether a clip of this name that is another is replaced.
        index
            Whether what ``search`` compares is made and kept at once; without it, as the library
            was made.

        Returns
        -------
        StoredClip
            The clip, also where it was there already.

        Raises
        ------
        ExistsError
            When there is another clip of this name.
        BusyError
            When another process is writing for too long.

        """
        if model is not None and not isinstance(model, Model):
            model = load_model(model)
        adder = self.adder(codec, model, overwrite=replace, indexed=index)
        if isinstance(source, Clip):
            if not (name or source.name):
                raise ParameterError("the clip has no name", expected="name=...")
            extra = Extra(None, labels, notes or {})
            added = adder.clip(source, name or source.name, extra)
        else:
            opened = Source(source)
            if not (name or opened.name):
                raise ParameterError("the contents have no name", expected="name=...")
            own = name or _own_name(opened)
            extra = Extra(modified_of(opened), labels, notes or {}, lambda: beside(opened, own))
            added = adder.file(opened, own, extra, None if asf_path is None else str(asf_path))
        with self.db.reading() as connection:
            return by_id(self, connection, added.clip)

    def add_companion(self, source: Source, name: str, modified: int | None = None) -> Added:
        """Keep a file that belongs to clips, such as an ASF, under a name of its own."""
        of = source.format
        file = Companion(of.id if of else "", Path(source.name).name, source.data)
        when = modified_of(source) if modified is None else modified
        with self.db.writing() as connection:
            before = connection.total_changes
            companion = add_companion(connection, Beside(name, file, when))
            state = ADDED if connection.total_changes > before else UNCHANGED
        return Added(companion, state, source.size, source.size * (state == ADDED))

    def has(self, name: str, size: int, modified: int) -> bool:
        """Say whether there is a file of this name, size and time, clip or companion."""
        with self.db.reading() as connection:
            return any(
                connection.execute(
                    f"SELECT 1 FROM {table} WHERE name = CAST(? AS TEXT) "  # noqa: S608
                    "AND size = ? AND modified = ?",
                    (names.stored(name), size, modified),
                ).fetchone()
                for table in ("clips", "companions")
            )

    def companions(self, name: str) -> list[str]:
        """Give the names of the files that belong to a clip; none where there is no such clip."""
        with self.db.reading() as connection:
            found = connection.execute(
                "SELECT companions.name FROM companions JOIN belongs ON companion = companions.id "
                "JOIN clips ON clip = clips.id WHERE clips.name = CAST(? AS TEXT)",
                [names.stored(name)],
            )
            return [companion for (companion,) in found]

    def has_skeleton(self, name: str, skeleton: Skeleton) -> bool:
        """Say whether a clip has this skeleton."""
        with self.db.reading() as connection:
            row = connection.execute(
                "SELECT hash FROM skeletons JOIN clips ON skeletons.id = skeleton "
                "WHERE clips.name = CAST(? AS TEXT)",
                [names.stored(name)],
            ).fetchone()
        return row is not None and row[0] == rows.skeleton_hash(skeleton)

    def unchanged(self, name: str) -> Added:
        """Say of a file that is there that nothing was done."""
        if name not in self:
            return Added(0, UNCHANGED, 0)
        clip = self[name]
        return Added(clip.id, UNCHANGED, clip.size or 0, frames=clip.frames)

    def adder(
        self,
        codec: str | Codec = DEFAULT_CODEC,
        model: Model | None = None,
        *,
        overwrite: bool,
        models: Sequence[Place] = (),
        indexed: bool | None = None,
    ) -> Adder:
        """Give what adds clips with a codec; threads may share it."""
        if indexed is None:
            with self.db.reading() as connection:
                indexed = is_wanted(connection)
        coder = self._coder(codec, model)
        return Adder(replace(coder, models=[*self.models, *models]), overwrite, indexed)

    def _coder(self, codec: str | Codec, model: Model | None) -> Coder:
        return Coder(self.db, self._known, checked_codec(codec, model), model, self.models)

    def remove(self, *which: Which) -> None:
        """Remove clips, in one transaction; clips that share frames with them stay whole."""
        with self.db.writing():
            remove_clips(self._coder(DEFAULT_CODEC, None), [self._id(clip) for clip in which])

    def recompress(
        self, clip: Which, codec: str | Codec = DEFAULT_CODEC, *, model: Model | None = None
    ) -> tuple[int, int]:
        """Code a clip with another lossless codec; its numbers stay the same bit for bit.

        Returns
        -------
        tuple
            Bytes of its chunks before and afterwards.

        Raises
        ------
        ParameterError
            When the codec is lossy, or the clip was coded by one.

        """
        return recompress(self._coder(codec, model), self._id(clip))

    def recompress_together(
        self, clips: Sequence[Which], codec: str | Codec
    ) -> dict[str, tuple[int, int]]:
        """Code clips anew by a codec of scope library, which predicts them from each other.

        All is written in one transaction, or nothing. Clips of which chunks need frames of these
        are coded anew, too. What is not motion, or was coded by a lossy codec, stays as it is.

        Returns
        -------
        dict
            By name, the bytes of the chunks of each clip before and afterwards.

        Raises
        ------
        UnsupportedError
            When what the codec needs to find patterns is not installed.

        """
        from mocapress.library.together import recompress_together

        done = recompress_together(self._coder(codec, None), [self._id(clip) for clip in clips])
        with self.db.reading() as connection:
            return {by_id(self, connection, clip).name: sizes for clip, sizes in done.items()}

    def reindex(self, joints: Mapping[str, str] | None = None) -> Reindexed:
        """Make anew what ``search`` compares, of all clips; each is written when it is made.

        Parameters
        ----------
        joints
            As in ``search``, for the clips whose skeletons have all of these names.

        Returns
        -------
        Reindexed
            How many clips can be searched, how many have no body, and what failed.

        """
        return reindex(self, joints)

    def label(self, clip: Which, *labels: str, remove: Sequence[str] = ()) -> None:
        """Give a clip labels, and take others away."""
        self.label_all([clip], labels, remove)

    def label_all(
        self, clips: Iterable[Which], labels: Sequence[str], remove: Sequence[str] = ()
    ) -> None:
        """Give clips labels, and take others away, in one transaction."""
        for label in labels:
            check_label(label)
        with self.db.writing() as connection:
            for number in map(self._id, clips):
                rows.insert_labels(connection, number, labels)
                connection.executemany(
                    "DELETE FROM labels WHERE clip = ? AND label = ?",
                    [(number, label) for label in remove],
                )


def check_label(label: str) -> None:
    """Refuse what is no label.

    Raises
    ------
    ParameterError
        When it is none.

    """
    if not label or "," in label or not label.isprintable():
        raise ParameterError("not a label", expected="a word without commas", found=repr(label))


def _own_name(source: Source) -> str:
    name = Path(source.name).name
    return name.removesuffix(".mcz") if len(name) > len(".mcz") else name


def modified_of(source: Source) -> int | None:
    """Say when a file was last changed, in nanoseconds since 1970."""
    return None if source.path is None else source.path.stat().st_mtime_ns


def beside(source: Source, name: str) -> list[Beside]:
    """Give the skeleton's file that was used, as a companion of the clip ``name``."""
    of, used = source.format, source.used
    if used is None or of is None or of.companion is None:
        return []
    file = Path(used.file)
    own = "/".join([*name.split("/")[:-1], file.name])
    modified = file.stat().st_mtime_ns if file.exists() else None
    return [Beside(own, Companion(of.companion, file.name, used.read()), modified)]
