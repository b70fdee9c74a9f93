"""How the columns of a stream are coded: tracks, copies, and the groups that patterns move."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.markers import Markers, kept_of
from mocapress.codecs.patterns.hierarchy import NONE, Hierarchy
from mocapress.errors import ParameterError
from mocapress.records import Reader, Writer

Array = NDArray[np.float64]
_TRACK, _PROTECTED, _COPY, _FIRST_GROUP = range(4)


@dataclass(frozen=True, slots=True)
class Group:
    """The columns of a body part."""

    columns: tuple[int, ...]
    references: tuple[int, ...]
    """The column that each is relative to; ``NONE``: none."""
    weights: tuple[float, ...]
    points: float
    """Of how many points they are coordinates."""
    scale: float = 1.0
    """Of the thresholds."""


@dataclass(frozen=True, slots=True)
class Body:
    """All columns."""

    count: int
    tracks: tuple[int, ...]
    protected: tuple[int, ...]
    copies: Mapping[int, int]
    """Column -> the column that it is equal to."""
    groups: tuple[Group, ...]

    def pack(self) -> bytes:
        """Give what the format says of columns (docs/format/patterns.md, "Body", 1 and 2)."""
        roles, references = [_TRACK] * self.count, [NONE] * self.count
        for column in self.protected:
            roles[column] = _PROTECTED
        for column, source in self.copies.items():
            roles[column], references[column] = _COPY, source
        for n, group in enumerate(self.groups):
            for column, source in zip(group.columns, group.references, strict=True):
                roles[column], references[column] = _FIRST_GROUP + n, source
        writer = Writer()
        writer.integer(self.count)
        writer.runs(roles)
        back = [0 if of == NONE else column - of for column, of in enumerate(references)]
        writer.runs([2 * b if b >= 0 else -2 * b - 1 for b in back])
        return bytes(writer.data)

    @classmethod
    def unpack(cls, reader: Reader, markers: Markers) -> Self:
        """Read what ``pack`` writes; the columns of markers are known."""
        count = reader.integer(2**20)
        roles = reader.runs(count, count + 2).tolist()
        back = [
            (z >> 1) if z % 2 == 0 else -(z >> 1) - 1 for z in reader.runs(count, 2 * count + 1)
        ]
        sources = [c - b if b else NONE for c, b in enumerate(back)]
        in_space = set(markers.columns)
        groups = []
        for n in range(max([2, *roles]) - 2):
            own = tuple(c for c, role in enumerate(roles) if role == _FIRST_GROUP + n)
            points = len(own) / 3 if own and own[0] in in_space else float(len(own))
            groups.append(Group(own, tuple(sources[c] for c in own), (1.0,) * len(own), points))
        return cls(
            count,
            tuple(c for c, role in enumerate(roles) if role == _TRACK),
            tuple(c for c, role in enumerate(roles) if role == _PROTECTED),
            {c: sources[c] for c, role in enumerate(roles) if role == _COPY},
            tuple(groups),
        )


def body_of(
    markers: Markers,
    hierarchy: Hierarchy,
    count: int,
    *,
    protect: Sequence[str] = (),
    weights: Mapping[str, float] | None = None,
    copies: Mapping[int, int] | None = None,
) -> Body:
    """Say how columns are coded.

    Parameters
    ----------
    markers, hierarchy
        Of the columns.
    count
        Number of columns.
    protect
        Names of markers that are coded apart.
    weights
        Of markers by their names; 1 for others.
    copies
        Columns that are equal to others before them.

    Raises
    ------
    ParameterError
        When there is no marker of a name.

    """
    weights, copies = weights or {}, dict(copies or {})
    for name in (*protect, *weights):
        if name not in markers.names:
            raise ParameterError(
                "patterns: no marker of this name",
                expected=", ".join(markers.names) or "markers",
                found=repr(name),
            )
    protected = {i for i, name in enumerate(markers.names) if name in protect}
    tracks = {hierarchy.root} - protected - {NONE}
    used = _columns(markers, {part.reference for part in hierarchy.parts} - {NONE})
    groups = []
    for part in hierarchy.parts:
        kept = sorted(set(part.markers) - protected)
        columns, references, own = [], [], []
        for i in kept:
            for axis in range(3):
                column = markers.first[i] + axis
                if column in copies and column not in used:
                    continue
                columns.append(column)
                references.append(
                    NONE if part.reference == NONE else markers.first[part.reference] + axis
                )
                own.append(float(weights.get(markers.names[i], 1.0)))
        if columns:
            made = Group(
                tuple(columns), tuple(references), tuple(own), len(columns) / 3, part.scale
            )
            groups.append(made)
    for others in markers.others:
        size = len(others)
        groups.append(Group(others, (NONE,) * size, (1.0,) * size, float(size)))
    in_groups = {c for group in groups for c in group.columns}
    as_tracks = _columns(markers, tracks)
    as_protected = _columns(markers, protected)
    kept_copies = {
        c: of
        for c, of in copies.items()
        if c not in in_groups and c not in as_tracks and c not in as_protected
    }
    return Body(count, as_tracks, as_protected, kept_copies, tuple(groups))


def _columns(markers: Markers, chosen: set[int]) -> tuple[int, ...]:
    return tuple(markers.first[i] + axis for i in sorted(chosen) for axis in range(3))


def copies_of(markers: Markers, values: Array, root: int) -> dict[int, int]:
    """Find markers that are another one in all frames: column -> column."""
    seen: dict[bytes, int] = {}
    found: dict[int, int] = {}
    order = sorted(range(len(markers.first)), key=lambda i: (i != root, i))
    # Of equal markers the last is kept: labels stand behind numbers.
    for i in [*order[:1], *reversed(order[1:])]:
        first = markers.first[i]
        key = values[:, first : first + 3].tobytes()
        if len(values) and key in seen:
            found |= {first + axis: seen[key] + axis for axis in range(3)}
        else:
            seen[key] = first
    return found


def filled_of(markers: Markers, values: Array) -> tuple[Array, NDArray[np.uint8]]:
    """Give values that are finite everywhere, and which must come back as they are, (F, C).

    The place of a marker that is missing is taken from the frames around.
    """
    kept = kept_of(markers, values)
    filled = np.array(values)
    for column in np.flatnonzero(kept.any(axis=0)):
        there = np.flatnonzero(~kept[:, column])
        if len(there):
            frames = np.arange(len(values))
            filled[:, column] = np.interp(frames, there, values[there, column])
        else:
            filled[:, column] = 0.0
    return filled, kept.astype(np.uint8)
