"""The predictors that the APP paper compares with (its Table 2), with the same mantissa coder.

They follow the codec contract but are not registered: they exist for the benchmark only.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.app import App, Coding
from mocapress.codecs.contract import (
    NO_OTHERS,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.motion import Column, Skeleton, Stream


@dataclass(frozen=True, slots=True)
class _OneAlpha(Codec):
    """APP with a single alpha, and therefore without indices."""

    id: ClassVar[str]
    alpha: ClassVar[float]
    can: ClassVar[Capabilities] = Capabilities(lossless=True)

    mantissa_limit: int = App().mantissa_limit
    chunk: int = App().chunk

    @property
    def coding(self) -> Coding:
        """Settings of the compiled coder."""
        return Coding((self.alpha,), 1, self.mantissa_limit, self.chunk)

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,  # noqa: ARG002
        others: Others = NO_OTHERS,  # noqa: ARG002
    ) -> Encoded:
        """Code a stream, as ``App.encode`` does."""
        return self.coding.encode(stream, skeleton)

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,  # noqa: ARG002
        others: Others = NO_OTHERS,  # noqa: ARG002
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        """Decode chunks, as ``App.decode`` does."""
        return self.coding.decode(header, chunks, columns)[:stop]


@dataclass(frozen=True, slots=True)
class Parallelogram(_OneAlpha):
    """The parallelogram predictor without alpha (Eq. 4), "Non-Alpha PP" in the paper."""

    id: ClassVar[str] = "parallelogram"
    alpha: ClassVar[float] = 1.0


@dataclass(frozen=True, slots=True)
class PreviousFrame(_OneAlpha):
    """MPEG-4 FBA's linear prediction without quantisation, "LP" in the paper."""

    id: ClassVar[str] = "mpeg4-lp"
    alpha: ClassVar[float] = 0.0
