"""The codec ``mrpa``."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.chunks import check_frames
from mocapress.codecs.contract import (
    NO_OTHERS,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
    Scope,
    Together,
)
from mocapress.codecs.mrpa import coding, forest, paths, som
from mocapress.errors import ParameterError
from mocapress.motion import Column, Skeleton, Stream

_MOST_FRAMES = 1 << 20
_MOST_DEPTH = 16
_DOUBLE_MANTISSA = 53
_MODES = {"best": coding.BEST, "published": coding.PUBLISHED}


@dataclass(frozen=True, slots=True)
class Mrpa(Codec):
    """Motion Recurring Pattern Analysis, lossless for any float64.

    Stretches of clips that resemble others are predicted from these; what predictions miss is coded
    by APP's floating-point compression. A clip alone is predicted from itself.
    """

    id: ClassVar[str] = "mrpa"
    can: ClassVar[Capabilities] = Capabilities(lossless=True, scope=Scope.LIBRARY)

    mode: str = "best"
    """``published``: segments and forest of the paper, roots without prediction. ``best``: each
    path that helps, and for each column of a piece the prediction that is shortest."""
    depth: int = 2
    """How many chunks may need each other in a row: 0 forbids parents."""
    chunk: int = 480
    """Frames that are decoded together; in mode ``published`` it is a segment."""
    mantissa_limit: int = 53
    """As in ``app``."""
    valid_path: int = paths.VALID_PATH_THRESHOLD
    """ValidPathThr, frames."""
    length: int = som.LENGTH_THRESHOLD
    """LengthThr, frames."""
    iou: float = forest.IOU_THRESHOLD
    """IoUThr."""
    radius: float = 0.0
    """R of Eq. 1, in weighted degrees; 0: derived from the clips."""

    def __post_init__(self) -> None:
        if self.mode not in _MODES:
            raise ParameterError("mrpa:mode", expected=", ".join(_MODES), found=repr(self.mode))
        for name, least, most in (
            ("depth", 0, _MOST_DEPTH),
            ("chunk", 1, _MOST_FRAMES),
            ("mantissa_limit", 1, _DOUBLE_MANTISSA),
            ("valid_path", 1, _MOST_FRAMES),
            ("length", 1, _MOST_FRAMES),
        ):
            value = getattr(self, name)
            if not isinstance(value, int) or not least <= value <= most:
                raise ParameterError(
                    f"mrpa:{name}", expected=f"{least} to {most}", found=repr(value)
                )
        if not 0 < self.iou <= 1:
            raise ParameterError("mrpa:iou", expected="above 0, at most 1", found=repr(self.iou))
        if not 0 <= self.radius < 1e9:
            raise ParameterError("mrpa:radius", expected="0 or more", found=repr(self.radius))

    @property
    def choice(self) -> int:
        """How the compiled coder chooses predictions."""
        return _MODES[self.mode]

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream without parents; ``encode_together`` finds them."""
        values = np.ascontiguousarray(stream.values, dtype=np.float64)
        plan = coding.plan_for(values, stream.columns, skeleton)
        chunks = []
        for first in range(0, stream.frames, self.chunk):
            rows = values[first : first + self.chunk]
            pieces = [coding.Piece(len(rows))]
            chunks.append(
                coding.encode_chunk(first, rows, pieces, plan, self.mantissa_limit, self.choice)
            )
        return Encoded(coding.pack_header(plan, chunks), tuple(chunks))

    def encode_together(
        self, streams: Sequence[Stream], *, skeleton: Skeleton | None = None
    ) -> Together:
        """Code streams of the same columns, pieces of them beside pieces of others."""
        from mocapress.codecs.mrpa.together import encode_together

        return encode_together(self, streams, skeleton)

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
            When header or payload are not what ``encode`` makes with these parameters, or a chunk
            that is needed is missing.

        """
        plan = coding.unpack_header(header, columns)
        # Segments of the paper may be longer than chunks.
        most = _MOST_FRAMES if self.mode == "published" else self.chunk
        for chunk in chunks:
            check_frames("MRPA chunk", chunk, most)
        values = [coding.decode_chunk(chunk, plan, self.mantissa_limit, others) for chunk in chunks]
        return np.concatenate([np.empty((0, len(columns))), *values])[:stop]
