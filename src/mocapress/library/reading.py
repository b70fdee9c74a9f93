"""A library, open: finding clips in it, loading and checking them."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, overload

from mocapress.api.loading import load_opened
from mocapress.api.restoring import Restored, restore_opened
from mocapress.errors import ParameterError
from mocapress.library import names
from mocapress.library.checking import Fault, check, verify_clip
from mocapress.library.clips import StoredClip, by_id, select
from mocapress.library.columns import with_columns
from mocapress.library.database import Database
from mocapress.library.exporting import export
from mocapress.library.opened import OpenedClip
from mocapress.library.sharing import Known
from mocapress.library.windows import VALUES, Windows
from mocapress.models import Place
from mocapress.motion import Clip

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import DTypeLike

READ, APPEND = "r", "a"
Which = str | StoredClip | int
"""A clip: its name, itself, or its id."""


class Reading:
    """What can be done with a library that is open for reading; see ``Library``."""

    def __init__(self, db: Database, models: Sequence[Place] = ()) -> None:
        self.db = db
        self.models = models
        self._known = Known()
        self._ids: tuple[tuple[int, int], list[int]] | None = None

    @property
    def path(self) -> Path:
        """Of the file."""
        return self.db.path

    @property
    def location(self) -> str:
        """What names it in messages."""
        return str(self.path)

    @property
    def stored_bytes(self) -> int:
        """Bytes of all its files."""
        return self.path.stat().st_size

    def fetch(self, clips: Iterable[int], companions: Collection[int] = ()) -> None:
        """See that what these need is here; of a library that is one file everything is."""

    def fetch_features(self, clips: Iterable[int]) -> None:
        """See that what search compares of these is here; see ``fetch``."""

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
            "limit": self.db.limit,
            "models": self.models,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        writable = state["mode"] == APPEND
        db = Database(state["path"], writable=writable, wait=state["wait"], limit=state["limit"])
        self.__init__(db, state["models"])  # type: ignore[misc]

    def __repr__(self) -> str:
        """Name the file."""
        return f"<Library {str(self.path)!r}>"

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
        connection, state = self.db.connection, self.state()
        if self._ids is None or self._ids[0] != state:
            rows = connection.execute("SELECT id FROM clips ORDER BY name").fetchall()
            self._ids = state, [clip for (clip,) in rows]
        return self._ids[1]

    def state(self) -> tuple[int, int]:
        """Give what is another when the library has changed."""
        connection = self.db.connection
        version: int = connection.execute("PRAGMA data_version").fetchone()[0]
        return version, connection.total_changes

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
            raise ParameterError("no such clip", file=self.location, found=repr(clip))
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
