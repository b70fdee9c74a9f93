"""A library for the page: its catalogue, and the clips that are asked for."""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from http import HTTPStatus
from pathlib import Path, PurePosixPath
from types import TracebackType

from mocapress.api.loading import load_opened
from mocapress.errors import MocapressError, UnsupportedError
from mocapress.library import open_library
from mocapress.library.clips import StoredClip, by_id
from mocapress.library.opened import OpenedClip
from mocapress.library.reading import Reading
from mocapress.viewer import embed
from mocapress.viewer.server import Answer

_CLIP = re.compile(r"/clips/([0-9]{1,18})")
_SIMILAR = re.compile(r"/similar/([0-9]{1,18})(?:/([0-9]{1,12})-([0-9]{1,12}))?")


class ServedLibrary(AbstractContextManager["ServedLibrary"]):
    """What a server gives of a library: ``/catalogue`` as JSON, and ``/clips/ID`` as ``.mcz``.

    ``/similar/ID`` gives the clips that are like one, as JSON, and ``/similar/ID/A-B`` the
    stretches that are like its frames from A to before B.

    One thread reads, whoever asks: each has a connection of its own to the database, and a server
    begins a thread for each question.

    Parameters
    ----------
    path
        Of the library, or URL of a sharded one. It is only read.
    strict
        Whether clips that have lost frames are refused.

    Raises
    ------
    CorruptError
        When the file is no library.
    OSError
        When it cannot be opened.

    """

    def __init__(self, path: str | Path, *, strict: bool = True) -> None:
        self._library = open_library(path)
        # Names of files need not be UTF-8, a page is.
        self.name = _readable(PurePosixPath(path).name or str(path))
        self._strict = strict
        self._reader = ThreadPoolExecutor(1)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._reader.shutdown()
        self._library.close()

    def answer(self, path: str) -> Answer | None:
        """Give what there is by a path; what is wrong with it is an answer, too."""
        found, like = _CLIP.fullmatch(path), _SIMILAR.fullmatch(path)
        if not found and not like and path != "/catalogue":
            return None
        try:
            if found:
                return Answer(self._reader.submit(self._clip, int(found[1])).result())
            if like:
                clip, first, last = (
                    None if number is None else int(number) for number in like.groups()
                )
                frames = None if first is None else slice(first, last)
                answer = self._reader.submit(self._similar, clip or 0, frames)
            else:
                answer = self._reader.submit(self._catalogue)
            return Answer(answer.result(), "application/json")
        except (MocapressError, OSError, MemoryError) as error:
            text = str(error) or type(error).__name__
            return Answer(text.encode(), "text/plain; charset=utf-8", HTTPStatus.CONFLICT)

    def _catalogue(self) -> bytes:
        clips = [_facts(clip) for clip in self._library.clips() if clip.frames]
        return json.dumps({"clips": clips}, separators=(",", ":")).encode()

    def _similar(self, number: int, frames: slice | None) -> bytes:
        with self._library.db.reading() as connection:
            name = by_id(self._library, connection, number).name
        hits = [
            {
                "id": self._library[hit.name].id,
                "start": hit.start,
                "seconds": hit.seconds,
                "score": hit.score,
            }
            for hit in self._library.search(name, frames=frames, within=frames is not None)
        ]
        return json.dumps({"hits": hits}, separators=(",", ":")).encode()

    def _clip(self, number: int) -> bytes:
        return playable(self._library, number, strict=self._strict)


def playable(library: Reading, number: int, *, strict: bool = True) -> bytes:
    """Give what is played of a clip as a ``.mcz`` that the page can decode.

    Chunks stay as they are where the page has their decoder and they hold all frames.

    Raises
    ------
    MocapressError
        When there is no such clip, or it is damaged or cannot be played.

    """
    with library.db.reading():
        opened = library.opened(number)
        clip = load_opened(opened, _first_of(opened), strict=strict)
        whole = opened.whole_source() if opened.runs else opened
        coded = embed.as_coded(whole.mcz, clip) if whole else None
        if coded:
            return coded
        clip = load_opened(opened, strict=strict)
    if not clip.frames:
        raise UnsupportedError("no frames to be played", file=opened.facts.name)
    return embed.coded_anew(clip, level=embed.FAST)


def _first_of(opened: OpenedClip) -> slice:
    """Give as few frames as there are, for what else a clip says."""
    return slice(0, min(1, opened.frames()))


def _facts(clip: StoredClip) -> dict[str, object]:
    return {
        "id": clip.id,
        "name": _readable(clip.name),
        "format": clip.format,
        "frames": clip.frames,
        "seconds": clip.duration,
        "skeleton": clip.skeleton,
        "labels": clip.labels,
    }


def _readable(name: str) -> str:
    return name.encode(errors="surrogateescape").decode(errors="replace")
