"""What a codec is: the contract that every codec keeps and every caller relies on."""

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from mocapress.motion import Clip, Column
from mocapress.records import Writer


@dataclass(frozen=True, slots=True)
class Chunk:
    """Consecutive frames, coded together."""

    first: int
    """Index of the first frame."""
    frames: int
    payload: bytes
    restart: bool = True
    """Whether decoding may begin here; otherwise it begins at the last chunk before with it."""


@dataclass(frozen=True, slots=True)
class Encoded:
    """A coded clip: what ``decode`` needs besides the columns and a model."""

    header: bytes
    """The codec's own: whatever concerns all chunks."""
    chunks: tuple[Chunk, ...]
    index_bytes: int = 0
    """How many of the payload bytes are side information (APP: the alpha indices, Eq. 10)."""


@dataclass(frozen=True, slots=True)
class Model:
    """What a codec learned from other clips, as bytes; named by its hash in files that need it."""

    codec: str
    """Id of the codec."""
    payload: bytes

    @property
    def digest(self) -> bytes:
        """The name that files use for the model: SHA-256 of id and payload with their lengths."""
        named = Writer()
        named.bytes(self.codec.encode())
        named.bytes(self.payload)
        return hashlib.sha256(named.data).digest()


class Codec(ABC):
    """A codec: a frozen dataclass whose fields are its parameters, with their defaults.

    ``encode`` and ``decode`` are pure functions of their arguments and the parameters: the same
    bytes on every run and every machine.
    """

    __slots__ = ()

    id: ClassVar[str]
    lossless: ClassVar[bool]

    @abstractmethod
    def encode(self, clip: Clip, *, model: Model | None = None) -> Encoded:
        """Code a clip; ``(F, C)`` values, any float64 including NaN, infinities and -0.

        A model that was learned from other columns makes the result larger, never wrong.

        Raises
        ------
        CorruptError
            When the model's payload does not follow the codec's format.

        """

    @abstractmethod
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
            When header, payload or model do not follow the codec's format, or the model with
            which the clip was coded is missing. Never anything else, and never with more memory
            than a small multiple of (frames x columns x 8) bytes.

        """

    def largest_errors(self, columns: Sequence[Column]) -> list[float]:
        """Give the largest error allowed in each column; infinite where no bound was asked for."""
        return [0.0 if self.lossless else inf] * len(columns)


@runtime_checkable
class Trainable(Protocol):
    """A codec that learns from other clips. Others ignore the models that they are given."""

    def train(self, clips: Iterable[Clip]) -> Model:
        """Learn a model from clips, which are iterated over once.

        Gives the same model on every run and every machine.
        """
        ...


Parameters = dict[str, Any]
