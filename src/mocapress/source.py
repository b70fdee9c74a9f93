"""What a user names: a path, bytes or a stream, with what lies beside it.

Whatever a command or a function does with a user's file begins here.
"""

import errno
import hashlib
import os
import re
import stat
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path, PurePath
from typing import BinaryIO, TypeVar

import numpy as np

from mocapress import formats
from mocapress.errors import (
    CorruptError,
    FormatError,
    LimitError,
    MocapressError,
    MotionWarning,
    ParameterError,
)
from mocapress.formats import Format, Split
from mocapress.formats.problems import Problem
from mocapress.motion import Clip, Skeleton
from mocapress.motion.columns import skeleton_columns

Named = str | Path | bytes | bytearray | memoryview | BinaryIO
"""What can be named: a path, the contents themselves, or a stream that is read to its end."""

MCZ, MCM, DIFFMA_JSON = "mcz", "mcm", "diffma.json"
"""Kinds of files that only mocapress writes, or (DiffMA JSON) that are no format of numbers."""
JSON_SUFFIXES = (".diffma.json", ".diffma.json.xz")
_MAGICS = {b"\x89MCZ": MCZ, b"\x89MCM": MCM}
_XZ = b"\xfd7zXZ\x00"
_HEAD = 2**16
_MOST_BESIDE = 2**22
"""Bytes of a file beside, of names and the like, that are read."""
LIMIT = 2**32
"""Bytes that may be restored from a source, unless the user says otherwise."""


GIVEN, SAME_NAME, SUBJECT = "given", "same name", "subject"
ONLY_ONE, EMBEDDED = "only one in the folder", "embedded"
T = TypeVar("T")
P = TypeVar("P", bound=PurePath)


@dataclass(frozen=True, slots=True)
class Beside:
    """The skeleton of a motion file that has none in itself."""

    file: str
    """Path; of an embedded one, that of the file it is embedded in."""
    found: str
    """``given``, ``same name``, ``subject``, ``only one in the folder`` or ``embedded``."""
    read: Callable[[], bytes]
    """Gives its contents."""


