"""What a codec is: the contract that every codec keeps and every caller relies on."""

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import inf
from types import MappingProxyType
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.records import Writer

CHANNELS = "channels"
"""The kind of stream that all codecs of this version take: frames of float64 channels."""

Others = Mapping[bytes, NDArray[np.float64]]
"""Decoded frames of other chunks, (F, C) float64, by their ``digest_of``."""
NO_OTHERS: Others = MappingProxyType({})


class Bound(StrEnum):
    """What a codec can be asked to keep of its errors."""

    NONE = "none"
    MEAN = "mean"
    """The mean squared error, by the parameter ``target_psnr``."""
    LARGEST = "largest"
    """The largest error of any value, by the parameter ``max_error``."""


class Scope(StrEnum):
    """What a codec sees when it codes a clip."""

    CLIP = "clip"
    LIBRARY = "library"
    """Other clips, too: chunks may need frames of theirs (``encode_together``)."""


@dataclass(frozen=True, slots=True)
class Capabilities:
    """What a codec can do, declared in one place."""

    lossless: bool
    levels: bool = False
    """Whether it has the parameter ``level``, 1 (the fastest) to 9 (the strongest)."""
    trains: bool = False
    """Whether it learns models; others ignore the models that they are given."""
    bounds: frozenset[Bound] = frozenset()
    """Empty for a lossless codec."""
    scope: Scope = Scope.CLIP
    streams: frozenset[str] = frozenset({CHANNELS})
    """Kinds of streams that it takes."""
    document: bool = False
    """Whether it can write a clip as DiffMA JSON."""
    names: bool = False
    """Whether it looks at the names of markers."""
    stands_back: bool = False
    """Whether a lossless codec stands in for it where that takes no more bytes."""
    measured: bool = False
    """Whether there is more to say of what it coded than sizes."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """A run of frames, coded."""

    first: int
    """Index of the first frame."""
    frames: int
    payload: bytes
    restart: bool = True
    """Whether decoding may begin here; otherwise it begins at the last chunk before with it."""
    needs: tuple[bytes, ...] = ()
    """Which frames of other chunks decoding needs, by their ``digest_of``; scope library only."""


@dataclass(frozen=True, slots=True)
class Encoded:
    """A stream, coded: what ``decode`` needs beside the columns, a model and other chunks."""

    header: bytes
    """The codec's own: whatever concerns all chunks."""
    chunks: tuple[Chunk, ...]
    index_bytes: int = 0
    """How many of the payload bytes are side information (APP: the alpha indices, Eq. 10)."""
    uses_model: bool = True
    """Whether decoding needs the model that was given, if one was."""


class Origin(NamedTuple):
    """Where frames that a chunk needs are."""

    stream: int
    """Index among the streams that were coded together."""
    first: int
    frames: int


@dataclass(frozen=True, slots=True)
class Together:
    """Streams, coded together."""

    encoded: tuple[Encoded, ...]
    origins: Mapping[bytes, Origin]
    """Where what chunks need is to be found, by its ``digest_of``."""


@dataclass(frozen=True, slots=True)
class Model:
    """What a codec learned from other clips, as bytes; named by its hash in files that need it.

    Attributes
    ----------
    codec
        Id of the codec.
    payload
        What the codec learned, in its own form.

    """

    codec: str
    payload: bytes = field(repr=False)

    @property
    def digest(self) -> bytes:
        """What files name the model by: SHA-256 of id and payload, their lengths before them."""
        named = Writer()
        named.bytes(self.codec.encode())
        named.bytes(self.payload)
        return hashlib.sha256(named.data).digest()


def digest_of(values: NDArray[np.float64]) -> bytes:
    """Give what names a decoded chunk, (F, C) float64: SHA-256 of F, C and the values' bytes."""
    named = Writer()
    for size in values.shape:
        named.integer(size)
    named.data += np.ascontiguousarray(values, dtype="<f8").tobytes()
    return hashlib.sha256(named.data).digest()


