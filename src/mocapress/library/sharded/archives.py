"""Tar archives as sources of a sharded library: their members, a task's worth at a time.

An archive is read twice as a stream: for the names of its members, by which the work is divided,
and for their contents, which are written to a place from where tasks read them.
"""

import dataclasses
import lzma
import shutil
import tarfile
import tempfile
import uuid
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from mocapress.errors import FormatError, MocapressError
from mocapress.library import names
from mocapress.library.sharded.building import Adding
from mocapress.library.sharded.executor import LOCAL
from mocapress.library.sharded.store import Listed, Store

ARCHIVES = (".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz2", ".tar.xz", ".txz")
_BROKEN = (tarfile.TarError, EOFError, zlib.error, lzma.LZMAError)


@dataclass
class Archive:
    """An archive, as far as it can be read."""

    store: Store
    name: str
    files: list[Listed] = field(default_factory=list)
    """The members that count, in their order; the last one of each name."""
    at: dict[str, int] = field(default_factory=dict)
    """By name, the place of the member among all."""
    skeletons: dict[str, bytes] = field(default_factory=dict)
    """By name, the contents of small members, which those before them may need."""
    refused: list[MocapressError] = field(default_factory=list)
    """Members whose names lead elsewhere."""
    damage: MocapressError | None = None
    """Why it cannot be read to its end."""

    def file(self) -> str:
        """Name it in messages."""
        return self.store.file(self.name)


def read(
    store: Store, name: str, ends: tuple[str, ...], is_skeleton: Callable[[str], bool]
) -> Archive:
    """Read which members an archive has.

    Raises
    ------
    OSError
        When it cannot be opened.

    """
    found = Archive(store, name)
    members: dict[str, Listed] = {}
    with _damage_kept(found), _opened(found) as archive:
        for number, entry in enumerate(archive):
            own = entry.name.removeprefix("./")
            hidden = any(part.startswith(".") and part != ".." for part in own.split("/"))
            if not entry.isreg() or hidden or not own.lower().endswith(ends):
                continue
            try:
                names.checked(own)
            except MocapressError as error:
                error.file = found.file()
                found.refused.append(error)
                continue
            if is_skeleton(own):
                part = archive.extractfile(entry)
                found.skeletons[own] = part.read() if part else b""
            members.pop(own, None)
            members[own] = Listed(own, entry.size, int(entry.mtime * 10**9))
            found.at[own] = number
    found.files = [*members.values()]
    return found


def unpacked(found: Archive, tasks: Sequence[Adding], place: Store) -> Iterator[Adding]:
    """Give the tasks, which follow each other in the archive, each with its files at a place."""
    waiting = [*tasks]
    at = {found.at[file.name]: file for task in tasks for file in task.files}
    written = set[str]()
    with tempfile.TemporaryDirectory(prefix="mocapress-") as folder:
        with _damage_kept(found), _opened(found) as archive:
            for number, entry in enumerate(archive):
                if not waiting:
                    return
                file = at.get(number)
                if file is None:
                    continue
                _write(archive, entry, Path(folder, file.name))
                written.add(file.name)
                if written.issuperset(each.name for each in waiting[0].files):
                    yield _placed(found, waiting.pop(0), place, Path(folder))
                    written.clear()
        # Of what is damaged, the members before the damage count.
        left = [file for task in waiting[:1] for file in task.files if file.name in written]
        if left:
            yield _placed(found, dataclasses.replace(waiting[0], files=left), place, Path(folder))


def _write(archive: tarfile.TarFile, entry: tarfile.TarInfo, target: Path) -> None:
    """Write a member, all of it."""
    target.parent.mkdir(parents=True, exist_ok=True)
    part = archive.extractfile(entry)
    with target.open("wb") as stream:
        if part is not None:
            shutil.copyfileobj(part, stream)
    if target.stat().st_size != entry.size:
        raise tarfile.ReadError("unexpected end of data")


def with_skeletons(found: Archive, task: Adding, place: Store) -> Adding:
    """Give a task of skeletons with its files at a place."""
    with tempfile.TemporaryDirectory(prefix="mocapress-") as folder:
        return _placed(found, task, place, Path(folder))


def _placed(found: Archive, task: Adding, place: Store, folder: Path) -> Adding:
    """Put the files of a task, which are in a folder, and its skeletons to where it reads them."""
    for file in task.skeletons:
        target = folder / file.name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(found.skeletons[file.name])
    source = Store(place.file(uuid.uuid4().hex))
    source.put_folder(folder)
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    return dataclasses.replace(task, source=source, unpacked=True)


@contextmanager
def place_for(store: Store, cluster: str | None) -> Iterator[Store]:
    """Give where members are written, from where all who do the tasks can read them.

    That is on this machine, or beside the shards where other machines do them.
    """
    if cluster is None or cluster.startswith(LOCAL):
        with tempfile.TemporaryDirectory(prefix="mocapress-", ignore_cleanup_errors=True) as folder:
            yield Store(folder)
        return
    place = Store(store.file(f"unpacked/{uuid.uuid4().hex}"))
    try:
        yield place
    finally:
        place.remove_all()


@contextmanager
def _opened(found: Archive) -> Iterator[tarfile.TarFile]:
    with (
        found.store.open(found.name) as stream,
        tarfile.open(fileobj=stream, mode="r|*") as archive,
    ):
        yield archive


@contextmanager
def _damage_kept(found: Archive) -> Iterator[None]:
    try:
        yield
    except _BROKEN as error:
        text = f"the archive cannot be read to its end ({error})"
        found.damage = FormatError(text, file=found.file())
