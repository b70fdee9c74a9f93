"""The tasks that make shards of files; each can run on any machine."""

import hashlib
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from mocapress import codecs
from mocapress.codecs import Codec, Model
from mocapress.container import Companion, open_mcz
from mocapress.errors import CorruptError, MocapressError, MotionWarning
from mocapress.library.adding import Adder, Beside, Extra
from mocapress.library.database import WAIT, Database
from mocapress.library.library import Library, open_library
from mocapress.library.sharded.manifest import CLIP, shard_file
from mocapress.library.sharded.sealing import rows_of, seal
from mocapress.library.sharded.store import Listed, Store
from mocapress.models import Place
from mocapress.source import LIMIT, MCZ, Source, choose_beside
from mocapress.source import Beside as Used


@dataclass
class Made:
    """What a task has made."""

    shards: dict[str, int] = field(default_factory=dict)
    """Names of shards that are written, and their bytes."""
    rows: list[dict[str, Any]] = field(default_factory=list)
    """Of the manifest."""
    failed: list[tuple[str, str]] = field(default_factory=list)
    """Files that could not be added, and why."""
    warnings: list[tuple[str, str]] = field(default_factory=list)
    touched: dict[str, int] = field(default_factory=dict)
    """By name in the library, when files that are there were last changed, in another moment than
    the manifest says but to the same contents."""
    raw: int = 0
    """Bytes of the files that were added."""
    sizes: tuple[int, int] = (0, 0)
    """Bytes of chunks before and afterwards, of clips that were coded anew."""
    indexed: tuple[int, int] = (0, 0)
    """Clips that can be searched now, and those that have no body to be searched."""


class Known(NamedTuple):
    """What the library has of a file, clip or companion."""

    size: int | None
    modified: int | None
    sha256: bytes | None
    companions: tuple[str, ...] = ()
    """Names of those that a clip was added with."""


@dataclass(frozen=True)
class Adding:
    """Files to make a shard of, or more where they are large."""

    store: Store
    source: Store
    into: str
    codec: Codec
    model: Model | None
    labels: Sequence[str]
    shard_bytes: int
    indexed: bool = True
    """Whether they can be searched for at once."""
    compressed: bool = False
    """Whether the files are ``.mcz``, which are taken as they are coded."""
    models: Sequence[Place] = ()
    """Where the models are that these need, beside the files."""
    limit: int | None = LIMIT
    """Bytes that may be decoded of a file."""
    files: Sequence[Listed] = ()
    skeletons: Sequence[Listed] = ()
    """Files of skeletons that may lie beside them."""
    known: Mapping[str, Known] = field(default_factory=dict)
    """By name in the library, what it has of these files and of the skeletons of its clips."""
    unpacked: bool = False
    """Whether ``source`` was made for this task alone."""

    def name_of(self, file: Listed) -> str:
        """Give the name in the library of a file."""
        name = file.name.removesuffix(".mcz") if self.compressed else file.name
        return f"{self.into}/{name}" if self.into else name

    def discard(self) -> None:
        """Delete what was made for this task alone."""
        if self.unpacked:
            self.source.remove_all()

    @property
    def size(self) -> int:
        """Bytes of the files."""
        return sum(file.size for file in self.files)


def add(task: Adding) -> Made:
    """Make the shards of files, and write them; nothing of them is seen before it is published."""
    made = Made()
    waiting = list(task.files)
    while waiting:
        with building() as library:
            adder = library.adder(
                task.codec, task.model, overwrite=True, models=task.models, indexed=task.indexed
            )
            full, before = False, made.raw
            while waiting and not full:
                file = waiting.pop(0)
                with _told(file.name, made):
                    if _add(task, file, library, adder):
                        made.raw += file.size
                    else:
                        made.touched[task.name_of(file)] = file.modified
                    # What is in the log does not count for the size of the file.
                    library.db.connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
                full = library.path.stat().st_size >= task.shard_bytes
            if made.raw > before:
                publish(task.store, library, made, lambda name: _coding(task, library, name))
    return made