class Source:
    """A path, bytes or a stream.

    Parameters
    ----------
    named
        A path, the contents, or a binary stream, which is read to its end. A regular file is read
        when and as far as it is asked for.
    name
        For messages, and to tell the kind by its suffix; without it, the path.
    look
        Finds the skeleton of a file that does not lie in a folder: given the suffixes of skeletons
        and those of the file's format.
    limit
        Bytes that may be restored from it: of a file, or of numbers, 8 each; None for any.

    Raises
    ------
    OSError
        When it cannot be opened or read.

    """

    def __init__(
        self,
        named: Named,
        name: str | None = None,
        look: "Callable[[tuple[str, ...], tuple[str, ...]], Beside | None] | None" = None,
        *,
        limit: int | None = LIMIT,
    ) -> None:
        self.limit = limit
        self.path = Path(named) if isinstance(named, str | Path) else None
        self.name = _name(named) if name is None else name
        self.used: Beside | None = None
        """The skeleton that was used, of those that lie beside the file or in it."""
        self.warnings: list[MotionWarning] = []
        self._look = look
        self._descriptor: int | None = None
        if isinstance(named, bytes | bytearray | memoryview):
            self._contents = bytes(named)
        elif self.path is None and not hasattr(named, "read"):
            msg = f"expected a path, bytes or a binary stream, not {type(named).__name__}"
            raise TypeError(msg)
        elif self.path is None:
            self._contents = _drained(named)  # type: ignore[arg-type]
        else:
            self._open(self.path)

    def _open(self, path: Path) -> None:
        try:
            descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        except PermissionError:
            if path.is_dir():  # Windows opens no folder
                raise IsADirectoryError(
                    errno.EISDIR, os.strerror(errno.EISDIR), str(path)
                ) from None
            raise
        # Whatever is renamed to the path meanwhile, all reads are of the file that was opened.
        weakref.finalize(self, os.close, descriptor)
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if stat.S_ISREG(mode):
            self._descriptor = descriptor
        else:
            with os.fdopen(os.dup(descriptor), "rb") as stream:
                self._contents = stream.read()

    @property
    def size(self) -> int:
        """Number of bytes."""
        if self._descriptor is None:
            return len(self._contents)
        return os.fstat(self._descriptor).st_size

    def read(self, start: int = 0, stop: int | None = None) -> bytes:
        """Give bytes [start, stop), or as many of them as there are.

        Files are read plainly, never mapped into memory: one that another program cuts short
        meanwhile gives fewer bytes instead of ending the process.
        """
        if self._descriptor is None:
            whole = start == 0 and (stop is None or stop >= len(self._contents))
            return self._contents if whole else self._contents[start:stop]
        stop = self.size if stop is None else stop
        parts = []
        while start < stop and (part := _pread(self._descriptor, stop - start, start)):
            parts.append(part)
            start += len(part)
        return b"".join(parts) if len(parts) != 1 else parts[0]

    def allow(self, size: int) -> None:
        """See that so many bytes may be restored.

        Raises
        ------
        UnsupportedError
            When they are more than the limit.

        """
        if self.limit is not None and size > self.limit:
            raise LimitError(self.limit, size, self.name or None)

    def printed(self, print_file: Callable[[int], bytes], most: int) -> bytes:
        """Print a file of at most so many bytes, and of no more than may be restored.

        Raises
        ------
        CorruptError
            When it would be longer.
        UnsupportedError
            When it would be longer than the limit.

        """
        if self.limit is None or most <= self.limit:
            return print_file(most)
        try:
            return print_file(self.limit)
        except CorruptError:
            self.allow(self.limit + 1)
            raise

    @cached_property
    def data(self) -> bytes:
        """All bytes, read once."""
        return self.read()

    @cached_property
    def digest(self) -> bytes:
        """SHA-256 of all bytes."""
        return hashlib.sha256(self.data).digest()

    @cached_property
    def kind(self) -> str:
        """Id of a format, ``mcz``, ``mcm``, ``diffma.json``, or empty where it is none of them."""
        head = self.read(0, _HEAD)
        if head[:4] in _MAGICS:
            return _MAGICS[head[:4]]
        if self.name.lower().endswith(JSON_SUFFIXES):
            return DIFFMA_JSON
        found = formats.recognise(head, self.name)
        if found is not None:
            return found.id
        return DIFFMA_JSON if head[:6] == _XZ or head[:64].lstrip()[:1] == b"{" else ""

    @property
    def format(self) -> Format | None:
        """The format of a motion file; None for other files."""
        known = self.kind and self.kind not in (MCZ, MCM, DIFFMA_JSON)
        return formats.by_id(self.kind) if known else None

    def split(
        self,
        asf_path: str | Path | None = None,
        of: Format | None = None,
        contents: bytes | None = None,
    ) -> Split:
        """Take a motion file apart, with the skeleton given or found beside it.

        Parameters
        ----------
        asf_path
            The skeleton's file, where the user names one.
        of, contents
            The motion file, where it is packed in this one.

        Raises
        ------
        FormatError
            When it is no motion file, when not a single frame can be read, or when the skeleton
            that was given is broken or another's. One that was merely found is then left away,
            with a warning.

        """
        of = of or self.format
        take_apart = (of.split or of.read) if of else None
        if of is None or take_apart is None:
            known = formats.listed(formats.readable())
            raise FormatError("not a motion file", file=self.name or None, expected=known)
        data = self.data if contents is None else contents

        def taken_apart(skeleton: Skeleton | None) -> Split:
            return take_apart(data, skeleton, self.name or None)

        parts = self.with_skeleton(of, taken_apart, asf_path)
        return parts._replace(clip=self.told(parts.clip))

    def with_skeleton(
        self,
        of: Format,
        make: Callable[[Skeleton | None], T],
        asf_path: str | Path | None = None,
        embedded: bytes = b"",
    ) -> T:
        """Make something with the skeleton that belongs to this file; see ``used`` afterwards.

        Parameters
        ----------
        of
            The format of the file, or of what it was compressed from.
        make
            Makes it with a skeleton, or without; raises ``FormatError`` where the skeleton does not
            fit.
        asf_path
            The skeleton's file, where the user names one.
        embedded
            The contents of a skeleton's file that is in this file.

        """
        companion = formats.by_id(of.companion) if of.companion else None
        if companion is None or companion.read_skeleton is None:
            return make(None)
        beside = self._beside(companion, of, asf_path, embedded)
        if beside is None:
            return make(None)
        certain = beside.found in (GIVEN, EMBEDDED)
        try:
            skeleton = companion.read_skeleton(beside.read(), beside.file)
        except (FormatError, OSError) as error:
            if certain:
                raise
            self._left_away("broken-skeleton", "cannot be read", error, beside)
            return make(None)
        try:
            made = make(skeleton)
        except FormatError as error:
            made = make(None)  # where this fails too, the fault is not the skeleton's
            error.file, error.line, error.offset = beside.file, None, None
            if certain:
                raise error from None
            self._left_away("foreign-skeleton", "is of another figure", error, beside)
            return made
        self.used = beside
        return made

    def _beside(
        self, companion: Format, of: Format, asf_path: str | Path | None, embedded: bytes
    ) -> Beside | None:
        if asf_path is not None:
            return Beside(str(asf_path), GIVEN, Source(asf_path).read)
        if embedded:
            return Beside(self.name, EMBEDDED, lambda: embedded)
        if self._look is not None:
            return self._look(companion.suffixes, of.suffixes)
        found = find_beside(self.path, companion.suffixes, of.suffixes) if self.path else None
        if found is None:
            return None
        path, how = found
        return Beside(str(path), how, lambda: Source(path).read())

    def _left_away(
        self, name: str, fault: str, error: FormatError | OSError, beside: Beside
    ) -> None:
        if isinstance(error, OSError):
            error = FormatError(error.strerror or str(error), file=beside.file)
        without = f"so {Path(self.name).name} is taken without a skeleton"
        error.what = f"{fault}, {without}: {error.what}"
        self.warn(name, error)

    def accept(self, problems: Sequence[Problem], *, strict: bool = True) -> None:
        """Refuse a file that has lost motion, where reading is strict; warn of all else.

        Raises
        ------
        FormatError
            With place, expected and found.

        """
        file = self.name or None
        lost = next((problem for problem in problems if problem.loses_motion), None)
        if strict and lost is not None:
            raise lost.error(file)
        for problem in problems:
            self.warn(problem.name, problem.error(file))

    def told(self, clip: Clip) -> Clip:
        """Say in a clip's metadata which skeleton was used, and how it was found."""
        if self.used is None:
            return clip
        facts = {"skeleton": self.used.file, "skeleton_found": self.used.found}
        return replace(clip, metadata={**clip.metadata, **facts})

    def described(self, of: Format, layout: object, clip: Clip) -> Clip:
        """Give streams the names and units that a layout knows, or a file beside this one."""
        if of.describe is None:
            return clip
        try:
            return of.describe(layout, clip, self._near)
        except FormatError as error:
            if not error.file:
                raise
            error.what = f"is left away, because it does not fit: {error.what}"
            self.warn("foreign-companion", error)
            return of.describe(layout, clip, lambda _, __: None)

    def _near(self, ending: str, instead: str) -> bytes | None:
        """Give a file in the same folder whose name has another ending, of those without suffix."""
        if self.path is None:
            return None
        stem = _without(self.path.name, (".mcz",))
        stem = stem if stem.endswith(ending) else stem.rpartition(".")[0]
        if not stem.endswith(ending):
            return None
        place = self.path.with_name(stem[: len(stem) - len(ending)] + instead)
        try:
            return Source(place).read(0, _MOST_BESIDE) if place.is_file() else None
        except OSError:
            return None

    def warn_of_guess(self) -> None:
        """Warn where the skeleton that was used was merely the only one in the folder."""
        if self.used is not None and self.used.found == ONLY_ONE:
            fact = MocapressError(
                f"taken as the skeleton of {Path(self.name).name} because it is the only one in "
                "the folder; that of another figure gives wrong bones",
                file=self.used.file,
            )
            self.warn("guessed-skeleton", fact)

    def warn(self, name: str, fact: MocapressError) -> None:
        """Warn of something, as from the line outside mocapress that led here, and keep it."""
        warning = MotionWarning(name, fact)
        self.warnings.append(warning)
        frame, level = sys._getframe(), 1
        while frame.f_back and frame.f_globals["__name__"].partition(".")[0] == "mocapress":
            frame, level = frame.f_back, level + 1
        warnings.warn(warning, stacklevel=level)


