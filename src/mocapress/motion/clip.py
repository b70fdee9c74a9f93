"""A clip: streams of numbers recorded together, with the skeleton that they move."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mocapress.motion.number_format import NumberFormat
from mocapress.motion.skeleton import Skeleton

FrameTime = Decimal | Fraction | None
"""Seconds per frame, exactly; None where the source does not say."""


def decimal_seconds(frame_time: Decimal | Fraction) -> Decimal:
    """Give a frame time as a decimal: exactly where it is one, else to 28 digits."""
    if isinstance(frame_time, Decimal):
        return frame_time
    return Decimal(frame_time.numerator) / Decimal(frame_time.denominator)


MOTION = "motion"
"""Name of the stream that holds the channels of a skeleton's joints."""


@dataclass(frozen=True, slots=True)
class Column:
    """One channel of a stream."""

    name: str
    """``joint.kind``, e.g. ``lfemur.rx``."""
    joint: int
    """Index of the joint, in the skeleton or, without one, in order of appearance; -1 for none."""
    kind: str
    """``tx ty tz rx ry rz``, ``l``, or another name."""
    unit: str = ""
    """``deg``, ``rad``, ``length`` or empty."""
    decimal: NumberFormat | None = None
    """How the source printed it; None where the values come from no text."""


@dataclass(frozen=True, slots=True, eq=False)
class Stream:
    """Numbers sampled at one rate: one row per frame, one column per channel."""

    values: NDArray[np.float64]
    """(F, C) float64, read-only, in the units of the columns, exactly as the source has them."""
    columns: tuple[Column, ...]
    frame_time: FrameTime = None
    """Seconds per frame as the file states it; None where the format does not say (AMC)."""

    def __post_init__(self) -> None:
        if self.values.ndim != 2 or self.values.shape[1] != len(self.columns):
            msg = f"values of shape {self.values.shape} for {len(self.columns)} columns"
            raise ValueError(msg)
        values = np.ascontiguousarray(self.values, dtype=np.float64).view()
        values.flags.writeable = False
        object.__setattr__(self, "values", values)

    @property
    def frames(self) -> int:
        """Number of frames, F."""
        return int(self.values.shape[0])

    @property
    def channels(self) -> int:
        """Number of channels, C."""
        return len(self.columns)


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """One take: named streams, the first of which is the one that most clips have alone.

    Immutable: operations give new clips, arrays are read-only.
    """

    streams: Mapping[str, Stream]
    """At least one."""
    skeleton: Skeleton | None = None
    """What the joints of the stream ``motion`` belong to."""
    name: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.streams:
            msg = "a clip needs at least one stream"
            raise ValueError(msg)
        object.__setattr__(self, "streams", MappingProxyType(dict(self.streams)))

    @classmethod
    def of(
        cls,
        values: NDArray[np.float64],
        columns: tuple[Column, ...],
        frame_time: FrameTime = None,
        skeleton: Skeleton | None = None,
        name: str = "",
    ) -> Self:
        """Make a clip of one stream, ``motion``, from (F, C) values."""
        return cls({MOTION: Stream(values, columns, frame_time)}, skeleton, name)

    @property
    def main(self) -> Stream:
        """The first stream; ``values``, ``columns`` and so on are its own."""
        return next(iter(self.streams.values()))

    @property
    def values(self) -> NDArray[np.float64]:
        """(F, C) float64, read-only, of the first stream."""
        return self.main.values

    @property
    def columns(self) -> tuple[Column, ...]:
        """Columns of the first stream."""
        return self.main.columns

    @property
    def frame_time(self) -> FrameTime:
        """Seconds per frame of the first stream; None where the source does not say (AMC)."""
        return self.main.frame_time

    @property
    def frames(self) -> int:
        """Number of frames of the first stream, F."""
        return self.main.frames

    @property
    def channels(self) -> int:
        """Number of channels of the first stream, C."""
        return self.main.channels

    def _repr_html_(self) -> str | None:
        """Play the clip in a notebook.

        The model draws nothing itself: whoever can announces it as ``mocapress.display``.
        """
        from importlib.metadata import entry_points

        for offer in entry_points(group="mocapress.display", name="html"):
            return str(offer.load()(self)) if self.frames else None
        return None

    def with_values(self, values: NDArray[np.float64]) -> Self:
        """Give the same clip with other values, (F', C), in the first stream."""
        return self._with_main(values=values)

    def with_columns(self, columns: tuple[Column, ...]) -> Self:
        """Give the same clip with other columns in the first stream, as many as before."""
        return self._with_main(columns=columns)

    def with_frame_time(self, frame_time: FrameTime) -> Self:
        """Give the same clip, played at another speed: its first stream has this frame time."""
        return self._with_main(frame_time=frame_time)

    def _with_main(self, **changes: object) -> Self:
        name = next(iter(self.streams))
        changed = replace(self.main, **changes)  # type: ignore[arg-type]
        return replace(self, streams={**self.streams, name: changed})
