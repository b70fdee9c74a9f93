"""The tasks of a sharded library: each makes or reads a shard, and can run on any machine."""

import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from mocapress import codecs
from mocapress.codecs import Codec, Model, Scope
from mocapress.container import Companion
from mocapress.errors import CorruptError, MocapressError, MotionWarning
from mocapress.library.adding import Beside, Extra
from mocapress.library.checking import Fault, check, verify_clip
from mocapress.library.database import WAIT, Database
from mocapress.library.library import Library, open_library
from mocapress.library.sharded.manifest import CLIP, shard_file
from mocapress.library.sharded.sealing import digest_of, rows_of, seal
from mocapress.library.sharded.store import Listed, Store
from mocapress.source import Beside as Used
from mocapress.source import Source, choose_beside


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
    raw: int = 0
    """Bytes of the files."""
    sizes: tuple[int, int] = (0, 0)
    """Bytes of chunks before and afterwards, of clips that were coded anew."""


@dataclass(frozen=True)
class Adding:
    """Files to make a shard of, or more where they are large."""

    store: Store
    source: Store
    files: Sequence[Listed]
    skeletons: Sequence[Listed]
    """Files of skeletons that may lie beside them."""
    into: str
    codec: Codec
    model: Model | None
    labels: Sequence[str]
    shard_bytes: int
    indexed: bool = True
    """Whether they can be searched for at once."""

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
            adder = library.adder(task.codec, task.model, overwrite=True, indexed=task.indexed)
            full, before = False, made.raw
            while waiting and not full:
                file = waiting.pop(0)
                with _told(file.name, made):
                    _add(task, file, library, adder.file)
                    made.raw += file.size
                    # What is in the log does not count for the size of the file.
                    library.db.connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
                full = library.path.stat().st_size >= task.shard_bytes
            if made.raw > before:
                publish(task.store, library, made, lambda _: codecs.spec(task.codec))
    return made


def _add(task: Adding, file: Listed, library: Library, add_file: Callable[..., Any]) -> None:
    name = f"{task.into}/{file.name}" if task.into else file.name
    used: list[Listed] = []
    near = {PurePosixPath(other.name): other for other in task.skeletons}

    def look(ends: tuple[str, ...], own: tuple[str, ...]) -> Used | None:
        path = PurePosixPath(file.name)
        found = choose_beside(path, [p for p in near if p.parent == path.parent], ends, own)
        if found is None:
            return None
        used.append(near[found[0]])
        return Used(str(found[0]), found[1], lambda: task.source.read(str(found[0])))

    source = Source(task.source.read(file.name), file.name, look)
    if source.format is not None and source.format.read_skeleton is not None:
        library.add_companion(source, name, file.modified)
        return

    def companions() -> Sequence[Beside]:
        of = source.format
        if source.used is None or not used or of is None or of.companion is None:
            return ()
        own = used[-1]
        kept = f"{task.into}/{own.name}" if task.into else own.name
        companion = Companion(of.companion, PurePosixPath(own.name).name, source.used.read())
        return [Beside(kept, companion, own.modified)]

    add_file(source, name, Extra(file.modified, task.labels, beside=companions))


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
    with closing(Database(target, writable=False, wait=WAIT)) as db:
        rows = rows_of(db, name)
    for row in rows:
        if row.get("codec") and row["kind"] == CLIP:
            row["coding"] = coding(row["name"])
    size = target.stat().st_size
    store.put(shard_file(name), target)
    made.shards[name] = size
    made.rows += rows


@dataclass(frozen=True)
class Reading:
    """A shard to read, and the clips that count of it."""

    store: Store
    shard: str
    size: int
    """Bytes of the shard."""
    clips: dict[int, str]
    """Ids in the shard, and names."""
    codings: dict[str, str]
    """How each clip is coded, as the manifest has it."""


@contextmanager
def _fetched(task: Reading, mode: str) -> Iterator[Library]:
    """Give a shard as a library on this machine.

    Raises
    ------
    CorruptError
        When it is missing or damaged.

    """
    file = shard_file(task.shard)
    with tempfile.TemporaryDirectory(prefix="mocapress-", ignore_cleanup_errors=True) as folder:
        path = Path(folder, "shard.mocapdb")
        try:
            task.store.fetch(file, path)
        except FileNotFoundError as error:
            raise CorruptError(
                f"the shard is missing, and its {len(task.clips)} clips with it",
                file=task.store.file(file),
                expected=f"a file of {task.size} bytes",
            ) from error
        found = digest_of(path)
        if found != task.shard:
            raise CorruptError(
                "the shard is damaged", file=task.store.file(file), expected=task.shard, found=found
            )
        with open_library(path, mode) as library:
            yield library


def verify(task: Reading, *, decode: bool = True) -> list[Fault]:
    """Check a shard's digest, and decode its clips; give what is damaged."""
    with _fetched(task, "r") as library:
        if not decode:
            return [fault for faults in check(library.db) for fault in faults]
        return [
            fault
            for number, name in task.clips.items()
            for fault in verify_clip(library.db, number, name)
        ]


@dataclass(frozen=True)
class Recoding:
    """A shard to make anew: without clips that do not count, and with some coded anew."""

    of: Reading
    codec: Codec | None = None
    chosen: frozenset[str] = frozenset()
    """Clips to code anew."""


def remake(task: Recoding) -> Made:
    """Make a shard anew, and write it under its own new name."""
    made = Made()
    with _fetched(task.of, "a") as library:
        counted = set(task.of.clips)
        gone = [clip.id for clip in library.clips() if clip.id not in counted]
        if gone:
            library.remove(*gone)
        recoded = dict[str, str]()
        if task.codec is not None:
            recoded = _recode(library, task.codec, sorted(task.chosen), made)
        publish(
            task.of.store,
            library,
            made,
            lambda name: recoded.get(name, task.of.codings.get(name)),
        )
    return made


def _recode(library: Library, codec: Codec, names: Sequence[str], made: Made) -> dict[str, str]:
    spec = codecs.spec(codec)
    sizes: Counter[str] = Counter()
    if codec.can.scope is Scope.LIBRARY:
        done = library.recompress_together(names, codec)
    else:
        done = {}
        for name in names:
            try:
                done[name] = library.recompress(name, codec)
            except MocapressError as error:
                made.failed.append((name, str(error)))
    for before, after in done.values():
        sizes["before"] += before
        sizes["after"] += after
    made.sizes = sizes["before"], sizes["after"]
    return dict.fromkeys(done, spec)
