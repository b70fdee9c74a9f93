"""A clip: the motion of one take as a matrix with named columns."""

from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mocapress.model.number_format import NumberFormat
from mocapress.model.skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class Column:
    """One channel of a clip."""

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
class Clip:
    """Motion as a matrix: one row per frame, one column per channel.

    Immutable in spirit: operations give new clips.
    """

    values: NDArray[np.float64]
    """(F, C) float64, in the units of the columns, exactly as the source has them."""
    columns: tuple[Column, ...]
    frame_time: Decimal | None = None
    """Seconds per frame as the file states it; None where the format does not say (AMC)."""
    skeleton: Skeleton | None = None
    name: str = ""
    metadata: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.values.ndim != 2 or self.values.shape[1] != len(self.columns):
            msg = f"values of shape {self.values.shape} for {len(self.columns)} columns"
            raise ValueError(msg)

    @property
    def frames(self) -> int:
        """Number of frames, F."""
        return int(self.values.shape[0])

    @property
    def channels(self) -> int:
        """Number of channels, C."""
        return len(self.columns)

    def _repr_html_(self) -> str | None:
        """Play the clip in a notebook.

        The model draws nothing itself: whoever can announces it as ``mocapress.display``.
        """
        from importlib.metadata import entry_points

        for offer in entry_points(group="mocapress.display", name="html"):
            return str(offer.load()(self)) if self.frames else None
        return None

    def with_values(self, values: NDArray[np.float64]) -> Self:
        """Give the same clip with other values, (F', C)."""
        return replace(self, values=np.ascontiguousarray(values, dtype=np.float64))
