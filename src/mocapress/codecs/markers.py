"""Which columns of a stream are markers, and where these are missing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapress.motion import Column
from mocapress.motion.units import centimetres_in

Array = NDArray[np.float64]
_COLUMNS_PER_NODE = 6
_FAR = 1e12
"""Larger numbers are no motion; they come back as they are."""


@dataclass(frozen=True, slots=True)
class Markers:
    """How columns are points in space."""

    names: tuple[str, ...]
    """Without what stands before a colon."""
    first: tuple[int, ...]
    """The column of each marker's x; y and z follow."""
    others: tuple[tuple[int, ...], ...]
    """Columns of no marker, in groups that move together."""

    def places(self, values: Array) -> Array:
        """Give (F, P, 3) of (F, C) values."""
        found: Array = values[:, np.array(self.columns, dtype=np.intp)]
        return found.reshape(len(values), len(self.first), 3)

    @property
    def columns(self) -> list[int]:
        """The columns of all markers."""
        return [c + i for c in self.first for i in range(3)]

    def centimetres(self, columns: Sequence[Column]) -> float | None:
        """Give the unit of their places in centimetres; None where columns do not say one."""
        units = {centimetres_in(columns[c].unit) for c in self.columns}
        return units.pop() if len(units) == 1 else None


def markers_of(columns: Sequence[Column]) -> Markers:
    """Find the markers among columns: x, y and z of the same name one behind the other."""
    names, first, others = [], [], []
    c = 0
    while c < len(columns):
        own = [column.name.rpartition(".")[0] for column in columns[c : c + 3]]
        if [column.kind for column in columns[c : c + 3]] == ["x", "y", "z"] and len(set(own)) == 1:
            names.append(own[0].rpartition(":")[2])
            first.append(c)
            c += 3
        else:
            others.append(c)
            c += 1
    groups: list[list[int]] = []
    for c in others:
        last = groups[-1] if groups else []
        together = last and last[-1] == c - 1 and columns[last[-1]].joint == columns[c].joint
        if together and len(last) < _COLUMNS_PER_NODE:
            last.append(c)
        else:
            groups.append([c])
    return Markers(tuple(names), tuple(first), tuple(map(tuple, groups)))


def kept_of(markers: Markers, values: Array) -> NDArray[np.bool_]:
    """Say which of (F, C) values must come back as they are: what is no finite place.

    A marker that is at 0, 0, 0 or has no finite place is missing: all its coordinates are kept, and
    stand for nothing else.
    """
    with np.errstate(invalid="ignore"):
        kept = ~(np.abs(values) < _FAR)
    for first in markers.first:
        own = values[:, first : first + 3]
        gone = kept[:, first : first + 3].any(axis=1) | (own == 0).all(axis=1)
        # A marker that never moves from 0, 0, 0 is one.
        if not gone.all() or kept[:, first : first + 3].any():
            kept[gone, first : first + 3] = True
    return kept
