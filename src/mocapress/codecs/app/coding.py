"""A clip to chunks and back: the predictor with any table, cut into chunks of frames."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.app.header import pack_header, unpack_header
from mocapress.codecs.app.parents import parent_columns
from mocapress.codecs.chunks import check_frames
from mocapress.codecs.contract import Chunk, Encoded
from mocapress.errors import CorruptError
from mocapress.motion import Column, Skeleton, Stream
from mocapress.motion.number_format import NumberKind

_LINES = {
    NumberKind.GENERAL: (2, 0),
    NumberKind.SCIENTIFIC: (2, 1),
    NumberKind.FIXED: (3, 0),
    NumberKind.TRIMMED: (3, 0),
    NumberKind.SHORTEST32: (4, 0),
}
"""Line of core/numbers/line.hpp, and how many digits it has more than the format says."""


@dataclass(frozen=True, slots=True)
class Coding:
    """Settings of the compiled coder.

    A table of one alpha takes no indices: (1,) is the parallelogram predictor (Eq. 4), (0,) is
    prediction from the previous frame.
    """

    alphas: tuple[float, ...]
    """Lookup table, of 2^k entries."""
    t: int
    """Frames per cluster."""
    mantissa_limit: int
    chunk: int
    """Frames per chunk, rounded up to whole clusters."""

    @property
    def frames_per_chunk(self) -> int:
        """Frames of every chunk but the last."""
        return -(-self.chunk // self.t) * self.t

    def encode(self, stream: Stream, skeleton: Skeleton | None) -> Encoded:
        """Code a stream, (F, C) float64."""
        values = np.ascontiguousarray(stream.values, dtype=np.float64)
        parents = parent_columns(stream.columns, skeleton)
        plan = make_plan(stream.columns, parents, [0] * stream.channels)
        precisions = _core.app_precisions(values, plan)
        plan[:, 1] = precisions
        table = np.array(self.alphas, dtype=np.float64)
        chunks = []
        for first in range(0, stream.frames, self.frames_per_chunk):
            rows = values[first : first + self.frames_per_chunk]
            payload = _core.app_encode(rows, plan, table, self.t, self.mantissa_limit)
            chunks.append(Chunk(first, len(rows), payload))
        index_bytes = self.index_bytes(chunks, stream.channels)
        return Encoded(pack_header(parents, precisions), tuple(chunks), index_bytes)

    def decode(
        self, header: bytes, chunks: Sequence[Chunk], columns: Sequence[Column]
    ) -> NDArray[np.float64]:
        """Decode any chunks, one after the other, to (sum of their frames, C) float64.

        Raises
        ------
        CorruptError
            When header or payload are not what ``encode`` makes with this coding.

        """
        plan = make_plan(columns, *unpack_header(header, len(columns)))
        table = np.array(self.alphas, dtype=np.float64)
        for chunk in chunks:
            self._check_size(chunk, len(columns))
        values = np.empty((sum(chunk.frames for chunk in chunks), len(columns)))
        row = 0
        for chunk in chunks:
            rows = values[row : row + chunk.frames]
            try:
                _core.app_decode(chunk.payload, rows, plan, table, self.t, self.mantissa_limit)
            except ValueError as error:
                raise CorruptError(f"APP chunk from frame {chunk.first}: {error}") from error
            row += chunk.frames
        return values

    def index_bytes(self, chunks: Sequence[Chunk], channels: int) -> int:
        """Give how many bytes of the payloads are indices of alphas (IdxSize, Eq. 10)."""
        return sum(self._index_bytes(chunk.frames, channels) for chunk in chunks)

    def _index_bytes(self, frames: int, channels: int) -> int:
        bits = len(self.alphas).bit_length() - 1
        return (-(-frames // self.t) * channels * bits + 7) // 8  # Eqs. 2 and 10

    def _check_size(self, chunk: Chunk, channels: int) -> None:
        """Refuse what cannot be, before memory is asked for it."""
        check_frames("APP chunk", chunk, self.frames_per_chunk)
        least = self._index_bytes(chunk.frames, channels) + 1
        if len(chunk.payload) < least:
            raise CorruptError(
                f"APP chunk from frame {chunk.first} is cut off",
                expected=f"at least {least} bytes",
                found=str(len(chunk.payload)),
            )


def make_plan(
    columns: Sequence[Column], parents: Sequence[int], precisions: Sequence[int]
) -> NDArray[np.int32]:
    """Give the plan of the compiled coder, (C, 4) int32: parent, precision, line, digits."""
    plan = np.zeros((len(columns), 4), dtype=np.int32)
    plan[:, 0] = parents
    plan[:, 1] = precisions
    for row, column in zip(plan, columns, strict=True):
        if column.decimal is not None and column.decimal.kind in _LINES:
            line, more = _LINES[column.decimal.kind]
            row[2:] = line, column.decimal.digits + more
    return plan
