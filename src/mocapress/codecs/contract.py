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
    """Id of the codec."""
    payload: bytes

    @property
    def digest(self) -> bytes:
        """What files name the model by: SHA-256 of id and payload, their lengths before them."""
        named = Writer()
        named.bytes(self.codec.encode())
        named.bytes(self.payload)
        return hashlib.sha256(named.data).digest()


class Codec(ABC):
    """A codec: a frozen dataclass whose fields are its parameters, with their usual values.

    ``encode`` and ``decode`` are pure functions of their arguments and the parameters: the same
    bytes on every run and every machine.
    """

    __slots__ = ()

    id: ClassVar[str]
    lossless: ClassVar[bool]

    @abstractmethod
    def encode(self, clip: Clip, *, model: Model | None = None) -> Encoded:
        """Code a clip; ``(F, C)`` values, any float64 including NaN, infinities and -0.

        A model that was learned from other columns than the clip's costs ratio, not correctness.

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
        """Give the error up to which each column may come back; infinite where none was asked."""
        return [0.0 if self.lossless else inf] * len(columns)


@runtime_checkable
class Trainable(Protocol):
    """A codec that learns from other clips. Others ignore the models that they are given."""

    def train(self, clips: Iterable[Clip]) -> Model:
        """Learn a model from clips, which are gone through once.

        The same model on every run and every machine.
        """
        ...


Parameters = dict[str, Any]
