"""The manifest of a sharded library: a Parquet file with a row for each clip, companion and model.

Versions are files ``manifest/NUMBER.parquet``. Whoever changes the library writes the next one,
which only one can, so nothing is half-seen and no change is lost. docs/format/sharded.md.
"""

import io
import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from mocapress.errors import BusyError, CorruptError, UnsupportedError
from mocapress.library.sharded.store import Store
from mocapress.storage import ExistsError

if TYPE_CHECKING:
    import pyarrow as pa

CLIP, COMPANION, MODEL = "clip", "companion", "model"
FOLDER, ENDING = "manifest", ".parquet"
SHARD_BYTES = 256 * 2**20
"""Bytes of a shard, unless a library is made with other ones."""
_VERSION = 2
"""Of the columns and the metadata; 1 had no ``indexed``."""
_KEPT = 3
"""Versions that stay for readers that have found them just now."""
_TRIES = 20


@dataclass(frozen=True)
class Manifest:
    """What is in a sharded library."""

    rows: "pa.Table"
    number: int = 0
    """Of the version."""
    shard_bytes: int = SHARD_BYTES
    shards: dict[str, tuple[int, int]] = field(default_factory=dict)
    """By name: a serial number that no other shard ever has, and bytes."""
    serial: int = 1
    """Of the next shard."""
    indexed: bool = True
    """Whether clips are indexed for search when they are added, unless said otherwise then."""

    @property
    def data(self) -> bytes:
        """The file."""
        from pyarrow import BufferOutputStream, parquet

        facts = {
            "version": _VERSION,
            "shard_bytes": self.shard_bytes,
            "shards": {name: list(facts) for name, facts in self.shards.items()},
            "serial": self.serial,
            "indexed": self.indexed,
        }
        table = self.rows.replace_schema_metadata({"mocapress": json.dumps(facts)})
        sink = BufferOutputStream()
        parquet.write_table(table, sink, compression="zstd", write_page_checksum=True)
        return bytes(sink.getvalue())

    def with_shards(self, made: dict[str, int], rows: "pa.Table") -> "Manifest":
        """Give the manifest with further shards, and these rows, of which any may be new."""
        shards, serial = dict(self.shards), self.serial
        for name, size in made.items():
            if name not in shards:
                shards[name] = serial, size
                serial += 1
        used = set(rows.column("shard").unique().to_pylist())
        kept = {name: facts for name, facts in shards.items() if name in used}
        return replace(self, rows=rows, shards=kept, serial=serial)


def schema() -> "pa.Schema":
    """Give the columns; docs/format/sharded.md."""
    try:
        import pyarrow as pa
    except ImportError:
        raise UnsupportedError(
            "sharded libraries need pyarrow", expected="pip install 'mocapress[cluster]'"
        ) from None
    places = pa.list_(pa.int64())
    return pa.schema(
        [
            ("kind", pa.string()),
            ("name", pa.string()),
            ("shard", pa.string()),
            ("id", pa.int64()),
            ("format", pa.string()),
            ("file", pa.string()),
            ("frames", pa.int64()),
            ("channels", pa.int64()),
            ("frame_time", pa.float64()),
            ("size", pa.int64()),
            ("sha256", pa.binary()),
            ("modified", pa.int64()),
            ("codec", pa.string()),
            ("coding", pa.string()),
            ("head", pa.binary()),
            ("problems", pa.binary()),
            ("skeleton", pa.string()),
            ("joints", pa.int64()),
            ("skeleton_record", pa.binary()),
            ("labels", pa.list_(pa.string())),
            ("notes", pa.list_(pa.list_(pa.string()))),
            ("companions", pa.list_(pa.string())),
            ("models", pa.list_(pa.string())),
            ("runs", pa.list_(places)),
            ("needs", pa.list_(places)),
            ("needs_digests", pa.list_(pa.binary())),
            ("value_size", pa.int64()),
            ("value_places", places),
            ("text", pa.binary()),
            ("text_size", pa.int64()),
            ("text_places", places),
            ("chunk_list", pa.binary()),
            ("index_version", pa.int64()),
            ("signature", pa.binary()),
            ("features_size", pa.int64()),
            ("features_places", places),
            ("features_checksum", pa.int64()),
        ]
    )


