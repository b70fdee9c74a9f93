"""Writing a ``.mcz`` while a capture runs."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mocapress.api.clips import checked_codec
from mocapress.api.encoding import coded_chunks, stored_skeleton, stream_head
from mocapress.api.opening import decoded
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.container import Head, MczWriter, is_storable_time
from mocapress.container.limits import most_values
from mocapress.errors import ParameterError, UnsupportedError, VerificationError
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.clip import MOTION
from mocapress.motion.columns import named_columns
from mocapress.storage import ExistsError

_USUAL_CHUNK = 512


class Recording:
    """A ``.mcz`` that grows; see ``writer``."""

    def __init__(
        self,
        path: str | Path,
        clip: Clip,
        codec: Codec,
        notes: Mapping[str, str],
        model: Model | None = None,
    ) -> None:
        self._clip, self._codec, self._model = clip, codec, model
        self._name = next(iter(clip.streams))
        self._most = getattr(codec, "chunk", _USUAL_CHUNK)
        self._waiting: list[NDArray[np.float64]] = []
        self._held = 0
        self.frames = 0
        """Frames that are in the file."""
        self._head = replace(
            stream_head(self._name, clip.main, codec, frames=None),
            model=model.digest if model else b"",
        )
        # What cannot be stored is refused before there is a file.
        self._begin(MczWriter(bytearray().extend), notes)
        self._file: int | None = self._opened(path)
        self._mcz = MczWriter(self._put)
        self._begin(self._mcz, notes)
        self._sync()

    def _opened(self, path: str | Path) -> int:
        try:
            return os.open(
                path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666
            )
        except FileExistsError:
            raise ExistsError("file exists; a recording needs a new one", file=str(path)) from None

    def _begin(self, mcz: MczWriter, notes: Mapping[str, str]) -> None:
        mcz.head(Head((self._head,), stored_skeleton(self._clip)))
        if notes:
            mcz.notes(notes)

    def append(self, rows: ArrayLike) -> None:
        """Add frames; every chunk that they complete is on the disk when this returns.

        Parameters
        ----------
        rows
            (n, C), or (C,) for one frame.

        Raises
        ------
        ParameterError
            When they have another number of channels, or the recording is closed.
        OSError
            When they cannot be written.

        """
        values = np.atleast_2d(np.array(rows, np.float64))
        if values.ndim != 2 or values.shape[1] != self._clip.channels:
            raise ParameterError(
                "rows of another shape",
                expected=f"(n, {self._clip.channels})",
                found=str(values.shape),
            )
        if self._file is None:
            raise ParameterError("the recording is closed")
        self._waiting.append(values)
        self._held += len(values)
        if self._held >= self._most:
            self._write(self._held - self._held % self._most)

    def flush(self) -> None:
        """Put on the disk what was appended, though it does not fill a chunk."""
        if self._held:
            self._write(self._held)

    def close(self) -> None:
        """Write what is left, and the file's end. Closing twice does nothing."""
        if self._file is None:
            return
        try:
            self.flush()
            self._mcz.end()
            self._sync()
        finally:
            self._shut()
            self._file = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _write(self, count: int) -> None:
        """Write so many of the frames that wait."""
        rows = np.concatenate(self._waiting)
        for begin in range(0, count, self._most):
            self._write_chunk(rows[begin : min(begin + self._most, count)])
            self._waiting = [rows[begin + self._most :]]
            self._held = len(self._waiting[0])

    def _write_chunk(self, rows: NDArray[np.float64]) -> None:
        clip = self._clip.with_frames(rows, self._clip.frame_time)
        encoded = self._codec.encode(clip.main, skeleton=clip.skeleton, model=self._model)
        if self._codec.lossless:
            back = decoded(
                self._codec, encoded.header, encoded.chunks, self._head, self._model, len(rows)
            )
            if back.tobytes() != rows.tobytes():
                raise VerificationError(f"codec {self._codec.id} does not give back the frames")
        if (self.frames + len(rows)) * max(clip.channels, 1) > most_values(self._mcz.length):
            raise UnsupportedError("more frames than a file of this size may hold")
        for chunk in coded_chunks(
            clip,
            self._head,
            0,
            self._codec,
            encoded,
            self._model,
            first=self.frames,
            own_header=True,
        ):
            self._mcz.chunk(chunk)
        self._sync()
        self.frames += len(rows)

    def _shut(self) -> None:
        assert self._file is not None
        os.close(self._file)

    def _put(self, data: bytes) -> None:
        assert self._file is not None
        left = memoryview(data)
        try:
            while left:
                left = left[os.write(self._file, left) :]
        except OSError:
            # What is half written would hide what follows; so the rows can be appended again.
            os.ftruncate(self._file, self._mcz.length)
            os.lseek(self._file, self._mcz.length, os.SEEK_SET)
            raise

    def _sync(self) -> None:
        assert self._file is not None
        os.fsync(self._file)