def _coding(task: Adding, library: Library, name: str) -> str:
    """Say how a clip was asked to be coded; of one that came coded, nobody knows at what level."""
    return f"imported:{library[name].codec}" if task.compressed else codecs.spec(task.codec)


def _add(task: Adding, file: Listed, library: Library, adder: Adder) -> bool:
    """Add a file; give False where it is there already."""
    name = task.name_of(file)
    used: list[Listed] = []
    near = {PurePosixPath(other.name): other for other in task.skeletons}

    def look(ends: tuple[str, ...], own: tuple[str, ...]) -> Used | None:
        path = PurePosixPath(file.name)
        found = choose_beside(path, [p for p in near if p.parent == path.parent], ends, own)
        if found is None:
            return None
        used.append(near[found[0]])
        return Used(str(found[0]), found[1], lambda: task.source.read(str(found[0])))

    source = Source(task.source.read(file.name), file.name, look, limit=task.limit)
    if task.compressed and source.kind != MCZ:
        raise CorruptError("not compressed by mocapress", file=file.name)
    if _is_there(task, file, source):
        return False
    if source.format is not None and source.format.read_skeleton is not None:
        library.add_companion(source, name, file.modified)
        return True

    def companions() -> Sequence[Beside]:
        of = source.format
        if source.used is None or not used or of is None or of.companion is None:
            return ()
        own = used[-1]
        kept = f"{task.into}/{own.name}" if task.into else own.name
        companion = Companion(of.companion, PurePosixPath(own.name).name, source.used.read())
        return [Beside(kept, companion, own.modified)]

    adder.file(source, name, Extra(file.modified, task.labels, beside=companions))
    return True


def _is_there(task: Adding, file: Listed, source: Source) -> bool:
    """Say whether the library has a file, which was only touched, and its skeletons."""
    known = task.known.get(task.name_of(file))
    if known is None or known.sha256 is None or known.sha256 != _digest(source):
        return False
    there = {task.name_of(skeleton): skeleton for skeleton in task.skeletons}
    for name in known.companions:
        now, before = there.get(name), task.known.get(name)
        if now is None or before is None or before[:2] == (now.size, now.modified):
            continue
        if before.sha256 != hashlib.sha256(task.source.read(now.name)).digest():
            return False
    return True


def _digest(source: Source) -> bytes | None:
    """Give the SHA-256 of a file, of a ``.mcz`` that of its original."""
    if source.kind != MCZ:
        return source.digest
    original = open_mcz(source).original
    return original.digest if original else None


@contextmanager
def _told(name: str, made: Made) -> Iterator[None]:
    """Keep what is said of a file, which must not stop the others."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", MotionWarning)
        try:
            yield
        except (MocapressError, OSError) as error:
            text = error.strerror if isinstance(error, OSError) else str(error)
            made.failed.append((name, text or str(error)))
    made.warnings += [(name, str(w.message)) for w in caught if w.category is MotionWarning]


@contextmanager
def building() -> Iterator[Library]:
    """Give a library that is gone at the end."""
    with (
        tempfile.TemporaryDirectory(prefix="mocapress-", ignore_cleanup_errors=True) as folder,
        open_library(Path(folder, "building.mocapdb"), "a") as library,
    ):
        yield library


def publish(
    store: Store, library: Library, made: Made, coding: Callable[[str], str | None]
) -> None:
    """Seal what was built, and write the shard."""
    target = library.path.with_name("sealed.mocapdb")
    name = seal(library.db, target)
    with closing(Database(target, writable=False, wait=WAIT, limit=LIMIT)) as db:
        rows = rows_of(db, name)
    for row in rows:
        if row.get("codec") and row["kind"] == CLIP:
            row["coding"] = coding(row["name"])
    size = target.stat().st_size
    store.put(shard_file(name), target)
    made.shards[name] = size
    made.rows += rows
