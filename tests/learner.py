"""A small codec that learns and has levels: what is built around such codecs is tested with it.

A model is a mean per column; a file holds the values' bits, those of the means taken off, deflated.
"""

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs import Capabilities, Chunk, Codec, Encoded, Model, Others
from mocapress.codecs.contract import NO_OTHERS
from mocapress.errors import CorruptError
from mocapress.motion import Column, Skeleton, Stream

_FRAMES = 100


@dataclass(frozen=True, slots=True)
class Learner(Codec):
    id: ClassVar[str] = "learner"
    can: ClassVar[Capabilities] = Capabilities(lossless=True, levels=True, trains=True)

    level: int = 6

    def train(self, streams: Iterable[Stream]) -> Model:
        moving = [stream.values for stream in streams if stream.frames]
        widest = max((values.shape[1] for values in moving), default=0)
        fitting = [values for values in moving if values.shape[1] == widest]
        mean = np.concatenate(fitting).mean(axis=0) if fitting else np.empty(0)
        return Model(self.id, mean.astype("<f8").tobytes())

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        mean = _mean(model, stream.channels)
        bits = np.ascontiguousarray(stream.values).view(np.uint64) ^ mean
        return Encoded(
            b"\x01" if model else b"\x00",
            tuple(
                Chunk(first, len(rows), zlib.compress(rows.tobytes(), self.level))
                for first in range(0, stream.frames, _FRAMES)
                for rows in [bits[first : first + _FRAMES]]
            ),
        )

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,
        others: Others = NO_OTHERS,
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        if header not in (b"\x00", b"\x01") or (header == b"\x01") != (model is not None):
            raise CorruptError("header: of a clip coded with another model")
        parts = [_inflate(chunk, len(columns)) for chunk in chunks]
        bits = np.concatenate([np.empty((0, len(columns)), np.uint64), *parts])
        return (bits ^ _mean(model, len(columns))).view(np.float64)[:stop]


def _mean(model: Model | None, channels: int) -> NDArray[np.uint64]:
    payload = model.payload if model else b""
    if len(payload) % 8:
        raise CorruptError("model: cut off")
    mean = np.frombuffer(payload, np.uint64)
    return mean if len(mean) == channels else np.zeros(channels, np.uint64)


def _inflate(chunk: Chunk, channels: int) -> NDArray[np.uint64]:
    size = 8 * chunk.frames * channels
    inflate = zlib.decompressobj()
    try:
        data = inflate.decompress(chunk.payload, min(size, 2**20) + 1)
    except zlib.error as error:
        raise CorruptError(f"chunk: {error}") from error
    if len(data) != size or not inflate.eof or inflate.unused_data:
        raise CorruptError("chunk: of another size")
    return np.frombuffer(data, np.uint64).reshape(chunk.frames, channels)
