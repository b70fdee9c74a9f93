"""The codec ``app``."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.app.coding import Coding
from mocapress.codecs.app.measures import average_prediction_error
from mocapress.codecs.app.tables import ALPHA_TABLES
from mocapress.codecs.contract import (
    NO_OTHERS,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column, Skeleton, Stream

_MOST_FRAMES = 1 << 20
_DOUBLE_MANTISSA = 53


@dataclass(frozen=True, slots=True)
class App(Codec):
    """The Alpha Parallelogram Predictor, lossless for any float64.

    Every value is predicted by the one before plus alpha times the step of its parent's column
    (Eq. 6); sign, exponent and mantissa of the correction are coded by Algorithm 1.
    """

    id: ClassVar[str] = "app"
    can: ClassVar[Capabilities] = Capabilities(lossless=True, measured=True)

    t: int = 15
    """Frames per cluster, which share one alpha per column."""
    table: str = "k3-non-uniform"
    """Name of the lookup table, of ``ALPHA_TABLES``."""
    mantissa_limit: int = 12
    """Mantissa differences of fewer bits are coded in context, others leave the mantissa raw: 12 in
    the paper; from 24 on (53 for float64) every difference is coded in context."""
    chunk: int = 480
    """Frames that are decoded together, rounded up to whole clusters."""

    def __post_init__(self) -> None:
        if self.table not in ALPHA_TABLES:
            raise ParameterError(
                "app:table", expected=", ".join(ALPHA_TABLES), found=repr(self.table)
            )
        for name, most in (
            ("t", _MOST_FRAMES),
            ("mantissa_limit", _DOUBLE_MANTISSA),
            ("chunk", _MOST_FRAMES),
        ):
            value = getattr(self, name)
            if not isinstance(value, int) or not 1 <= value <= most:
                raise ParameterError(f"app:{name}", expected=f"1 to {most}", found=repr(value))

    @property
    def coding(self) -> Coding:
        """Settings of the compiled coder."""
        return Coding(ALPHA_TABLES[self.table], self.t, self.mantissa_limit, self.chunk)

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64 including NaN, infinities and -0."""
        return self.coding.encode(stream, skeleton)

    def measure(self, clip: Clip, encoded: Encoded, raw_bytes: int) -> dict[str, float]:
        """Give MCR, TCR (Eqs. 11 and 12) and APE (Eq. 13) of a coded clip."""
        size = sum(len(chunk.payload) for chunk in encoded.chunks)
        indices = self.coding.index_bytes(encoded.chunks, clip.channels)
        return {
            "MCR": raw_bytes / max(size - indices, 1),
            "TCR": raw_bytes / max(size, 1),
            "APE": average_prediction_error(clip, self),
        }

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
        """Decode any chunks, one after the other: (sum of their frames, C) float64.

        Raises
        ------
        CorruptError
            When header or payload are not what ``encode`` makes with these parameters.

        """
        return self.coding.decode(header, chunks, columns)[:stop]
