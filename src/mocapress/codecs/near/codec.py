"""The codec ``near``."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.chunks import decoded_into
from mocapress.codecs.contract import (
    NO_OTHERS,
    Bound,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.codecs.markers import markers_of
from mocapress.codecs.near.encoding import Encoder
from mocapress.codecs.near.figure import figure_of
from mocapress.codecs.near.goal import WITHIN, Goal, Measure, goal_of
from mocapress.codecs.near.header import unpack_errors
from mocapress.codecs.near.parts import amounts, joints_of_parts
from mocapress.codecs.near.search import EFFORTS, encode
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.number_format import NumberFormat, NumberKind
from mocapress.motion.units import amount

_MOST_FRAMES = 1 << 20
_QUALITIES = range(1, 10)
_MOST_MORE_DIGITS = 17
_OF_MEAN = 0.02
"""Of the mean error, what rounding of printed numbers may add to any."""
_ASSUMED_RATE = 120.0
"""Frames a second of a clip that states none, such as an AMC."""


@dataclass(frozen=True, slots=True)
class Near(Codec):
    """Lossy motion of a skeleton at a guaranteed error of its joints.

    The error of a joint is the largest of its own place's and those of three points, 3 cm along its
    axes. ``max`` keeps every error of every joint and frame, ``mean`` their mean, ``p`` both as ACL
    does at that precision. Amounts have a unit, ``0.1cm``; without one they are in units of the
    file. Clips without a skeleton keep the errors of their values, in degrees.
    """

    id: ClassVar[str] = "near"
    can: ClassVar[Capabilities] = Capabilities(
        lossless=False,
        names=True,
        bounds=frozenset({Bound.LARGEST}),
        stands_back=True,
        measured=True,
    )

    max: str = ""
    """Largest error of any joint in any frame: ``0.1cm``, ``0.5mm``, ``0.2deg``."""
    mean: str = ""
    """Mean error over joints and frames, reached to 2 %."""
    p: str = ""
    """ACL's precision: a mean of a third, a largest error of at most 1.6 times it."""
    quality: int = 5
    """Where nothing else is asked for: 1 (1 cm of a figure 1.7 m high) to 9 (0.01 cm)."""
    max_error: float = inf
    """Largest error of any value, in the unit of its channel; instead of all others."""
    chunk: int = 4096
    """Frames that are decoded together."""
    effort: int = 2
    """How long to search: 1 looks at a part of the clip, so that the mean is not quite what was
    asked for; 3 tries more and keeps the smallest. Bounds are kept by all."""
    parts: str = ""
    """Largest errors of joints and parts of the body that have their own: ``feet=0.02cm,head=1mm``.
    """
    rate: float = 0.0
    """Kilobytes of 1000 bytes a second, instead of an error; 120 frames a second where the clip
    does not say."""
    rest: ClassVar[str] = "parts"

    def __post_init__(self) -> None:
        for name in ("max", "mean", "p"):
            if getattr(self, name):
                amount(getattr(self, name), f"near:{name}")
        amounts(self.parts)
        if self.p and (self.max or self.mean):
            raise ParameterError("near:p", expected="neither max nor mean beside it")
        if not isinstance(self.quality, int) or self.quality not in _QUALITIES:
            raise ParameterError("near:quality", expected="1 to 9", found=repr(self.quality))
        if not isinstance(self.effort, int) or self.effort not in EFFORTS:
            raise ParameterError("near:effort", expected="1 to 3", found=repr(self.effort))
        if not 0 <= self.rate < inf:
            raise ParameterError("near:rate", expected="kB/s above 0", found=repr(self.rate))
        if self.rate and (self.max or self.mean or self.p or self.parts or self.max_error < inf):
            raise ParameterError("near:rate", expected="no bound of errors beside it")
        if not self.max_error >= 0:
            raise ParameterError("near:max_error", expected="0 or more", found=repr(self.max_error))
        if not isinstance(self.chunk, int) or not 1 <= self.chunk <= _MOST_FRAMES:
            raise ParameterError(
                "near:chunk", expected=f"1 to {_MOST_FRAMES}", found=repr(self.chunk)
            )

    def goal(
        self,
        skeleton: Skeleton | None,
        columns: Sequence[Column],
        values: NDArray[np.float64] | None = None,
    ) -> Goal:
        """Give what is asked of clips with this skeleton and these columns.

        The size of markers is that of ``values``, (F, C); it counts where a quality is asked for.
        """
        if self.max_error < inf:
            if self.parts:
                raise ParameterError("near:max_error", expected="no bounds of parts beside it")
            return Goal(False, max(self.max_error / 3, 1e-9), inf)
        most, mean, precision = (
            amount(text, "near") if text else None for text in (self.max, self.mean, self.p)
        )
        some = np.empty((0, len(columns))) if values is None else values
        return goal_of(
            figure_of(skeleton, columns, some),
            most=most,
            mean=mean,
            precision=precision,
            quality=self.quality,
            parts=amounts(self.parts),
        )

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64; NaN and infinities stay as they are.

        Raises
        ------
        ParameterError
            When a length is asked for, and nothing says how long the units of the file are.
        VerificationError
            When what was decoded breaks a bound.

        """
        goal = self.goal(skeleton, stream.columns, stream.values)
        budget = inf
        if self.rate:
            goal = replace(goal, most=inf)
            seconds = stream.frames * float(stream.frame_time or 1 / _ASSUMED_RATE)
            budget = 1000 * self.rate * seconds
        encoder = Encoder(goal, self.max_error, self.chunk, stream, skeleton, budget)
        return encode(encoder, self.effort)

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

        def decode(payload: bytes, rows: NDArray[np.float64]) -> None:
            _core.near_decode(header, payload, rows)

        return decoded_into("chunk of near", chunks, len(columns), self.chunk, decode)[:stop]

    def largest_errors(self, columns: Sequence[Column]) -> list[float]:
        """Give the error up to which each column may come back; infinite where none was asked."""
        return [self.max_error] * len(columns)

    def more_digits(self, clip: Clip, encoded: Encoded) -> int:
        """Give how many more digits than their source has numbers need to keep bounds as text.

        Rounding may take what the encoder leaves of the bounds, or a small part of the mean error.
        """
        formats = [column.decimal or NumberFormat(NumberKind.SHORTEST) for column in clip.columns]
        if not encoded.chunks or all(each.kind == NumberKind.SHORTEST for each in formats):
            return 0
        goal = self.goal(clip.skeleton, clip.columns, clip.values)
        measure = Measure(goal, figure_of(clip.skeleton, clip.columns, clip.values), clip.columns)
        most = (1 - WITHIN) * np.minimum(goal.largest(measure.points), self.max_error)
        most = np.minimum(most, _OF_MEAN * unpack_errors(encoded.header)[1])
        values = self.decode(encoded.header, encoded.chunks, clip.columns)
        for more in range(_MOST_MORE_DIGITS):
            text = np.column_stack(
                [each.finer(more).rounded(values[:, c]) for c, each in enumerate(formats)]
            )
            if not (_core.near_errors(measure.core, values, text) > most).any():
                return more
        return _MOST_MORE_DIGITS

    def parts_of(self, clip: Clip) -> dict[str, list[int]]:
        """Give the joints, or markers, of each part that has a bound of its own."""
        figure = figure_of(clip.skeleton, clip.columns, clip.values[:0])
        return joints_of_parts(figure.skeleton, amounts(self.parts)) if figure else {}

    def measure(self, clip: Clip, encoded: Encoded, raw_bytes: int) -> dict[str, float]:
        """Give the errors that the encoder found: of joints, in units of length, or of values."""
        in_space, mean, largest = unpack_errors(encoded.header)
        has_markers = clip.skeleton is None and markers_of(clip.columns).first
        of = "value" if not in_space else "marker" if has_markers else "joint"
        return {f"mean_{of}_error": mean, f"largest_{of}_error": largest}