class Encoder(Recording):
    """A ``.mcz`` as a stream of bytes; see ``encoder``."""

    def __init__(
        self, clip: Clip, codec: Codec, notes: Mapping[str, str], model: Model | None
    ) -> None:
        self._made = bytearray()
        super().__init__("", clip, codec, notes, model)

    def push(self, rows: ArrayLike) -> bytes:
        """Take a frame, (C,), or frames, (n, C): the bytes that are complete with them.

        At most ``chunk`` - 1 frames of the codec wait. The first bytes hold the file's head.
        """
        self.append(rows)
        return self._taken()

    def finish(self) -> bytes:
        """Give the bytes of the frames that wait, and the file's end."""
        self.close()
        return self._taken()

    def _taken(self) -> bytes:
        made = bytes(self._made)
        self._made.clear()
        return made

    def _opened(self, path: str | Path) -> int:  # noqa: ARG002
        return -1

    def _put(self, data: bytes) -> None:
        self._made += data

    def _sync(self) -> None:
        pass

    def _shut(self) -> None:
        pass


def encoder(
    columns: Sequence[Column | str],
    rate: float | Fraction | Decimal | None,
    *,
    codec: str | Codec = DEFAULT_CODEC,
    model: Model | None = None,
    name: str = MOTION,
    notes: Mapping[str, str] | None = None,
) -> Encoder:
    """Open a ``.mcz`` that is made frame by frame, as bytes.

    >>> coder = mp.encoder(["C7.x", "C7.y", "C7.z"], 120, codec="patterns:chunk=60", model=walks)
    >>> for frame in capture:
    ...     connection.send(coder.push(frame))
    >>> connection.send(coder.finish())

    What was pushed is in the bytes after at most ``chunk`` frames of the codec, which is how long
    a receiver waits. With a model, files of ``patterns`` hold no database of their own.

    Parameters
    ----------
    columns, rate, codec, name, notes
        See ``writer``.
    model
        What the codec learned from other clips.

    Raises
    ------
    ParameterError
        When there is no such codec, the model is not for it, or the rate is no number above 0.

    """
    made = checked_codec(codec, model)
    named = named_columns(columns)
    stream = Stream(np.empty((0, len(named))), named, _frame_time(rate))
    return Encoder(Clip({name: stream}), made, notes or {}, model)


def writer(
    path: str | Path,
    columns: Sequence[Column | str],
    rate: float | Fraction | Decimal | None,
    skeleton: Skeleton | None = None,
    *,
    codec: str | Codec = DEFAULT_CODEC,
    model: Model | None = None,
    name: str = MOTION,
    notes: Mapping[str, str] | None = None,
) -> Recording:
    """Open a ``.mcz`` that is written while a capture runs.

    >>> with mp.writer("take.mcz", ["root.tx", "root.ty"], rate=120) as recording:
    ...     recording.append([[0.0, 90.5], [0.1, 90.4]])

    A chunk is on the disk as soon as its frames are complete (``chunk`` of the codec). When the
    process is killed, the file opens with all chunks up to the last whole one.

    Parameters
    ----------
    path
        Must not exist.
    columns
        The channels; a text is a column's name, ``joint.kind``.
    rate
        Frames per second; None where it is not known. A float counts as the decimal that it prints
        as.
    skeleton
        Whose joints the columns move.
    codec
        A codec or its text.
    model
        What the codec learned from other clips.
    name
        Of the stream.
    notes
        What to say about the file in it.

    Raises
    ------
    ExistsError
        When the file exists.
    ParameterError
        When there is no such codec, or the rate is no number above 0.
    UnsupportedError
        When a file cannot hold a name or note.
    OSError
        When it cannot be written.

    """
    made = checked_codec(codec, model)
    named = named_columns(columns)
    stream = Stream(np.empty((0, len(named))), named, _frame_time(rate))
    return Recording(path, Clip({name: stream}, skeleton), made, notes or {}, model)


def _frame_time(rate: float | Fraction | Decimal | None) -> Fraction | None:
    if rate is None:
        return None
    try:
        time = 1 / max(Fraction(str(rate) if isinstance(rate, float) else rate), Fraction(0))
    except (ValueError, OverflowError, ZeroDivisionError):
        found = str(rate)
        raise ParameterError("rate", expected="a number above 0", found=found) from None
    if not is_storable_time(time):
        raise ParameterError("rate", expected="a number of up to 448 bits", found=str(rate))
    return time
