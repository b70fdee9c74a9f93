"""A library, open: what users of Python do with it."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, overload

from mocapress.api.clips import checked_codec
from mocapress.api.loading import load_opened
from mocapress.api.restoring import Restored, restore_opened
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
from mocapress.library.checking import Fault, check, verify_clip
from mocapress.library.clips import StoredClip, by_id, select
from mocapress.library.coding import Coder
from mocapress.library.columns import with_columns
from mocapress.library.database import WAIT, Database
from mocapress.library.exporting import export
from mocapress.library.opened import OpenedClip
from mocapress.library.removing import recompress, remove_clips
from mocapress.library.sharing import Known
from mocapress.library.windows import VALUES, Windows
from mocapress.models import Place, load_model
from mocapress.motion import Clip
from mocapress.source import Named, Source

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import DTypeLike

READ, APPEND = "r", "a"
Which = str | StoredClip | int
"""A clip: its name, itself, or its id."""


def open_library(
    path: str | Path, mode: str = READ, *, wait: float = WAIT, models: Sequence[Place] = ()
) -> "Library":
    """Open a library, one file that holds many clips.

    Parameters
    ----------
    path
        Of the file, usually ``.mocapdb``.
    mode
        ``"r"`` to read; ``"a"`` to read and write, and to make the file where there is none.
    wait
        Seconds to wait for another process that is writing.
    models
        Where models may be that clips need and the library lacks, as in ``decompress``.

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
    path = Path(path)
    if mode == APPEND and not path.exists():
        database.create(path)
    return Library(Database(path, writable=mode == APPEND, wait=wait), models)


