"""The tasks that read shards, or make them anew; each can run on any machine."""

import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mocapress import codecs
from mocapress.codecs import Codec, Scope
from mocapress.errors import CorruptError, MocapressError
from mocapress.library.checking import Fault, check, verify_clip
from mocapress.library.library import Library, open_library
from mocapress.library.sharded.building import Made, publish
from mocapress.library.sharded.manifest import shard_file
from mocapress.library.sharded.sealing import digest_of
from mocapress.library.sharded.store import Store
from mocapress.source import LIMIT


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
    limit: int | None = LIMIT
    """Bytes that may be restored of a clip."""


@contextmanager
def fetched(task: Reading, mode: str) -> Iterator[Library]:
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
        with open_library(path, mode, limit=task.limit) as library:
            yield library


def verify(task: Reading, *, decode: bool = True) -> list[Fault]:
    """Check a shard's digest, and decode its clips; give what is damaged."""
    with fetched(task, "r") as library:
        if not decode:
            return [fault for faults in check(library.db) for fault in faults]
        return [
            fault
            for number, name in task.clips.items()
            for fault in verify_clip(library.db, number, name)
        ]


@dataclass(frozen=True)
class Recoding:
    """A shard to make anew: without clips that do not count, with some coded or indexed anew."""

    of: Reading
    codec: Codec | None = None
    chosen: frozenset[str] = frozenset()
    """Clips to code anew."""
    indexed: bool = False
    """Whether all clips are indexed for search anew."""
    joints: Mapping[str, str] | None = None
    """For the index, as in ``Library.reindex``."""


def remake(task: Recoding) -> Made:
    """Make a shard anew, and write it under its own new name."""
    made = Made()
    with fetched(task.of, "a") as library:
        counted = set(task.of.clips)
        gone = [clip.id for clip in library.clips() if clip.id not in counted]
        if gone:
            library.remove(*gone)
        recoded = dict[str, str]()
        if task.codec is not None:
            recoded = _recode(library, task.codec, sorted(task.chosen), made)
        if task.indexed:
            done = library.reindex(task.joints)
            made.indexed = done.clips, done.without
            made.failed += [(error.file or "", str(error)) for error in done.failed]
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