def table_of(rows: list[dict[str, Any]]) -> "pa.Table":
    """Make a table of rows."""
    import pyarrow as pa

    return pa.Table.from_pylist(rows, schema())


def newest(store: Store) -> int:
    """Give the number of the newest version; 0 where there is none."""
    return max((number for number, _ in _versions(store)), default=0)


def _versions(store: Store) -> list[tuple[int, str]]:
    names = [file.name for file in store.files(FOLDER) if file.name.endswith(ENDING)]
    stems = [(name.removesuffix(ENDING), f"{FOLDER}/{name}") for name in names]
    return [(int(stem), name) for stem, name in stems if stem.isdecimal()]


def _name(number: int) -> str:
    return f"{FOLDER}/{number:08}{ENDING}"


def load(store: Store) -> Manifest:
    """Read the newest version.

    Raises
    ------
    FileNotFoundError
        When there is no sharded library.
    CorruptError
        When it is damaged, or no manifest.

    """
    wanted = schema()
    import pyarrow as pa
    from pyarrow import parquet

    number = newest(store)
    file = store.file(_name(number))
    if not number:
        raise FileNotFoundError(2, "no library: there is no manifest", store.url)
    data = store.read(_name(number))
    try:
        rows = parquet.read_table(io.BytesIO(data), page_checksum_verification=True)
        facts = json.loads((rows.schema.metadata or {})[b"mocapress"])
        version = facts["version"]
        if version in range(1, _VERSION + 1):
            rows = rows.select(wanted.names).cast(wanted)
            shards = {name: (int(s), int(b)) for name, (s, b) in facts["shards"].items()}
            indexed = facts["indexed"] is not False if version > 1 else True
            made = Manifest(
                rows, number, int(facts["shard_bytes"]), shards, int(facts["serial"]), indexed
            )
    except (pa.ArrowException, OSError, KeyError, ValueError, TypeError, AttributeError) as error:
        raise CorruptError(
            f"the manifest is damaged ({str(error).splitlines()[0]})", file=file
        ) from error
    if version not in range(1, _VERSION + 1):
        raise UnsupportedError(
            "version of the manifest", file=file, expected=f"1 to {_VERSION}", found=str(version)
        )
    return made


def publish(store: Store, change: Callable[[Manifest], Manifest | None]) -> Manifest:
    """Change the newest manifest; again on what another process has published meanwhile.

    ``change`` gives None where there is nothing to do.

    Raises
    ------
    BusyError
        When others publish all the time.

    """
    for _ in range(_TRIES):
        before = load(store)
        after = change(before)
        if after is None:
            return before
        number = before.number + 1
        try:
            store.create(_name(number), after.data)
        except ExistsError:
            continue
        _tidy(store, before, after, number)
        return replace(after, number=number)
    raise BusyError("others change the library all the time", file=store.url)


def _tidy(store: Store, before: Manifest, after: Manifest, number: int) -> None:
    """Delete shards that nothing is in any more, and old versions."""
    for name in before.shards.keys() - after.shards.keys():
        store.remove(shard_file(name))
    for old, file in _versions(store):
        if old <= number - _KEPT:
            store.remove(file)


def create(store: Store, shard_bytes: int = SHARD_BYTES, *, indexed: bool = True) -> None:
    """Make a library without clips; see ``Manifest``.

    Raises
    ------
    ExistsError
        When there is one.

    """
    made = Manifest(schema().empty_table(), shard_bytes=shard_bytes, indexed=indexed)
    if newest(store):
        raise ExistsError("there is a library already", file=store.url)
    store.create(_name(1), made.data)


def shard_file(name: str) -> str:
    """Give where a shard of this name stands."""
    return f"shards/{name}.mocapdb"
