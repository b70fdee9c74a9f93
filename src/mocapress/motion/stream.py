"""Numbers that were sampled together, and what each of them is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress.motion.frame_time import FrameTime
from mocapress.motion.number_format import NumberFormat


@dataclass(frozen=True, slots=True)
class Column:
    """One channel of a stream.

    Attributes
    ----------
    name
        ``joint.kind``, e.g. ``lfemur.rx``.
    joint
        Index of the joint, in the skeleton or, without one, in order of appearance; -1 for none.
    kind
        ``tx ty tz rx ry rz``, ``l``, or another name.
    unit
        ``deg``, ``rad``, ``length`` or empty.
    decimal
        How the source printed it; None where the values come from no text.

    """

    name: str
    joint: int
    kind: str
    unit: str = ""
    decimal: NumberFormat | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Stream:
    """Numbers sampled at one rate: one row per frame, one column per channel.

    Attributes
    ----------
    values
        (F, C) float64, read-only, in the units of the columns, exactly as the source has them.
    columns
        Of the values, in order.
    frame_time
        Seconds per frame as the file states it; None where it does not (most AMC).

    """

    values: NDArray[np.float64]
    columns: tuple[Column, ...]
    frame_time: FrameTime = None

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
