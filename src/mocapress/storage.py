"""Files as users want them: whole or not at all, and never overwritten unasked."""

import os
import tempfile
from pathlib import Path

from mocapress.errors import MocapressError


class ExistsError(MocapressError):
    """The output file exists and was not to be overwritten."""


def write_whole(path: str | Path, data: bytes, *, force: bool = False) -> None:
    """Write a file by way of a temporary one beside it, synced and renamed.

    Whenever the process dies, the old file is there or the new one, whole.

    Raises
    ------
    ExistsError
        When the file exists and ``force`` is not given.
    OSError
        When it cannot be written.

    """
    path = Path(path)
    if path.exists() and not force:
        raise ExistsError("file exists; --force overwrites it", file=str(path))
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        mode = path.stat().st_mode & 0o777 if path.exists() else 0o666 & ~_umask()
        Path(name).chmod(mode)
        if force:
            Path(name).replace(path)
        else:
            # A link fails where a file has appeared meanwhile; a rename would replace it.
            _link(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
    _sync_folder(path.parent)


def _link(name: str, path: Path) -> None:
    try:
        os.link(name, path)
    except FileExistsError:
        raise ExistsError("file exists; --force overwrites it", file=str(path)) from None
    except OSError:  # a file system without links
        Path(name).replace(path)
    Path(name).unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _sync_folder(folder: Path) -> None:
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(descriptor)
    except OSError:
        pass
    finally:
        os.close(descriptor)