class Codec(ABC):
    """A codec: a frozen dataclass whose fields are its parameters, with their usual values.

    ``encode`` and ``decode`` are pure functions of their arguments and the parameters: the same
    bytes on every run and every machine. What is not abstract here belongs to a capability; a
    codec that declares it overrides it.
    """

    __slots__ = ()

    id: ClassVar[str]
    can: ClassVar[Capabilities]
    rest: ClassVar[str] = ""
    """The parameter, a text, that takes what is given as ``name=value`` with names that no other
    parameter has; none for a codec that refuses them."""

    def left_out(self) -> set[str]:
        """Name the parameters that a file need not name: its codec header does, or all is usual."""
        return set()

    def as_told(self, header: bytes) -> "Codec":
        """Give the codec as it was asked for, from the codec header."""
        return self

    def for_model(self, model: "Model | None") -> "Codec":
        """Give the codec as it suits a model, or as it best learns one, where nobody says how.

        Raises
        ------
        CorruptError
            When the model's payload does not follow the codec's format.

        """
        return self

    @property
    def learns(self) -> bool:
        """Whether it learns with these parameters (capability ``trains``)."""
        return self.can.trains

    @property
    def lossless(self) -> bool:
        """Whether the bits of all values come back."""
        return self.can.lossless

    @abstractmethod
    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64 including NaN, infinities and -0.

        Parameters
        ----------
        stream
            Of a kind that the codec takes.
        skeleton
            What the joints of the columns belong to; may be used, and is not needed to decode.
        model
            One that was learned from other columns costs ratio, not correctness.
        others
            Chunks that the codec may refer to; of scope library only.

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
        others: Others = NO_OTHERS,
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        """Decode consecutive chunks, the first a restart: (sum of their frames, C) float64.

        Parameters
        ----------
        header, chunks, columns
            What ``encode`` gave for a stream of these columns.
        model
            The one with which the stream was coded, if any.
        others
            At least the chunks of other clips that these chunks need.
        stop
            Give only the first so many frames; those behind need not be decoded or checked.

        Raises
        ------
        CorruptError
            When header, payload or model do not follow the codec's format, or the model with
            which the stream was coded, or a chunk that is needed, is missing. Never anything
            else, and never with more memory than a small multiple of (frames x columns x 8) bytes.

        """

    def prepared(self, clip: Clip) -> Clip:
        """Give the clip that stands for a clip of a file; of most codecs, that clip itself.

        Where it is another one, the file is not restored: what comes back is the other clip.
        """
        return clip

    def encode_together(
        self, streams: Sequence[Stream], *, skeleton: Skeleton | None = None
    ) -> Together:
        """Code streams of the same columns, chunks beside frames of others (scope library).

        What a chunk needs never needs that chunk again, whatever the way, and a codec says how
        long such ways may be.
        """
        raise ParameterError(f"codec {self.id} codes clips one by one")

    def train(self, streams: Iterable[Stream]) -> Model:
        """Learn a model from streams, which are gone through once (capability ``trains``).

        The same model on every run and every machine.
        """
        raise ParameterError(f"codec {self.id} takes no model")

    def learn(self, clips: Iterable[Clip]) -> Model:
        """Learn a model from clips; a codec that looks at skeletons overrides it."""
        return self.train(clip.main for clip in clips)

    def largest_errors(self, columns: Sequence[Column]) -> list[float]:
        """Give the error up to which each column may come back; infinite where none was asked."""
        return [0.0 if self.lossless else inf] * len(columns)

    def more_digits(self, clip: Clip, encoded: Encoded) -> int:
        """Give how many more digits than their source has numbers need to keep bounds as text."""
        return 0

    def parts_of(self, clip: Clip) -> dict[str, list[int]]:
        """Give the parts of the body that have bounds of their own: name -> joints, or markers."""
        return {}

    def measure(self, clip: Clip, encoded: Encoded, raw_bytes: int) -> dict[str, float]:
        """Give what is measured of this codec alone (capability ``measured``): name -> value."""
        return {}

    def document(self, clip: Clip, layout: bytes = b"") -> bytes:
        """Code a clip as DiffMA JSON, which was read and decoded again (capability ``document``).

        Parameters
        ----------
        clip
            Finite values only.
        layout
            What makes the original file again; may be empty.

        Raises
        ------
        VerificationError
            When what was decoded is not what was encoded, or breaks a bound.

        """
        raise ParameterError(f"codec {self.id} writes no JSON", expected="diffma")
