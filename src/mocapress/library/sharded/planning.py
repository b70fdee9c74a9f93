"""What adding files to a sharded library takes: tasks of about a shard each."""

import dataclasses
import errno
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from mocapress.errors import MocapressError, ParameterError
from mocapress.formats import by_name, formats, suffixes
from mocapress.library.sharded import archives, manifest
from mocapress.library.sharded.archives import ARCHIVES, Archive
from mocapress.library.sharded.building import Adding, Known
from mocapress.library.sharded.manifest import CLIP, COMPANION, Manifest
from mocapress.library.sharded.store import Listed, Store

_RAW = 8
"""Bytes of files that are taken for one byte of a shard, as motion files are that much larger."""
COMPRESSED = ".mcz"


class Files:
    """The clips and companions of a library, by their names."""

    def __init__(self, found: Manifest) -> None:
        self.known: dict[str, Known] = {}
        wanted = ["kind", "name", "size", "modified", "sha256", "companions"]
        for batch in found.rows.select(wanted).to_batches(max_chunksize=10000):
            columns = (column.to_pylist() for column in batch.columns)
            for kind, name, size, modified, sha256, companions in zip(*columns, strict=True):
                if kind in (CLIP, COMPANION):
                    self.known[name] = Known(size, modified, sha256, tuple(companions or ()))

    def has(self, file: Listed, task: Adding) -> bool:
        """Say whether a file is there with the size, time and skeleton that it has now."""
        found = self.known.get(task.name_of(file))
        if found is None or found.modified != file.modified or found.size != file.size:
            return False
        now = {task.name_of(each): (each.size, each.modified) for each in task.skeletons}
        return all(
            name not in now or (self.known[name].size, self.known[name].modified) == now[name]
            for name in found.companions
            if name in self.known
        )

    def of(self, task: Adding) -> dict[str, Known]:
        """Give what is known of the files of a task and of the skeletons of its clips."""
        own = {task.name_of(file) for file in task.files} & self.known.keys()
        more = {name for clip in own for name in self.known[clip].companions} & self.known.keys()
        return {name: self.known[name] for name in own | more}


@dataclass(frozen=True)
class Plan:
    """What adding the files of a source takes."""

    tasks: Sequence[Adding]
    """Of files that are not there, or not as they are now. Those of an archive are without the
    files yet: ``ready`` gives them with their files."""
    there: Sequence[str]
    """Names of files that are there already."""
    skeletons: Adding
    """All files of skeletons. Those that no clip brings with it are added last; see ``left``."""
    archive: Archive | None = None
    """What the files are members of."""

    @property
    def faults(self) -> list[MocapressError]:
        """What of an archive cannot be read; complete when all tasks were given."""
        found = self.archive
        return [] if found is None else [*found.refused, *([found.damage] if found.damage else [])]

    def ready(self, place: Store) -> Iterator[Adding]:
        """Give the tasks; members of an archive are written to a place when their turn comes."""
        if self.archive is None:
            yield from self.tasks
        else:
            yield from archives.unpacked(self.archive, self.tasks, place)

    def left(self, library: Store, place: Store) -> Iterator[Adding]:
        """Give a task of the skeletons that are not there, once the clips are."""
        if not self.skeletons.files:
            return
        files, task = Files(manifest.load(library)), self.skeletons
        new = [file for file in task.files if not files.has(file, task)]
        if new:
            task = dataclasses.replace(task, files=new)
            task = dataclasses.replace(task, known=files.of(task))
            if self.archive is None:
                yield task
            else:
                yield archives.with_skeletons(self.archive, task, place)


def plan(source: str, found: Manifest, like: Adding, *, compressed: bool = False) -> Plan:
    """Say what adding a folder, one file or a tar archive takes.

    Parameters
    ----------
    source
        A path, or a URL that fsspec opens.
    found
        What is in the library.
    like
        A task without files: how they are added.
    compressed
        Whether ``.mcz`` files are added, and no motion files.

    Raises
    ------
    OSError
        When there is no such folder, or its storage cannot be reached.
    ParameterError
        When there is nothing to add.

    """
    ends = (COMPRESSED,) if compressed else _endings()
    archive = None
    if source.lower().endswith(ARCHIVES) and not compressed and not _is_folder(source):
        archive = archives.read(*_parted(source), ends, _is_skeleton)
        store, listed = archive.store, archive.files
    else:
        store, listed = _listed(source, ends)
    if not listed and not (archive and (archive.damage or archive.refused)):
        what = "motion files, folders or tar archives of them"
        expected = "files that end with .mcz, or folders of them" if compressed else what
        raise ParameterError("nothing to add", file=source, expected=expected)
    skeletons = [file for file in listed if _is_skeleton(file.name)]
    like = dataclasses.replace(like, source=store, skeletons=skeletons)
    files = Files(found)
    tasks: list[Adding] = []
    there = [like.name_of(file) for file in skeletons if files.has(file, like)]
    for group in _groups(
        (file for file in listed if not _is_skeleton(file.name)), like.shard_bytes * _RAW
    ):
        left = [file for file in group if compressed or not files.has(file, like)]
        there += [like.name_of(file) for file in group if file not in left]
        folders = {PurePosixPath(file.name).parent for file in left}
        near = [file for file in skeletons if PurePosixPath(file.name).parent in folders]
        if left:
            task = dataclasses.replace(like, files=left, skeletons=near)
            tasks.append(dataclasses.replace(task, known=files.of(task)))
    return Plan(tasks, there, dataclasses.replace(like, files=skeletons), archive)


def _endings() -> tuple[str, ...]:
    return suffixes(of for of in formats() if of.split or of.read_skeleton)


def _is_folder(source: str) -> bool:
    store = Store(source)
    return store.local is not None and store.local.is_dir()


def _parted(source: str) -> tuple[Store, str]:
    """Give the folder and the name of a file."""
    folder, _, name = source.rstrip("/").rpartition("/")
    return Store(folder or ("/" if source.startswith("/") else ".")), name


def _listed(source: str, ends: tuple[str, ...]) -> tuple[Store, list[Listed]]:
    """Give the folder of a source and the files in it that count; of one file, only this one."""
    store = Store(source)
    if store.local is not None and not store.local.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), source)
    found = store.files()
    if not found:
        store, name = _parted(source)
        found = [file for file in store.files() if file.name == name]
    return store, [
        file
        for file in found
        if file.name.lower().endswith(ends)
        and not any(part.startswith(".") for part in file.name.split("/"))
    ]


def _groups(files: Iterable[Listed], size: int) -> Iterator[list[Listed]]:
    """Take files together until they have so many bytes."""
    group: list[Listed] = []
    reached = 0
    for file in files:
        group.append(file)
        reached += file.size
        if reached >= size:
            yield group
            group, reached = [], 0
    if group:
        yield group


def _is_skeleton(name: str) -> bool:
    of = by_name(name)
    return of is not None and of.read_skeleton is not None and of.split is None