def find_beside(
    path: Path, suffixes: tuple[str, ...], own: tuple[str, ...] = ()
) -> tuple[Path, str] | None:
    """Find the file of the same name, of the subject (``01.asf`` of ``01_02.amc``), or the only.

    Parameters
    ----------
    path
        Of the motion file, or of what it was compressed to.
    suffixes
        Of the files looked for.
    own
        Of the motion file.

    Returns
    -------
    tuple
        The path, and how it was found: see ``Beside.found``.

    """
    try:
        return choose_beside(path, path.parent.iterdir(), suffixes, own)
    except OSError:
        return None


def choose_beside(
    path: PurePath, among: Iterable[P], suffixes: tuple[str, ...], own: tuple[str, ...] = ()
) -> tuple[P, str] | None:
    """Choose as ``find_beside`` does, among the files of the folder."""
    candidates = sorted(p for p in among if p.name.lower().endswith(suffixes))
    stem = _without(_without(path.name.lower(), (".mcz",)), own)
    names = {candidate: _without(candidate.name.lower(), suffixes) for candidate in candidates}
    same = [c for c in candidates if names[c] == stem]
    if same:
        return same[0], SAME_NAME
    subject = [c for c in candidates if re.match(re.escape(names[c]) + r"[_\-. ]", stem)]
    if subject:
        return max(subject, key=lambda c: len(names[c])), SUBJECT
    return (candidates[0], ONLY_ONE) if len(candidates) == 1 else None


