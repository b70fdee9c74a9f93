"""Files as users want them: whole or not at all, and never overwritten unasked.

A file is written under a temporary name beside its own, synced, and then given its name. Whenever
the process dies, the old file is there or the new one, whole. What a killed process has left is
taken away by the next one that writes the same file: the temporary name follows from the file's,
and a lock on it says whether its writer is still alive.

Windows has no such locks. There every temporary name is another, and what a killed process has left
under one stays.
"""

import errno
import hashlib
import os
import secrets
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from mocapress.errors import MocapressError

try:
    import fcntl
except ImportError:  # Windows
    LOCKS = False
else:
    LOCKS = True


def _flags(*names: str) -> int:
    """Give the flags of ``os.open`` by these names, those that this system has."""
    return sum(getattr(os, f"O_{name}", 0) for name in names)


_WRITTEN = _flags("WRONLY", "CLOEXEC", "BINARY")
_NEW = _flags("RDWR", "CREAT", "EXCL", "NOFOLLOW", "CLOEXEC", "BINARY")
_LEFT = _flags("RDONLY", "NOFOLLOW", "NONBLOCK", "CLOEXEC")


Contents = bytes | Iterable[bytes]
"""Of a file: its bytes, or these part after part, which may be asked for once only."""


class ExistsError(MocapressError):
    """The output file exists and was not to be overwritten."""


def write_whole(
    path: str | Path,
    data: Contents,
    *,
    force: bool = False,
    like: os.stat_result | None = None,
    times: bool = True,
) -> None:
    """Write a file; see ``write_all``."""
    write_all({Path(path): data}, force=force, like=like, times=times)


def write_all(
    files: Mapping[Path, Contents],
    *,
    force: bool = False,
    like: os.stat_result | None = None,
    times: bool = True,
    modified: int | None = None,
) -> None:
    """Write files that belong together: all of them, or none.

    A symbolic link is followed to the file that it names. Into a FIFO or a character device the
    bytes are written as they are; nothing is replaced there.

    Parameters
    ----------
    files
        Paths and their contents. The folders must exist. An error that comes while contents are
        asked for ends the writing: then there is none of the files.
    force
        Whether files that exist are replaced.
    like
        The file that these were made from: they get its permissions, and its owner and group as
        far as the user may give them. Without it, a file that is replaced hands on its
        permissions, and a new one has the usual ones.
    times
        Whether they get the modification time of ``like``, too.
    modified
        Their modification time, in nanoseconds since 1970, where there is no such file.

    Raises
    ------
    ExistsError
        When a file exists and ``force`` is not given.
    OSError
        When one cannot be written. It names the file.

    """
    # The same order in every process, so that no two wait for each other.
    pairs = sorted((Path(path), data) for path, data in files.items())
    check_targets([path for path, _ in pairs], force=force)
    streams = [(path, data) for path, data in pairs if is_stream(path)]
    whole = [(path, data) for path, data in pairs if not is_stream(path)]
    targets = [Path(os.path.realpath(path)) for path, _ in whole]
    with ExitStack() as stack:
        parts = []
        for (path, data), target in zip(whole, targets, strict=True):
            with _naming(path):
                changed = like.st_mtime_ns if like and times else modified
                part = stack.enter_context(_part(target, data, like, changed))
            parts.append((path, target, part))
        _commit(parts, force=force)
    for folder in {target.parent for target in targets}:
        _sync(folder)
    for path, data in streams:
        with _naming(path):
            descriptor = os.open(path, _WRITTEN)
            try:
                _write(descriptor, data)
            finally:
                os.close(descriptor)


