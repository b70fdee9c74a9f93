"""What is to be added to a library: files, files below folders, members of tar archives."""

import lzma
import sys
import tarfile
import threading
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from mocapress.cli.batch import STREAM, Job, find, is_folder, size_of, usage
from mocapress.container import Companion
from mocapress.errors import FormatError, ParameterError
from mocapress.formats import by_name, formats, suffixes
from mocapress.library.adding import Added, Adder, Beside, Extra
from mocapress.library.library import Library, beside, modified_of
from mocapress.source import LIMIT, ONLY_ONE, Source, choose_beside
from mocapress.source import Beside as Used

ARCHIVES = (".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz2", ".tar.xz", ".txz")


def endings() -> tuple[str, ...]:
    """Give the suffixes of the files that are taken from folders and archives."""
    return suffixes(of for of in formats() if of.split or of.read_skeleton)


@dataclass(slots=True, eq=False)
class Member(Job):
    """A member of an archive."""

    data: bytes = b""
    changed: int = 0
    """When the member was last changed, in nanoseconds since 1970."""
    skeletons: "Skeletons | None" = None
    again: bool = False
    """Whether it was added before its skeleton was known."""
    done: threading.Event = field(default_factory=threading.Event)


class Skeletons:
    """Files of skeletons in an archive, as far as it was read."""

    def __init__(self) -> None:
        self._found: dict[PurePosixPath, tuple[bytes, int]] = {}
        self.complete = False

    def keep(self, name: str, data: bytes, changed: int) -> None:
        """Keep a file."""
        self._found[PurePosixPath(name)] = data, changed

    def beside(
        self, name: str, endings: tuple[str, ...], own: tuple[str, ...]
    ) -> tuple[str, str, bytes, int] | None:
        """Give name, how it was found, contents and time of the skeleton of a member."""
        path = PurePosixPath(name)
        folder = [other for other in [*self._found] if other.parent == path.parent]
        found = choose_beside(path, folder, endings, own)
        # As long as files may come, the only one is not known to be that.
        if found is None or (found[1] == ONLY_ONE and not self.complete):
            return None
        return str(found[0]), found[1], *self._found[found[0]]


