"""What each column is to the codec, found once per clip."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.exact.coupling import Coupling, arrange

_NOISE = 1e-10
_USUAL_MOVE = -3
EXPONENT_STEP = 8
_MOVES = 300
MOST_EXPONENT = 1000
_HALF_TURN = 180
_JUMP = 300


class Role(IntEnum):
    """How a column is coded."""

    PREDICTED = 0
    CONSTANT = 1
    """The same bits in every row; they stand in the header."""
    COPY = 2
    """The bits of an earlier column."""
    NOISE = 3
    """Rounding noise: more than half of the numbers are below 1e-10 but not 0."""


@dataclass(frozen=True, slots=True)
class Roles:
    """What the compiled coder is told, and how its columns make up the clip's."""

    roles: tuple[Role, ...]
    originals: tuple[int, ...]
    """Per column: which column it copies; its own index where it copies none."""
    lines: tuple[tuple[int, int], ...]
    """Per column: line of numbers and digits, of core/numbers/line.hpp."""
    exponents: tuple[int, ...]
    """Per column: numbers times 2^exponent are about as large as angles in degrees."""
    turns: tuple[int, ...]
    """Per column: 1 or 2 for degrees from -180 or 0 on that jump by whole turns, else 0."""
    couplings: tuple[Coupling, ...]
    skeleton: int
    """The known skeleton whose channels the columns are, of skeletons.py, or NONE."""
    constants: tuple[float, ...]
    """Values of the constant columns."""

    def of(self, *roles: Role) -> list[int]:
        """Give the columns of some roles, role by role."""
        return [c for role in roles for c, own in enumerate(self.roles) if own is role]

    @property
    def coded(self) -> list[int]:
        """The columns that chunks hold, in the order of the compiled coder: noise comes last."""
        predicted, _ = arrange(self.of(Role.PREDICTED), self.couplings)
        return predicted + self.of(Role.NOISE)

    def coupled(
        self, columns: Sequence[int]
    ) -> list[tuple[int, list[int], list[int], list[float]]]:
        """Give the couplings as the compiled coder has them, in places among its columns."""
        place = {column: i for i, column in enumerate(columns)}
        return [
            (
                coupling.kind,
                [place[c] for c in coupling.sources],
                sorted(place[c] for c in coupling.targets),
                coupling.numbers(),
            )
            for coupling in self.couplings
        ]

    def plan(self, columns: Sequence[int]) -> NDArray[np.int32]:
        """Give the plan of columns for the compiled coder, (n, 6): see core/exact/codec.hpp."""
        rows = [
            (
                *self.lines[c],
                self.roles[c] is Role.NOISE,
                self.exponents[c],
                self.turns[c],
                c if self.skeleton else -1,
            )
            for c in columns
        ]
        return np.array(rows, dtype=np.int32).reshape(-1, 6)


def find_roles(
    values: NDArray[np.float64],
    couple: Callable[[list[int], Sequence[tuple[int, int]]], list[Coupling]],
    *,
    skeleton: int = 0,
) -> Roles:
    """Find the role of each column of (F, C) values; ``couple`` finds couplings of columns."""
    bits = values.view(np.uint64)
    constant = (bits == bits[:1]).all(axis=0)
    noise = ((np.abs(values) < _NOISE) & (values != 0)).mean(axis=0) > 1 / 2
    roles, originals = [], list(range(values.shape[1]))
    first: dict[bytes, int] = {}
    for column in range(values.shape[1]):
        role = Role.NOISE if noise[column] else Role.PREDICTED
        if constant[column]:
            role = Role.CONSTANT
        else:
            originals[column] = first.setdefault(bits[:, column].tobytes(), column)
            role = role if originals[column] == column else Role.COPY
        roles.append(role)
    lines = _core.exact_lines(values)
    predicted = [c for c, role in enumerate(roles) if role is Role.PREDICTED]
    return Roles(
        tuple(roles),
        tuple(originals),
        tuple(lines),
        tuple(_exponents(values, roles)),
        tuple(_turns(values, roles)),
        tuple(arrange(predicted, couple(predicted, lines))[1]),
        skeleton,
        tuple(values[0, constant].tolist()),
    )


def _turns(values: NDArray[np.float64], roles: Sequence[Role]) -> Iterator[int]:
    """Tell which columns are angles in degrees that jump at the ends of their range."""
    lows, highs = values.min(axis=0), values.max(axis=0)
    for column, (low, high) in enumerate(zip(lows, highs, strict=True)):
        wide = low >= -_HALF_TURN and low + _JUMP < high <= low + 2 * _HALF_TURN
        if not wide or roles[column] is not Role.PREDICTED:
            yield 0
        elif (np.abs(np.diff(values[:, column])) > _JUMP).any():
            yield 2 if low >= 0 else 1 if high <= _HALF_TURN else 0
        else:
            yield 0


def _exponents(values: NDArray[np.float64], roles: Sequence[Role]) -> list[int]:
    """Give the powers of two, in whole steps of 2^8, that make the usual moves about 1/8."""
    every = len(values) // _MOVES + 1
    with np.errstate(invalid="ignore", over="ignore"):
        moves = np.abs(values[1::every] - values[:-1:every])
    moving = np.isfinite(moves) & (moves > 0)
    count = moving.sum(axis=0)
    known = (count > 0) & np.array([role is Role.PREDICTED for role in roles], bool)
    if not known.any():
        return [0] * len(roles)
    # The median of those that move: they stand before the others.
    ordered = np.sort(np.where(moving, moves, np.inf)[:, known], axis=0)
    middles = np.stack([(count[known] - 1) // 2, count[known] // 2])
    with np.errstate(over="ignore"):
        usual = np.frexp(np.take_along_axis(ordered, middles, axis=0).mean(axis=0))[1]
    steps = np.rint((_USUAL_MOVE - usual) / EXPONENT_STEP).astype(int) * EXPONENT_STEP
    exponents = np.zeros(len(roles), int)
    exponents[known] = np.clip(steps, -MOST_EXPONENT, MOST_EXPONENT)
    return [int(exponent) for exponent in exponents]