def is_stream(path: Path) -> bool:
    """Say whether a path names a FIFO or a character device: bytes go there, no file is made."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return False
    return stat.S_ISFIFO(mode) or stat.S_ISCHR(mode)


def check_targets(paths: Sequence[Path], *, force: bool) -> None:
    """Raise what ``write_all`` would raise at once; take away what killed processes have left.

    Raises
    ------
    ExistsError
        When a file exists and ``force`` is not given.
    OSError
        When there is something else than a file or a stream.

    """
    _clean([Path(os.path.realpath(path)) for path in paths])
    for path in paths:
        try:
            mode = path.stat().st_mode
        except FileNotFoundError:
            continue
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not (stat.S_ISREG(mode) or is_stream(path)):
            raise OSError(errno.EINVAL, "Not a file, FIFO or character device", str(path))
        if stat.S_ISREG(mode) and not force:
            raise _exists(path)


@contextmanager
def _part(
    target: Path, data: Contents, like: os.stat_result | None, changed: int | None
) -> Iterator[Path]:
    """Write the data under a temporary name, which is gone at the end."""
    model = like
    if model is None:
        with suppress(FileNotFoundError):
            model = target.stat()
    # Nobody else sees the contents before the permissions are those of the model.
    descriptor, part = _create(target, 0o666 if model is None else 0o600)
    stream = os.fdopen(descriptor, "wb", buffering=0)
    try:
        _write(descriptor, data)
        if model is not None and os.name == "posix":
            _permit(descriptor, model)
        if changed is not None:
            with suppress(OSError):
                os.utime(part, ns=(like.st_atime_ns if like else changed, changed))
        os.fsync(descriptor)
        if not LOCKS:  # Windows renames no file that is open
            stream.close()
        yield part
    finally:
        if LOCKS:
            if _is_at(descriptor, part):
                part.unlink()
            stream.close()
        else:
            stream.close()
            part.unlink(missing_ok=True)


def _commit(parts: Sequence[tuple[Path, Path, Path]], *, force: bool) -> None:
    """Give the written parts their names; where one cannot have it, none has."""
    with ExitStack() as done, ExitStack() as undo:
        for path, target, part in parts:
            with _naming(path):
                try:
                    # A link fails where a file has appeared meanwhile; a rename replaces it.
                    target.hardlink_to(part)
                    undo.callback(target.unlink)
                    continue
                except FileExistsError:
                    if not force:
                        raise _exists(path) from None
                except OSError:  # a file system without links
                    if target.exists() and not force:
                        raise _exists(path) from None
                old = _old(target)
                if len(parts) > 1:
                    done.callback(old.unlink, missing_ok=True)
                    with suppress(OSError):
                        old.hardlink_to(target)
                part.replace(target)
                if old.exists():
                    undo.callback(old.replace, target)
        undo.pop_all()


def _clean(targets: Sequence[Path]) -> None:
    """Take away what killed processes have left: whole parts, and halves of what belongs together.

    Waits for a process that is writing one of these files just now.
    """
    with suppress(OSError), ExitStack() as locks:
        parts = {target for target in sorted(targets) if _stale(_temporary(target), locks)}
        named = {
            target
            for target in targets
            if (_same(target, _temporary(target)) if target in parts else _old(target).exists())
        }
        halfway = named and parts - named
        for target in targets:
            if halfway and target in named:
                if target in parts:
                    target.unlink()
                else:
                    _old(target).replace(target)
            if target in parts:
                _temporary(target).unlink()
            _old(target).unlink(missing_ok=True)


def _stale(part: Path, locks: ExitStack) -> bool:
    """Say whether a killed process has left this part; then hold its lock."""
    while LOCKS:
        try:
            descriptor = os.open(part, _LEFT)
        except FileNotFoundError:
            return False
        locks.callback(os.close, descriptor)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        if _is_at(descriptor, part):
            return True
    return False


def _same(path: Path, other: Path) -> bool:
    return path.exists() and path.samefile(other)


def _create(target: Path, mode: int) -> tuple[int, Path]:
    """Create a part and lock it."""
    part = _temporary(target)
    for _ in range(100 if LOCKS else 0):
        try:
            descriptor = os.open(part, _NEW, mode)
        except FileExistsError:
            _clean([target])
            continue
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(descriptor)
            break
        if _is_at(descriptor, part):
            return descriptor, part
        os.close(descriptor)
    # There are no locks here, or what is left is another user's: a name that nobody else takes.
    part = part.with_suffix(f".{secrets.token_hex(4)}.part")
    return os.open(part, _NEW, mode), part


def _is_at(descriptor: int, path: Path) -> bool:
    with suppress(FileNotFoundError):
        return os.path.samestat(os.fstat(descriptor), path.lstat())
    return False


def _temporary(target: Path) -> Path:
    """Give the temporary name; short, as a long one would not fit where the target's just does."""
    digest = hashlib.sha256(os.fsencode(target.name)).hexdigest()
    return target.with_name(f".mocapress-{digest[:16]}.part")


def _old(target: Path) -> Path:
    return _temporary(target).with_suffix(".old")


def _write(descriptor: int, data: Contents) -> None:
    for part in (data,) if isinstance(data, bytes) else data:
        rest = memoryview(part)
        while rest:
            rest = rest[os.write(descriptor, rest) :]


def _permit(descriptor: int, model: os.stat_result) -> None:
    """Hand on owner, group and permissions, as far as this user may; never more to anybody."""
    mode = model.st_mode & 0o777
    own = os.fstat(descriptor)
    if own.st_uid != model.st_uid:
        with suppress(OSError):
            os.fchown(descriptor, model.st_uid, -1)
    if own.st_gid != model.st_gid:
        try:
            os.fchown(descriptor, -1, model.st_gid)
        except OSError:
            # Another group: it may do what everybody may.
            mode = mode & 0o707 | (mode & 0o007) << 3
    with suppress(OSError):  # a file system without permissions
        os.fchmod(descriptor, mode)


def _exists(path: Path) -> ExistsError:
    return ExistsError("file exists; force=True overwrites it", file=str(path))


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Name the file that was asked for in errors of the system, not the temporary one."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error


def _sync(folder: Path) -> None:
    with suppress(OSError):
        descriptor = os.open(folder, _flags("RDONLY", "CLOEXEC"))
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