class Library:
    """A library, open; see ``open_library``. Threads may share it, and so may forked processes.

    Its clips are in the order of their names: ``len(lib)``, ``lib[0]``, ``lib[10:20]``, and a loop
    over them. ``lib["walk.amc"]`` is the clip of this name.
    """

    def __init__(self, db: Database, models: Sequence[Place] = ()) -> None:
        self.db = db
        self.models = models
        self._known = Known()
        self._ids: tuple[tuple[int, int], list[int]] | None = None

    @property
    def path(self) -> Path:
        """Of the file."""
        return self.db.path

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the library. Where nobody else has it open, it is one file then."""
        self.db.close()

    def __getstate__(self) -> dict[str, Any]:
        return {
            "path": self.path,
            "mode": APPEND if self.db.writable else READ,
            "wait": self.db.wait,
            "models": self.models,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        db = Database(state["path"], writable=state["mode"] == APPEND, wait=state["wait"])
        self.__init__(db, state["models"])  # type: ignore[misc]

    def __repr__(self) -> str:
        """Name the file."""
        return f"<Library {str(self.path)!r}>"

    # Reading

    def __len__(self) -> int:
        with self.db.reading() as connection:
            return int(connection.execute("SELECT count(*) FROM clips").fetchone()[0])

    def __contains__(self, name: object) -> bool:
        with self.db.reading() as connection:
            return isinstance(name, str) and names.find(connection, name) is not None

    def __iter__(self) -> Iterator[StoredClip]:
        return iter(self.clips())

    @overload
    def __getitem__(self, key: str | int) -> StoredClip: ...
    @overload
    def __getitem__(self, key: slice) -> list[StoredClip]: ...
    def __getitem__(self, key: str | int | slice) -> StoredClip | list[StoredClip]:
        """Give the clip of a name, or clips by their places in the order of names.

        Raises
        ------
        KeyError
            When there is no clip of this name.
        IndexError
            When there are fewer clips.

        """
        with self.db.reading() as connection:
            if isinstance(key, str):
                found = names.find(connection, key)
                if found is None:
                    raise KeyError(key)
                return by_id(self, connection, found)
            ids = self._in_order()
            if isinstance(key, slice):
                return [by_id(self, connection, clip) for clip in ids[key]]
            return by_id(self, connection, ids[key])

    def _in_order(self) -> list[int]:
        """Give all ids in the order of names, kept until the library changes."""
        connection = self.db.connection
        version: int = connection.execute("PRAGMA data_version").fetchone()[0]
        state = version, connection.total_changes
        if self._ids is None or self._ids[0] != state:
            rows = connection.execute("SELECT id FROM clips ORDER BY name").fetchall()
            self._ids = state, [clip for (clip,) in rows]
        return self._ids[1]

    def clips(
        self,
        glob: str | Iterable[str] = (),
        *,
        label: str | None = None,
        min_duration: float | None = None,
        skeleton: str | None = None,
    ) -> list[StoredClip]:
        """Give the clips that fulfil all conditions, in the order of their names.

        Parameters
        ----------
        glob
            A name, a folder, or a pattern in which ``*`` stands for any characters, those of
            folders included; or several, of which one must fit.
        label
            One that they have.
        min_duration
            Seconds that they last at least. A clip whose frame time is not known, as that of most
            AMC files, does not count.
        skeleton
            Name of the skeleton, or a pattern.

        """
        patterns = [glob] if isinstance(glob, str) else [*glob]
        with self.db.reading() as connection:
            return select(
                self,
                connection,
                patterns,
                label=label,
                min_duration=min_duration,
                skeleton=skeleton,
            )

    def load(
        self,
        clip: Which,
        frames: slice | None = None,
        *,
        columns: Sequence[str] | None = None,
        stream: str | None = None,
        strict: bool = True,
        errors: str = "raise",
    ) -> Clip:
        """Give a clip, or some of its frames and columns.

        Parameters
        ----------
        clip
            Its name.
        frames
            Only these, e.g. ``slice(100, 200)``; only the chunks they are in are read.
        columns
            Names or globs of columns, in the order that is wanted, e.g. ``["root.*"]``.
        stream, strict, errors
            As in ``mocapress.load``.

        Raises
        ------
        ParameterError
            When there is no such clip or column.
        CorruptError
            When the clip is damaged, as far as it was read.
        FormatError
            When the original is no motion file, or had lost frames and reading is strict.
        MissingModelError
            When the model that the clip needs is nowhere.

        """
        if errors not in ("raise", "skip"):
            raise ParameterError("errors", expected="raise or skip", found=repr(errors))
        with self.db.reading():
            opened = self.opened(clip, salvage=errors == "skip")
            loaded = load_opened(opened, frames, stream=stream, strict=strict)
        return loaded if columns is None else with_columns(loaded, columns)

    def windows(
        self,
        frames: int,
        *,
        stride: int | None = None,
        of: str = VALUES,
        columns: Sequence[str] | None = None,
        dtype: "DTypeLike" = "float32",
        glob: str | Iterable[str] = (),
        label: str | None = None,
        skeleton: str | None = None,
    ) -> Windows:
        """Give all windows of so many frames as a data set for machine learning; see ``Windows``.

        >>> data = torch.utils.data.DataLoader(lib.windows(64, of="rotations"), num_workers=4)
        """
        return Windows(
            self,
            frames,
            stride=stride,
            of=of,
            columns=columns,
            dtype=dtype,
            glob=glob,
            label=label,
            skeleton=skeleton,
        )

    def read_bytes(self, clip: Which) -> bytes:
        """Give the original file of a clip, byte for byte (of a lossy codec: as ``decompress``).

        Raises
        ------
        CorruptError
            When it is damaged.
        UnsupportedError
            When the clip was made of numbers, and there is no original.

        """
        return self.restore(clip).data

    def restore(self, clip: Which, *, salvage: bool = False) -> Restored:
        """Give the original file of a clip, or what is left of it; see ``decompress``."""
        with self.db.reading():
            return restore_opened(self.opened(clip, salvage=salvage))

    def read_mcz(self, clip: Which) -> bytes:
        """Give a clip as a ``.mcz``, with its skeleton and companions; chunks are not coded again.

        Only a clip with frames that are those of another is.
        """
        with self.db.reading():
            return export(self.db, self.opened(clip))

    def opened(self, clip: Which, *, salvage: bool = False) -> OpenedClip:
        """Open a clip; to be called and used within ``db.reading``."""
        return OpenedClip(self.db, self._id(clip), self.models, salvage=salvage)

    def _id(self, clip: Which) -> int:
        if isinstance(clip, StoredClip | int):
            return clip if isinstance(clip, int) else clip.id
        with self.db.reading() as connection:
            found = names.find(connection, clip)
        if found is None:
            raise ParameterError("no such clip", file=str(self.path), found=repr(clip))
        return found

    @property
    def labels(self) -> dict[str, int]:
        """All labels, and how many clips have each."""
        with self.db.reading() as connection:
            return dict(
                connection.execute("SELECT label, count(*) FROM labels GROUP BY label ORDER BY 1")
            )

    def to_pandas(self) -> "pd.DataFrame":
        """Give the view ``catalogue`` as a table, one row a clip; needs pandas.

        Raises
        ------
        UnsupportedError
            When pandas is not there.

        """
        from mocapress.errors import UnsupportedError

        try:
            import pandas as pd
        except ImportError:
            raise UnsupportedError(
                "to_pandas needs pandas", expected="pip install pandas"
            ) from None
        with self.db.reading() as connection:
            found = connection.execute("SELECT * FROM catalogue ORDER BY name")
            return pd.DataFrame(found.fetchall(), columns=[part[0] for part in found.description])

    # Writing

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
        adder = self.adder(codec, model, overwrite=replace)
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
    ) -> Adder:
        """Give what adds clips with a codec; threads may share it."""
        coder = self._coder(codec, model)
        return Adder(replace(coder, models=[*self.models, *models]), overwrite)

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

    def label(self, clip: Which, *labels: str, remove: Sequence[str] = ()) -> None:
        """Give a clip labels, and take others away."""
        number = self._id(clip)
        for label in labels:
            if not label or "," in label or not label.isprintable():
                raise ParameterError(
                    "not a label", expected="a word without commas", found=repr(label)
                )
        with self.db.writing() as connection:
            rows.insert_labels(connection, number, labels)
            connection.executemany(
                "DELETE FROM labels WHERE clip = ? AND label = ?",
                [(number, label) for label in remove],
            )

    # Checking

    def verify(self, glob: str | Iterable[str] = ()) -> list[Fault]:
        """Decode all clips, or some; give everything that is damaged, nothing where all is well."""
        return [
            fault
            for clip in self.clips(glob)
            for fault in verify_clip(self.db, clip.id, clip.name, self.models)
        ]

    def check(self) -> list[Fault]:
        """Read everything and check its checksums without decoding; give what is damaged."""
        return [fault for faults in check(self.db) for fault in faults]


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
