"""``mocapress bench lossless --cluster``: the clips in parts, each measured by a task elsewhere.

A part is some files of a folder, here or in object storage, or a shard of a sharded library.
"""

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from mocapress.errors import ParameterError
from mocapress.formats import readable, suffixes
from mocapress.library.extracting import items
from mocapress.library.sharded import open_sharded
from mocapress.library.sharded.executor import executor
from mocapress.library.sharded.manifest import newest
from mocapress.library.sharded.remaking import Reading, fetched
from mocapress.library.sharded.store import Listed, Store
from mocapress_bench.lossless import Row, measure

_PART = 2**25
"""Bytes of files from which on a part is complete."""


@dataclass(frozen=True)
class Part:
    """What one task measures: files of a folder, or the clips of a shard."""

    only: str
    repeat: int
    store: Store | None = None
    files: Sequence[Listed] = ()
    beside: Sequence[Listed] = ()
    """Other files of their folders, of which they may need some: skeletons."""
    shard: Reading | None = None


def spread(
    corpus: str, cluster: str, *, only: str, repeat: int, progress: Callable[[str], None]
) -> tuple[list[Row], list[str]]:
    """Measure the clips of a folder or of a sharded library on a cluster; see ``measure``.

    Times are those of the machines of the cluster, sizes those that one machine finds.

    Raises
    ------
    ParameterError
        When there are no clips, or what is said of the cluster or the codecs makes no sense.
    OSError
        When a storage or the cluster cannot be reached.

    """
    parts = [*_shards(corpus, only, repeat)] or [*_files(corpus, only, repeat)]
    if not parts:
        raise ParameterError("no clips", file=corpus, expected="motion files or a sharded library")
    rows: list[Row] = []
    notes: dict[str, None] = {}
    with executor(cluster) as where, ThreadPoolExecutor(where.width) as pool:
        for found, said in pool.map(lambda part: where.call(measured, part), parts):
            rows += found
            notes |= dict.fromkeys(said)
            progress(f"{len(rows)} rows")
    return rows, [*notes]


def measured(part: Part) -> tuple[list[Row], list[str]]:
    """Measure a part, of which the files are fetched first."""
    with tempfile.TemporaryDirectory(prefix="mocapress-", ignore_cleanup_errors=True) as place:
        folder = Path(place)
        if part.shard is not None:
            with fetched(part.shard, "r") as library:
                clips = [library[name] for name in sorted(part.shard.clips.values())]
                names = [clip.name for clip in clips if clip.sha256 is not None]
                for item in items(library, [library[name] for name in names], every=False):
                    target = folder / item.name
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(item.read(False))
        else:
            assert part.store is not None
            names = [file.name for file in part.files]
            for file in (*part.files, *part.beside):
                target = folder / file.name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(part.store.read(file.name))
        paths = [folder / name for name in names if name.lower().endswith(suffixes(readable()))]
        return measure(paths, folder, only=part.only, repeat=part.repeat)


def _shards(corpus: str, only: str, repeat: int) -> Iterator[Part]:
    """Give a part for each shard, if it is a sharded library."""
    if newest(Store(corpus)):
        with open_sharded(corpus) as library:
            for task in library.reading_tasks(library.clips()):
                yield Part(only, repeat, shard=task)


def _files(corpus: str, only: str, repeat: int) -> Iterator[Part]:
    store = Store(corpus)
    files = store.files()
    motion = [file for file in files if file.name.lower().endswith(suffixes(readable()))]
    others = [file for file in files if file.name.lower().endswith(".asf")]
    for group in _groups(motion):
        folders = {PurePosixPath(file.name).parent for file in group}
        near = [file for file in others if PurePosixPath(file.name).parent in folders]
        yield Part(only, repeat, store, group, near)


def _groups(files: Iterable[Listed]) -> Iterator[list[Listed]]:
    group: list[Listed] = []
    for file in files:
        group.append(file)
        if sum(each.size for each in group) >= _PART:
            yield group
            group = []
    if group:
        yield group