def _without(name: str, suffixes: Iterable[str]) -> str:
    ending = max((s for s in suffixes if name.endswith(s)), key=len, default="")
    return name[: len(name) - len(ending)]


def read(source: Source, asf_path: str | Path | None = None, *, strict: bool = True) -> Clip:
    """Read a motion file; a skeleton alone gives a clip of it without frames.

    Raises
    ------
    FormatError
        When the file does not follow its format: with file, line, expected and found.

    """
    of, file = source.format, source.name or None
    if of is not None and of.read_skeleton:
        skeleton = of.read_skeleton(source.data, file)
        columns = skeleton_columns(skeleton)
        empty = np.empty((0, len(columns)))
        return Clip.of(empty, columns, None, skeleton, Path(source.name).stem)
    if of is None or not (of.split or of.read):
        known = formats.listed(
            tuple(f for f in formats.formats() if f.split or f.read or f.read_skeleton)
        )
        raise FormatError("not a motion file", file=file, expected=known)
    parts = source.split(asf_path)
    source.accept(parts.problems, strict=strict)
    source.warn_of_guess()
    return source.described(of, parts.stored, parts.clip)


_seeking = threading.Lock()


def _pread(descriptor: int, length: int, start: int) -> bytes:
    """Read at a place in a file; Windows has only reading where the file stands."""
    if hasattr(os, "pread"):
        return os.pread(descriptor, length, start)
    with _seeking:
        os.lseek(descriptor, start, os.SEEK_SET)
        return os.read(descriptor, length)


def _name(named: Named) -> str:
    if isinstance(named, str | Path):
        return str(named)
    name = getattr(named, "name", "")
    # That of a standard stream, "<stdin>", is none, nor is a descriptor's number.
    return name if isinstance(name, str) and not name.startswith("<") else ""


def _drained(stream: BinaryIO) -> bytes:
    contents = stream.read()
    if not isinstance(contents, bytes):
        raise ParameterError("a stream to read from", expected="one of bytes", found="text")
    return contents