@dataclass(slots=True)
class Inputs:
    """The files to add."""

    paths: Sequence[Path]
    into: str
    """Folder in the library; empty for none."""
    asf: str | None
    limit: int | None = None
    """Bytes that may be decoded of a file; None for the usual number."""
    left_out: int = 0
    """Members of archives that are no motion."""
    _origins: dict[str, Path] = field(default_factory=dict)
    """Where each file came from, where some come from archives."""

    @property
    def size(self) -> float | None:
        """Bytes of all inputs; None where that is not known."""
        if STREAM in self.paths:
            return None
        return sum(job.share for path in self.paths for job in _files(path)) or None

    def jobs(self) -> "Sequence[Job] | Iterator[Job]":
        """Give a job for each file; of archives as they are read."""
        if not any(_is_archive(path) for path in self.paths):
            jobs = [job for path in self.paths for job in find([path], endings())]
            _refuse_equal(jobs)
            return jobs
        return self._streamed()

    def _streamed(self) -> Iterator[Job]:
        for path in self.paths:
            if _is_archive(path):
                yield from self._members(path)
            else:
                for job in find([path], endings()):
                    yield self._second(str(job.source.relative_to(job.base)), path) or job

    def _second(self, name: str, origin: Path) -> Job | None:
        """Give a job that fails for a file whose name another input has had.

        Within one archive the last file of a name counts, as tar has it.
        """
        other = self._origins.setdefault(name, origin)
        if other == origin:
            return None
        failed = Job(Path(name), Path(), stored=True)
        failed.error = ParameterError(
            f"{other} has a file of this name, too; add one of them with --into",
            file=f"{origin}: {name}",
        )
        return failed

    def _members(self, path: Path) -> Iterator[Job]:
        try:
            with sys.stdin.buffer if path == STREAM else path.open("rb") as stream:
                yield from self._read(path, stream)
        except OSError as error:
            failed = Job(path, path.parent, stored=True)
            failed.error = error
            yield failed

    def _read(self, path: Path, stream: BinaryIO) -> Iterator[Job]:
        skeletons, late, reached = Skeletons(), list[Member](), 0
        try:
            with tarfile.open(fileobj=stream, mode="r|*") as archive:
                for entry in archive:
                    name = entry.name.removeprefix("./")
                    if not entry.isreg() or not name.lower().endswith(endings()):
                        self.left_out += entry.isreg()
                        continue
                    if (failed := self._second(name, path)) is not None:
                        yield failed
                        continue
                    part = archive.extractfile(entry)
                    data = part.read() if part else b""
                    if len(data) != entry.size:
                        raise tarfile.ReadError("unexpected end of data")
                    changed = int(entry.mtime * 10**9)
                    at = stream.tell() if stream.seekable() else 0
                    member = Member(Path(name), Path(), stored=True, share=at - reached)
                    member.data, member.changed, member.skeletons = data, changed, skeletons
                    reached = at
                    of = by_name(name)
                    if of is not None and of.read_skeleton:
                        skeletons.keep(name, data, changed)
                    elif of is not None and of.companion:
                        companion = by_name(f".{of.companion}")
                        ends = companion.suffixes if companion else ()
                        if skeletons.beside(name, ends, of.suffixes) is None:
                            late.append(member)
                    yield member
        except (tarfile.TarError, EOFError, zlib.error, lzma.LZMAError, OSError) as error:
            failed = Job(path, path.parent, stored=True)
            failed.error = FormatError(
                f"the archive cannot be read to its end ({error})", file=str(path)
            )
            yield failed
        skeletons.complete = True
        for member in late:
            yield Member(
                member.source,
                Path(),
                stored=True,
                share=0,
                changed=member.changed,
                skeletons=skeletons,
                again=True,
                done=member.done,
            )

    def add(self, job: Job, library: Library, adder: Adder, labels: Sequence[str]) -> Added:
        """Add the file of a job."""
        own = str(job.source.relative_to(job.base)) if not job.stored else str(job.source)
        name = f"{self.into}/{own}" if self.into else own
        if isinstance(job, Member):
            return self._add_member(job, name, library, adder, labels)
        changed = job.source.stat()
        turned = self._skeleton_changed(job, library, name)
        known = library.has(name, changed.st_size, changed.st_mtime_ns)
        if known and not labels and not turned:
            return library.unchanged(name)
        source = job.opened(self.limit)
        if source.format is not None and source.format.read_skeleton is not None:
            return library.add_companion(source, name)
        extra = Extra(modified_of(source), labels, beside=lambda: beside(source, name))
        return adder.file(source, name, extra, self.asf, again=turned)

    def _skeleton_changed(self, job: Job, library: Library, name: str) -> bool:
        """Say whether the skeleton's file that a clip was added with says something else now."""
        for companion in library.companions(name):
            of = by_name(companion)
            file = Path(self.asf or job.source.parent / PurePosixPath(companion).name)
            if of is not None and of.read_skeleton is not None and file.is_file():
                try:
                    skeleton = of.read_skeleton(file.read_bytes(), str(file))
                except FormatError:
                    return False  # which is told of where a clip is added with it
                return not library.has_skeleton(name, skeleton)
        return False

    def _add_member(
        self, job: Member, name: str, library: Library, adder: Adder, labels: Sequence[str]
    ) -> Added:
        own, skeletons = str(job.source), job.skeletons
        assert skeletons is not None
        if job.again:
            job.done.wait()
            if name not in library:
                raise ParameterError("was not added, so it gets no skeleton", file=own)
            if library[name].skeleton is not None:
                return library.unchanged(name)
            job.data = library.read_bytes(name)
        elif library.has(name, len(job.data), job.changed) and not labels:
            job.done.set()
            return library.unchanged(name)
        found: list[tuple[str, str, bytes, int]] = []

        def look(ends: tuple[str, ...], of: tuple[str, ...]) -> Used | None:
            chosen = skeletons.beside(own, ends, of)
            if chosen is None:
                return None
            found.append(chosen)
            return Used(chosen[0], chosen[1], lambda: chosen[2])

        source = Source(job.data, own, look, limit=LIMIT if self.limit is None else self.limit)
        if source.format is not None and source.format.read_skeleton is not None:
            return library.add_companion(source, name, job.changed)

        def companions() -> Sequence[Beside]:
            of = source.format
            if source.used is None or not found or of is None or of.companion is None:
                return ()
            file, _, data, changed = found[-1]
            kept = f"{self.into}/{file}" if self.into else file
            return [Beside(kept, Companion(of.companion, PurePosixPath(file).name, data), changed)]

        try:
            extra = Extra(job.changed, labels, beside=companions)
            return adder.file(source, name, extra, self.asf, again=job.again)
        finally:
            job.data = b""
            job.done.set()


def _is_archive(path: Path) -> bool:
    return path == STREAM or (path.name.lower().endswith(ARCHIVES) and not is_folder(path))


def _files(path: Path) -> Sequence[Job]:
    if _is_archive(path):
        return [Job(path, path.parent, share=size_of(path))]
    return find([path], endings())


def _refuse_equal(jobs: Sequence[Job]) -> None:
    """Refuse different files that would have one name: the last would replace the others."""
    sources: dict[Path, Path] = {}
    for job in jobs:
        own = job.source.relative_to(job.base)
        other = sources.setdefault(own, job.source)
        if other != job.source:
            usage(
                f"{other} and {job.source} would both be {own} in the library; nothing was added; "
                "--into gives one of them another folder"
            )
