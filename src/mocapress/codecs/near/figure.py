"""What errors are measured at: the joints of a skeleton, or markers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.markers import Markers, kept_of, markers_of
from mocapress.motion import Column, Joint, Skeleton
from mocapress.motion.units import centimetres_per_unit, figure_size

Array = NDArray[np.float64]
RADIUS = 3.0
"""Centimetres along the joints' axes at which errors are measured, as ACL does."""
HEIGHT = 170.0
"""Centimetres of a figure of which nothing is known."""
_SAMPLE = 500
"""Frames by which markers are looked at."""


@dataclass(frozen=True, slots=True)
class Figure:
    """The points of clips of some columns, in units of the file."""

    skeleton: Skeleton
    """Markers are joints without parents that only move."""
    columns: tuple[Column, ...]
    """As they move the joints."""
    size: float
    unit: float | None
    """Centimetres in a unit of length; None where nothing says so."""
    radius: float
    """How far from a joint, along its axes, errors are measured besides."""
    markers: Markers | None = None

    def moves(self, column: Column) -> bool:
        """Say whether a column of ``columns`` moves or turns a joint."""
        if not 0 <= column.joint < len(self.skeleton.joints):
            return False
        return column.kind[0] in "tr" and column.kind in self.skeleton.joints[column.joint].channels


def figure_of(skeleton: Skeleton | None, columns: Sequence[Column], values: Array) -> Figure | None:
    """Give what errors of (F, C) values are measured at; None: each counts by itself."""
    if skeleton is None:
        return _figure_of_markers(columns, values)
    size = figure_size(skeleton) if skeleton.joints else 0.0
    stretched = any(column.kind == "l" for column in columns)  # has no kinematics here
    if not (isfinite(size) and size > 0) or stretched:
        return None
    unit = centimetres_per_unit(skeleton)
    radius = RADIUS / unit if unit else RADIUS / HEIGHT * size
    return Figure(skeleton, tuple(columns), size, unit, radius)


def _figure_of_markers(columns: Sequence[Column], values: Array) -> Figure | None:
    markers = markers_of(columns)
    if not markers.first:
        return None
    joints = tuple(Joint(name, -1, channels=("tx", "ty", "tz")) for name in markers.names)
    moving = list(columns)
    for index, first in enumerate(markers.first):
        for c in range(first, first + 3):
            moving[c] = replace(moving[c], joint=index, kind=f"t{moving[c].kind}")
    unit = markers.centimetres(columns)
    places = _places(markers, values)
    spread = np.fmax.reduce(places, axis=1) - np.fmin.reduce(places, axis=1)
    known = spread[np.isfinite(spread).all(axis=1)].max(axis=1)
    size = float(np.median(known)) if len(known) else 0.0
    # A single marker is no figure.
    size = size or (HEIGHT / unit if unit else 1.0)
    return Figure(Skeleton(joints), tuple(moving), size, unit, 0.0, markers)


def tree_of(figure: Figure, values: Array) -> Skeleton:
    """Give markers as a tree: under each those behind it whose distance from it changes least."""
    assert figure.markers is not None
    places = _places(figure.markers, values)
    parents = [-1]
    for p in range(1, places.shape[1]):
        lengths = np.linalg.norm(places[:, :p] - places[:, p : p + 1], axis=2)
        there = np.isfinite(lengths)
        counts = there.sum(axis=0)
        means = np.where(there, lengths, 0).sum(axis=0) / np.maximum(counts, 1)
        squares = (np.where(there, lengths - means, 0) ** 2).sum(axis=0) / np.maximum(counts, 1)
        squares[counts < 2] = np.inf
        parents.append(int(squares.argmin()))
    joints = zip(figure.skeleton.joints, parents, strict=True)
    return Skeleton(tuple(replace(joint, parent=parent) for joint, parent in joints))


def _places(markers: Markers, values: Array) -> Array:
    """Give the places of markers in some frames, (F, P, 3); NaN where they are missing."""
    some = values[:: max(1, len(values) // _SAMPLE)]
    return markers.places(np.where(kept_of(markers, some), np.nan, some))
