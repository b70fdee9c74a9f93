"""A clip: streams of numbers recorded together, with the skeleton that they move."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal, localcontext
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
    """Give a frame time as a decimal: exactly where it is one, else the nearest short one."""
    return frame_time if isinstance(frame_time, Decimal) else short_decimal(frame_time)


def short_decimal(value: Fraction) -> Decimal:
    """Give the decimal of fewest digits that differs by less than one part in 10**18.

    So that a frame time of up to 17 digits comes back from the rate, and the rate from it. A
    decimal of up to 20 digits stays as it is: it may have been made here before.
    """
    with localcontext() as context:
        context.prec = 20
        exact = Decimal(value.numerator) / Decimal(value.denominator)
        if Fraction(exact) == value:
            return exact.normalize()
        for context.prec in range(1, 21):
            short = Decimal(value.numerator) / Decimal(value.denominator)
            if abs(Fraction(short) - value) * 10**18 < abs(value):
                break
    return short


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
    """Seconds per frame as the file states it; None where it does not (most AMC)."""

    def __post_init__(self) -> None:
        if self.values.ndim != 2 or self.values.shape[1] != len(self.columns):
            msg = f"values of shape {self.values.shape} for {len(self.columns)} columns"
            raise ValueError(msg)
        values = np.ascontiguousarray(self.values, dtype=np.float64).view()
        values.flags.writeable = False
        object.__setattr__(self, "values", values)

    def __repr__(self) -> str:
        """Say what it is in a line, without the numbers."""
        time = "unknown" if self.frame_time is None else self.frame_time
        return f"<Stream: {self.frames} frames x {self.channels} channels, frame time {time}>"

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

    def __repr__(self) -> str:
        """Say what it is in a line, without the numbers."""
        streams = ", ".join(f"{name}: {stream!r}" for name, stream in self.streams.items())
        joints = f"{len(self.skeleton.joints)} joints" if self.skeleton else "no skeleton"
        return f"<Clip {self.name!r}: {streams}, {joints}>"

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
        """Seconds per frame of the first stream; None where the source does not say."""
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

    def __getitem__(self, frames: slice) -> Self:
        """Give some of the frames: ``clip[a:b:step]``, with Python's rules for slices.

        The frame time follows the step: every second frame lasts twice as long. With a step below
        zero the clip runs backwards. All streams have to share their frames.

        Raises
        ------
        TypeError
            When it is no slice. One frame is ``clip[a : a + 1]``, or ``clip.values[a]``.
        ValueError
            When the streams have different frames.

        """
        if not isinstance(frames, slice):
            msg = f"a clip takes a slice, such as clip[10:11], not {frames!r}"
            raise TypeError(msg)
        step = abs(range(self.frames)[frames].step)
        if any(
            (stream.frames, stream.frame_time) != (self.frames, self.frame_time)
            for stream in self.streams.values()
        ):
            msg = "the streams of this clip differ in their frames"
            raise ValueError(msg)
        frame_time = None if self.frame_time is None else self.frame_time * step
        streams = {
            name: replace(stream, values=stream.values[frames], frame_time=frame_time)
            for name, stream in self.streams.items()
        }
        return replace(self, streams=streams)

    def with_values(self, values: NDArray[np.float64]) -> Self:
        """Give the same clip with other values in the first stream.

        Parameters
        ----------
        values
            (F, C), of as many frames as before: what other frames would last is not known here.
            ``clip[a:b:step]`` takes some of the frames, ``with_frames`` puts others in.

        Raises
        ------
        ValueError
            When there are more or fewer frames or channels.

        """
        if len(values) != self.frames:
            msg = f"{len(values)} frames of values for a clip of {self.frames}; see with_frames"
            raise ValueError(msg)
        return self._with_main(values=values)

    def with_frames(self, values: NDArray[np.float64], frame_time: FrameTime) -> Self:
        """Give the same clip with other frames in the first stream, and what each lasts.

        Parameters
        ----------
        values
            (F', C), of any number of frames.
        frame_time
            Seconds per frame; None where it is not known.

        """
        return self._with_main(values=values, frame_time=frame_time)

    def with_columns(self, columns: tuple[Column, ...]) -> Self:
        """Give the same clip with other columns in the first stream, as many as before."""
        return self._with_main(columns=columns)

    def with_frame_time(self, frame_time: FrameTime) -> Self:
        """Give the same frames with another frame time in the first stream.

        The clip then lasts longer or shorter, and plays slower or faster.
        """
        return self._with_main(frame_time=frame_time)

    def _with_main(self, **changes: object) -> Self:
        name = next(iter(self.streams))
        changed = replace(self.main, **changes)  # type: ignore[arg-type]
        return replace(self, streams={**self.streams, name: changed})
