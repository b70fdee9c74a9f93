"""A folder, on this machine or in object storage: what ``fsspec`` opens by a URL."""

import errno
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from mocapress.errors import UnsupportedError
from mocapress.storage import ExistsError, write_whole

_FOREIGN = {"botocore", "aiobotocore", "aiohttp", "s3fs", "gcsfs", "google", "adlfs", "azure"}
"""Packages whose errors are those of a storage that cannot be reached or refuses."""
_GAP = 0.07
"""Of the bytes that are wanted, how many others may be read to ask less often."""


class Listed(NamedTuple):
    """A file of a folder."""

    name: str
    """From the folder, with ``/`` between its parts."""
    size: int
    modified: int
    """In nanoseconds since 1970."""


@dataclass(frozen=True)
class Store:
    """A folder by its path or URL; it can be sent to another process."""

    url: str

    @property
    def _opened(self) -> tuple[Any, str]:
        """The file system of fsspec, and the folder there; a forked process has its own."""
        return _opened(self.url, os.getpid())

    @property
    def local(self) -> Path | None:
        """The folder, where it is one of this machine's file system."""
        fs, root = self._opened
        return Path(root) if "file" in fs.protocol else None

    def file(self, name: str) -> str:
        """Name a file for messages."""
        return f"{self.url.rstrip('/')}/{name}" if name else self.url

    def _path(self, name: str) -> str:
        root = self._opened[1]
        return f"{root}/{name}" if name else str(root)

    def read(self, name: str) -> bytes:
        """Give the contents of a file."""
        with self._naming(name):
            return bytes(self._opened[0].cat_file(self._path(name)))

    def parts(self, name: str, places: Sequence[tuple[int, int]], most: int) -> list[bytes]:
        """Give parts of a file, each [begin, end), by so many requests at most."""
        spans = _spans(sorted(places), most)
        with self._naming(name):
            found = self._opened[0].cat_ranges(
                [self._path(name)] * len(spans),
                [begin for begin, _ in spans],
                [end for _, end in spans],
                on_error="raise",
            )
        whole = dict(zip(spans, found, strict=True))
        parts = []
        for begin, end in places:
            span = next(span for span in spans if span[0] <= begin and end <= span[1])
            parts.append(bytes(whole[span][begin - span[0] : end - span[0]]))
        return parts

    @contextmanager
    def open(self, name: str) -> Iterator[BinaryIO]:
        """Open a file to read it from its beginning on."""
        with self._naming(name), self._opened[0].open(self._path(name), "rb") as stream:
            yield stream

    def fetch(self, name: str, path: Path) -> None:
        """Copy a file here."""
        with self._naming(name):
            self._opened[0].get_file(self._path(name), str(path))

    def put(self, name: str, path: Path) -> None:
        """Copy a file there; it is seen whole or not at all."""
        size = path.stat().st_size
        with self._naming(name):
            if self.local is not None:
                target = self.local / name
                target.parent.mkdir(parents=True, exist_ok=True)
                with path.open("rb") as stream:
                    write_whole(target, iter(lambda: stream.read(2**20), b""), force=True)
            else:
                self._opened[0].put_file(str(path), self._path(name))
            there = self._opened[0].info(self._path(name))["size"]
            if there != size:
                raise OSError(errno.EIO, f"{there} of {size} bytes arrived", self.file(name))

    def put_folder(self, folder: Path) -> None:
        """Copy the files of a folder of this machine there."""
        with self._naming(""):
            if self.local is not None:
                shutil.copytree(folder, self.local, dirs_exist_ok=True)
            else:
                self._opened[0].put(f"{folder}/", f"{self._path('')}/", recursive=True)

    def remove_all(self) -> None:
        """Delete the folder with all files, if it is there."""
        with self._naming(""), suppress(FileNotFoundError):
            self._opened[0].rm(self._path(""), recursive=True)

    def create(self, name: str, data: bytes) -> None:
        """Write a file that is not there yet, whole or not at all.

        Raises
        ------
        ExistsError
            When there is one, also where another process wrote it just now.

        """
        with self._naming(name):
            if self.local is not None:
                target = self.local / name
                target.parent.mkdir(parents=True, exist_ok=True)
                write_whole(target, data)
                return
            try:
                self._opened[0].pipe_file(self._path(name), data, mode="create")
            except FileExistsError as error:
                raise ExistsError("the file exists", file=self.file(name)) from error

    def remove(self, name: str) -> None:
        """Delete a file, if it is there."""
        with self._naming(name):
            try:
                self._opened[0].rm_file(self._path(name))
            except FileNotFoundError:
                return

    def files(self, folder: str = "") -> list[Listed]:
        """Give all files below a folder, in the order of their names; none where there is none."""
        fs = self._opened[0]
        root = self._path(folder)
        with self._naming(folder):
            found = fs.find(root, detail=True)
        return sorted(
            Listed(
                path[len(root) :].lstrip("/"), int(facts["size"] or 0), self._changed(path, facts)
            )
            for path, facts in found.items()
            if path != root and facts["type"] == "file"
        )

    def _changed(self, path: str, facts: dict[str, Any]) -> int:
        """Give when a file was last changed, as its storage says it."""
        if self.local is not None:
            return Path(path).stat().st_mtime_ns
        for key in ("LastModified", "updated", "last_modified", "mtime", "created"):
            value = facts.get(key)
            if isinstance(value, datetime):
                return int(value.timestamp()) * 10**9
            if isinstance(value, int | float):
                return int(value) * 10**9
        return 0

    @contextmanager
    def _naming(self, name: str) -> Iterator[None]:
        """Turn what storages raise into an error of the system that names the file."""
        file = self.file(name)
        try:
            yield
        except OSError as error:
            if error.filename == file:
                raise
            number = error.errno or errno.EIO
            what = error.strerror or str(error) or os.strerror(number)
            raise type(error)(number, what, file) from error
        except Exception as error:
            if type(error).__module__.split(".")[0] not in _FOREIGN:
                raise
            raise OSError(errno.EIO, str(error) or type(error).__name__, file) from error


def _spans(places: Sequence[tuple[int, int]], most: int) -> list[tuple[int, int]]:
    """Join parts that are near each other: as many as cost little, or as there must be."""
    spans: list[tuple[int, int]] = []
    for begin, end in places:
        if spans and begin <= spans[-1][1]:
            spans[-1] = spans[-1][0], max(end, spans[-1][1])
        else:
            spans.append((begin, end))
    left = _GAP * sum(end - begin for begin, end in spans)
    while len(spans) > 1:
        gaps = [after[0] - before[1] for before, after in pairwise(spans)]
        least = min(gaps)
        if least > left and len(spans) <= most:
            break
        at = gaps.index(least)
        spans[at : at + 2] = [(spans[at][0], spans[at + 1][1])]
        left -= least
    return spans


@lru_cache(maxsize=16)
def _opened(url: str, process: int) -> tuple[Any, str]:  # noqa: ARG001
    try:
        import fsspec
    except ImportError:
        raise UnsupportedError(
            "sharded libraries need fsspec", expected="pip install 'mocapress[cluster]'"
        ) from None
    try:
        fs, root = fsspec.core.url_to_fs(url, use_listings_cache=False, skip_instance_cache=True)
    except ImportError as error:
        raise UnsupportedError(
            f"what opens {url} is not installed", found=str(error).split("\n")[0]
        ) from None
    except ValueError as error:
        raise UnsupportedError(str(error), file=url) from None
    return fs, root.rstrip("/")
