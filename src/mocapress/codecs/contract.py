"""What a codec is: the contract that every codec keeps and every caller relies on."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from mocapress.model import Clip, Column


@dataclass(frozen=True, slots=True)
class Chunk:
    """A run of frames, coded."""

    first: int
    """Index of the first frame."""
    frames: int
    payload: bytes
    restart: bool = True
    """Whether decoding may begin here; otherwise it begins at the last chunk before with it."""


@dataclass(frozen=True, slots=True)
class Encoded:
    """A clip, coded: what ``decode`` needs beside the columns and a model."""

    header: bytes
    """The codec's own: whatever concerns all chunks."""
    chunks: tuple[Chunk, ...]
    index_bytes: int = 0
    """How many of the payload bytes are side information (APP: the alpha indices, Eq. 10)."""


@dataclass(frozen=True, slots=True)
class Model:
    """What a codec learned from other clips, as bytes; named by its hash in files that need it."""

    codec: str
    payload: bytes


class Codec(Protocol):
    """A codec: a frozen dataclass whose fields are its parameters, with their usual values.

    ``encode`` and ``decode`` are pure functions of their arguments and the parameters: the same
    bytes on every run and every machine.
    """

    id: ClassVar[str]
    lossless: ClassVar[bool]

    def encode(self, clip: Clip, *, model: Model | None = None) -> Encoded:
        """Code a clip; ``(F, C)`` values, any float64 including NaN, infinities and -0."""
        ...

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,
    ) -> NDArray[np.float64]:
        """Decode consecutive chunks, the first a restart: (sum of their frames, C) float64.

        Raises
        ------
        CorruptError
            When header or payload do not follow the codec's format. Never anything else, and
            never with more memory than a small multiple of (frames x columns x 8) bytes.

        """
        ...


class Trainable(Protocol):
    """A codec that learns from other clips."""

    def train(self, clips: Iterable[Clip]) -> Model:
        """Learn a model from clips."""
        ...


Parameters = dict[str, Any]
