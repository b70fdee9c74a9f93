"""What a coupling is, the order of columns that it asks for, and its place in the header."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum

from mocapress.records import Reader, Writer

_JOINT_PARAMETERS = 7
_JOINT_SHAPES = 243
_MOST_BITS = 40
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


_MOST_SOURCES, _MOST_TARGETS = 6, 3
_SHAPES = {
    CouplingKind.SPINE: (6, 3),
    CouplingKind.NECK: (6, 3),
    CouplingKind.THUMB: (2, 2),
    CouplingKind.OTHER_THUMB: (2, 2),
    CouplingKind.SPINE_MIDDLE: (5, 1),
    CouplingKind.NECK_MIDDLE: (5, 1),
}
"""Sources and targets of the laws."""


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
    def ordered(self) -> tuple[int, ...]:
        """The columns that are coded in this order, at the places that they have together."""
        if self.kind is CouplingKind.POLYNOMIAL:
            return ()
        if self.kind is CouplingKind.JOINT:
            return (*self.sources, *self.targets)
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
        involved = (*coupling.sources, *coupling.targets)
        if (
            targets & taken
            or any(len(touching[column]) == _MOST_TOUCHING for column in involved)
            or len({places[column] // _TOGETHER for column in involved}) > 1
            or max(places[column] for column in involved) >= _MOST_PLACES
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
            for column in involved:
                touching[column].append(coupling)
        else:
            places.update(before)
    return sorted(places, key=places.__getitem__), kept


def _stands(coupling: Coupling, places: dict[int, int]) -> bool:
    """Tell whether a coupling's columns are coded in its order, the sources before the targets."""
    ordered = [places[column] for column in coupling.ordered]
    sources, targets = ([places[c] for c in side] for side in (coupling.sources, coupling.targets))
    return ordered == sorted(ordered) and max(sources) < min(targets)


def write_coupling(writer: Writer, coupling: Coupling) -> None:
    """Append a coupling to a codec header."""
    writer.integer(coupling.kind)
    for side in (coupling.sources, coupling.targets):
        writer.integer(len(side))
        for column in side:
            writer.integer(column)
    for parameter in coupling.parameters:
        writer.signed(parameter)


def read_coupling(reader: Reader, columns: int) -> Coupling:
    """Take a coupling of a clip of so many columns.

    Raises
    ------
    CorruptError
        When there is no such coupling.

    """
    kind = CouplingKind(reader.integer(max(CouplingKind)))
    sources, targets = (
        tuple(reader.integer(columns - 1) for _ in range(reader.count())) for _ in range(2)
    )
    if len({*sources, *targets}) < len(sources) + len(targets) or not _has_shape(
        kind, len(sources), len(targets)
    ):
        raise reader.fail("a coupling of impossible shape")
    parameters: tuple[int, ...] = ()
    if kind is CouplingKind.JOINT:
        parameters = tuple(reader.signed() for _ in range(_JOINT_PARAMETERS))
        if not (0 <= parameters[0] < 9 * _JOINT_SHAPES and 0 <= parameters[1] <= _MOST_BITS):
            raise reader.fail("a joint of impossible shape")
    return Coupling(kind, sources, targets, parameters)


def _has_shape(kind: CouplingKind, sources: int, targets: int) -> bool:
    if kind is CouplingKind.POLYNOMIAL:
        return 1 <= sources <= _MOST_SOURCES and 1 <= targets <= _MOST_TARGETS
    if kind is CouplingKind.JOINT:
        return 1 <= sources <= 2 and targets == 1
    return (sources, targets) == _SHAPES[kind]
