"""A sharded library, open: a library on this machine gets from the shards what is asked for."""

import tempfile
import threading
from collections.abc import Collection, Iterable, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mocapress.errors import CorruptError
from mocapress.library import schema
from mocapress.library.database import WAIT, Database
from mocapress.library.library import Library
from mocapress.library.opened import OpenedClip
from mocapress.library.reading import READ, Which
from mocapress.library.sharded import manifest
from mocapress.library.sharded.index import SERIAL, fill, insert_values, writable
from mocapress.library.sharded.manifest import CLIP, COMPANION, MODEL, Manifest, shard_file
from mocapress.library.sharded.places import Place as Part
from mocapress.library.sharded.places import joined
from mocapress.library.sharded.sealing import unflattened
from mocapress.library.sharded.store import Store
from mocapress.models import Place
from mocapress.source import LIMIT

if TYPE_CHECKING:
    import pandas as pd

REQUESTS = 3
"""For the values of a clip, at most."""

_FEATURES = ("features_size", "features_places", "features_checksum")
"""Columns that say where the features of a clip are."""


class ShardedReading(Library):
    """A library of shards in a folder or in object storage; see ``open_library``.

    It is what the manifest said when it was opened. A clip is read from its shard, only the bytes
    that it needs, when it is first asked for.
    """

    def __init__(
        self,
        url: str,
        mode: str = READ,
        *,
        wait: float = WAIT,
        models: Sequence[Place] = (),
        limit: int | None = LIMIT,
    ) -> None:
        self.url, self.mode, self.wait, self.limit = url, mode, wait, limit
        self.store = Store(url)
        self._lock = threading.RLock()
        self._folder = tempfile.TemporaryDirectory(prefix="mocapress-", ignore_cleanup_errors=True)
        try:
            self._index(manifest.load(self.store), models)
        except BaseException:
            self._folder.cleanup()
            raise

    def _index(self, found: Manifest, models: Sequence[Place]) -> None:
        """Make the library on this machine of what the manifest says."""
        self.manifest = found
        file = Path(self._folder.name, f"{found.number}.mocapdb")
        self._row, self._models = fill(file, found, self.url)
        self._there: set[tuple[str, int]] = set()
        self._featured: set[int] = set()
        db = Database(file, writable=False, wait=self.wait, limit=self.limit)
        super().__init__(db, models)

    def refresh(self, found: Manifest) -> None:
        """Be what a newer manifest says."""
        if found.number != self.manifest.number:
            models = self.models
            old = self.db
            self._index(found, models)
            old.close()

    @property
    def location(self) -> str:
        """The folder or URL."""
        return self.url

    @property
    def stored_bytes(self) -> int:
        """Bytes of all shards."""
        return sum(size for _, size in self.manifest.shards.values())

    def close(self) -> None:
        """Close the library."""
        super().close()
        self._folder.cleanup()

    def __getstate__(self) -> dict[str, Any]:
        return {
            "url": self.url,
            "mode": self.mode,
            "wait": self.wait,
            "models": self.models,
            "limit": self.limit,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    def __repr__(self) -> str:
        """Name the folder."""
        return f"<ShardedLibrary {self.url!r}>"

    def to_pandas(self) -> "pd.DataFrame":
        """Give the view ``catalogue`` as a table, one row a clip; needs pandas."""
        made = super().to_pandas()
        rows = self.manifest.rows
        sizes = dict(
            zip(rows.column("name").to_pylist(), rows.column("value_size").to_pylist(), strict=True)
        )
        made["stored"] = [sizes.get(name) or 0 for name in made["name"]]
        return made

    def opened(self, clip: Which, *, salvage: bool = False) -> OpenedClip:
        """Open a clip; what it needs is read from its shard, if it was not yet."""
        number = self._id(clip)
        self.fetch([number])
        return super().opened(number, salvage=salvage)

    def fetch(self, clips: Iterable[int], companions: Collection[int] = ()) -> None:
        """Read what clips and companions need from the shards, as far as it is not here yet."""
        with self._lock:
            wanted = [(CLIP, number) for number in self._with_sources(clips)]
            wanted += [(MODEL, number) for number in self._models_of(wanted)]
            wanted += [(COMPANION, number) for number in companions]
            missing = [key for key in wanted if key in self._row and key not in self._there]
            if not missing:
                return
            rows = self.manifest.rows.take([self._row[key] for key in missing]).to_pylist()
            values = self._read(rows)
            with closing(writable(self.db.path)) as connection:
                connection.execute("BEGIN")
                for index, (key, row) in enumerate(zip(missing, rows, strict=True)):
                    value, text = values.get((index, "value"), b""), values.get((index, "text"))
                    insert_values(connection, key, row, value, row["text"] or text)
                connection.execute("COMMIT")
            self._there.update(missing)
        # Only this adds to what is here: to see it, a transaction may well begin again.
        if self.db.connection.in_transaction:
            self.db.connection.execute("COMMIT")
            self.db.connection.execute("BEGIN")

    def fetch_features(self, clips: Iterable[int]) -> None:
        """Read what search compares of clips, and of all clips of their shards with them."""
        with self._lock:
            missing = {clip // SERIAL for clip in clips} - self._featured
            if not missing:
                return
            numbers = [n for kind, n in self._row if kind == CLIP and n // SERIAL in missing]
            wanted = self.manifest.rows.take([self._row[CLIP, n] for n in numbers])
            rows = wanted.select(["name", "shard", *_FEATURES]).to_pylist()
            values = self._read(rows, ("features",))
            with closing(writable(self.db.path)) as connection:
                connection.execute("BEGIN")
                connection.executemany(
                    "INSERT OR IGNORE INTO features VALUES(?, ?, ?)",
                    [
                        (numbers[at], rows[at]["features_checksum"] or 0, value)
                        for (at, _), value in values.items()
                    ],
                )
                connection.execute("COMMIT")
            self._featured |= missing

    def _with_sources(self, clips: Iterable[int]) -> list[int]:
        """Give clips, and those of which they have or need frames."""
        found: dict[int, None] = {}
        waiting = [*clips]
        while waiting:
            clip = waiting.pop()
            if clip not in found:
                found[clip] = None
                for table in ("runs", "needs"):
                    query = f"SELECT DISTINCT source FROM {table} WHERE clip = ?"  # noqa: S608
                    waiting += [n for (n,) in self.db.connection.execute(query, [clip])]
        return [*found]

    def _models_of(self, keys: Iterable[tuple[str, int]]) -> list[int]:
        rows = [self._row[key] for key in keys if key in self._row]
        column = self.manifest.rows.column("models")
        digests = {digest for row in rows for digest in column[row].as_py() or ()}
        return [self._models[digest] for digest in sorted(digests) if digest in self._models]

    def _read(
        self, rows: Sequence[dict[str, Any]], values_of: Sequence[str] = ("value", "text")
    ) -> dict[tuple[int, str], bytes]:
        """Read the values of rows, those of a shard together."""
        of_shard: dict[str, list[tuple[int, str]]] = {}
        for index, row in enumerate(rows):
            for what in values_of:
                if row[f"{what}_places"]:
                    of_shard.setdefault(row["shard"], []).append((index, what))
        values = {}
        for shard, keys in of_shard.items():
            file = shard_file(shard)
            lists = [self._places(rows[index], what) for index, what in keys]
            spans = [(place.begin, place.begin + place.size) for each in lists for place in each]
            most = REQUESTS * len({index for index, _ in keys})
            try:
                parts = iter(self.store.parts(file, spans, most))
            except FileNotFoundError as error:
                raise missing_shard(self.store, self.manifest, shard) from error
            for (index, what), each in zip(keys, lists, strict=True):
                own = [next(parts) for _ in each]
                size = rows[index][f"{what}_size"]
                values[index, what] = joined(own, each, size, schema.PAGE)
        return values

    def _places(self, row: dict[str, Any], what: str) -> list[Part]:
        """Give the places of a value, which are in the shard."""
        flat, size = row[f"{what}_places"], row[f"{what}_size"]
        whole = self.manifest.shards[row["shard"]][1]
        places = unflattened(flat) if len(flat) % 3 == 0 else []
        inside = all(0 <= p.begin <= p.begin + p.size <= whole for p in places)
        if not places or not inside or size is None or size < 0:
            raise CorruptError(
                "the manifest is damaged: where a value stands", file=self.url, found=row["name"]
            )
        return places


def missing_shard(store: Store, found: Manifest, shard: str) -> CorruptError:
    """Say that a shard is not there, and what is lost."""
    import pyarrow.compute as pc

    rows = found.rows.filter(pc.field("shard") == shard)
    lost = rows.filter(pc.field("kind") == CLIP).num_rows
    return CorruptError(
        f"the shard is missing, and its {lost} clips with it",
        file=store.file(shard_file(shard)),
        expected=f"a file of {found.shards[shard][1]} bytes",
    )
