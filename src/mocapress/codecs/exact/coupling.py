"""What a coupling is, the order of columns that it asks for, and its place in the header."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum

from mocapress.records import Writer

_JOINT_AXES, _JOINT_TURNS = 27, 9
_JOINT_SHAPES = _JOINT_AXES * _JOINT_TURNS
_JOINT_BITS = range(0, 41, 4)
_JOINT_NUMBERS = 5
_TOGETHER = 1024
"""The compiled coder codes so many columns on their own."""
_MOST_PLACES = 1 << 16
"""It has couplings of so many columns."""
_MOST_TOUCHING = 12
"""Couplings that one column may be in; bounds the work that a forged header asks for."""


class CouplingKind(IntEnum):
    """By what the targets of a coupling follow from its sources; core/exact/law.hpp, joint.hpp."""

    POLYNOMIAL = 0
    SPINE = 1
    NECK = 2
    THUMB = 3
    OTHER_THUMB = 4
    JOINT = 5
    SPINE_MIDDLE = 6
    NECK_MIDDLE = 7


_CHAIN = ((0, 1, 2, 3, 4, 5), (7, 6, 8))
_MIDDLE = ((0, 1, 2, 3, 5), (4,))
_THUMB = ((0, 1), (2, 3))
_LAWS = {
    CouplingKind.SPINE: _CHAIN,
    CouplingKind.NECK: _CHAIN,
    CouplingKind.THUMB: _THUMB,
    CouplingKind.OTHER_THUMB: _THUMB,
    CouplingKind.SPINE_MIDDLE: _MIDDLE,
    CouplingKind.NECK_MIDDLE: _MIDDLE,
}
"""Sources and targets of the laws where all joints stand one behind the other."""


@dataclass(frozen=True, slots=True)
class Coupling:
    """Columns that are a function of others in the same frame."""

    kind: CouplingKind
    sources: tuple[int, ...]
    targets: tuple[int, ...]
    """In the order in which they are coded; all behind the sources."""
    parameters: tuple[int, ...] = ()
    """Of a joint: shape, bits, and u, v, c as multiples of 2^-bits, a one left out of u and v."""

    @property
    def columns(self) -> tuple[int, ...]:
        """Sources and targets."""
        return (*self.sources, *self.targets)

    @property
    def ordered(self) -> tuple[int, ...]:
        """The columns that are coded in this order, at the places that they have together."""
        if self.kind is CouplingKind.POLYNOMIAL:
            return ()
        if self.kind is CouplingKind.JOINT:
            return self.columns
        if self.kind in (CouplingKind.SPINE_MIDDLE, CouplingKind.NECK_MIDDLE):
            return (*self.sources[3:], *self.targets)
        return self.targets

    def numbers(self) -> list[float]:
        """Give the parameters of a joint as core/exact/joint.hpp has them."""
        if not self.parameters:
            return []
        shape, bits, *multiples = self.parameters
        ones, shape = divmod(shape, _JOINT_SHAPES)
        numbers = [multiple / 2**bits for multiple in multiples]
        numbers.insert(ones % 3, 1.0)
        numbers.insert(3 + ones // 3, 1.0)
        return [float(shape), *numbers]


def arrange(
    columns: Sequence[int], couplings: Iterable[Coupling]
) -> tuple[list[int], list[Coupling]]:
    """Give columns in the order that couplings ask for, and those couplings that can stand in it.

    Each coupling in turn puts its columns in order, at the places that they have together. It is
    left out where a source would then stand behind a target, its own or an earlier coupling's;
    where a column would follow from two laws, or from two polynomials, or be in more than 12
    couplings; and where its columns lie in different parts of 1024, or behind the first 65,536.
    """
    places = {column: place for place, column in enumerate(columns)}
    touching: dict[int, list[Coupling]] = defaultdict(list)
    taken: set[tuple[bool, int]] = set()
    kept: list[Coupling] = []
    for coupling in couplings:
        targets = {(coupling.kind is CouplingKind.POLYNOMIAL, c) for c in coupling.targets}
        if (
            targets & taken
            or any(len(touching[column]) == _MOST_TOUCHING for column in coupling.columns)
            or len({places[column] // _TOGETHER for column in coupling.columns}) > 1
            or max(places[column] for column in coupling.columns) >= _MOST_PLACES
        ):
            continue
        moved = coupling.ordered
        before = {column: places[column] for column in moved}
        places.update(zip(moved, sorted(before.values()), strict=True))
        if all(_stands(other, places) for c in moved for other in touching[c]) and _stands(
            coupling, places
        ):
            kept.append(coupling)
            taken |= targets
            for column in coupling.columns:
                touching[column].append(coupling)
        else:
            places.update(before)
    return sorted(places, key=places.__getitem__), kept


def _stands(coupling: Coupling, places: dict[int, int]) -> bool:
    """Tell whether a coupling's columns are coded in its order, the sources before the targets."""
    ordered = [places[column] for column in coupling.ordered]
    sources, targets = ([places[c] for c in side] for side in (coupling.sources, coupling.targets))
    return ordered == sorted(ordered) and max(sources) < min(targets)


def write_couplings(writer: Writer, couplings: Sequence[Coupling]) -> None:
    """Append couplings to a codec header."""
    writer.integer(len(couplings))
    for coupling in couplings:
        offsets = _offsets(coupling)
        first = coupling.sources[0] - offsets[0]
        adjacent = coupling.columns == tuple(first + offset for offset in offsets)
        writer.integer(2 * coupling.kind + (not adjacent))
        if coupling.kind is CouplingKind.POLYNOMIAL:
            writer.integer(len(coupling.sources))
            writer.integer(len(coupling.targets))
        elif coupling.kind is CouplingKind.JOINT:
            _write_joint(writer, coupling)
        for column in (first,) if adjacent else coupling.columns:
            writer.integer(column)


def _offsets(coupling: Coupling) -> tuple[int, ...]:
    """Give the columns of a coupling of this shape whose joints stand one behind the other."""
    if coupling.kind is CouplingKind.POLYNOMIAL:
        return tuple(range(len(coupling.columns)))
    if coupling.kind is CouplingKind.JOINT:
        source, target = divmod(coupling.parameters[0] // _JOINT_AXES % _JOINT_TURNS, 3)
        return (*(source, 3 - source - target)[: len(coupling.sources)], target)
    sources, targets = _LAWS[coupling.kind]
    return sources + targets


def _write_joint(writer: Writer, coupling: Coupling) -> None:
    shape, bits, *multiples = coupling.parameters
    given = sum((multiple != 0) << i for i, multiple in enumerate(multiples))
    told = (2 * shape + len(coupling.sources) - 1) * len(_JOINT_BITS) + _JOINT_BITS.index(bits)
    writer.integer(told * 2**_JOINT_NUMBERS + given)
    for multiple in filter(None, multiples):
        writer.signed(multiple)
