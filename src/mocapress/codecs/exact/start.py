"""What the codec starts from: nothing, or what it had learned by the end of other clips."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.contract import Model
from mocapress.records import Reader, Writer

Learned = tuple[list[float], list[list[float]]]
"""As the compiled coder has it: by all columns, and by each of the coded columns."""

_MANTISSA = np.uint32(0xFFFFF000)
_LARGEST = 1e29
_MOST_COLUMNS = 2**18
"""As many as a file may have: docs/format.md, "Limits"."""


@dataclass(slots=True)
class Start:
    """What was learned, by columns of the clip."""

    shared: list[float] = field(default_factory=list)
    columns: dict[int, list[float]] = field(default_factory=dict)

    def of(self, coded: Sequence[int]) -> Learned:
        """Hand it to a coder of these columns."""
        return self.shared, [self.columns.get(column, []) for column in coded]

    def take(self, coded: Sequence[int], learned: Learned) -> None:
        """Take it over from a coder of these columns."""
        self.shared = learned[0]
        self.columns.update(zip(coded, learned[1], strict=True))


def model_of(codec: str, level: int, start: Start) -> Model:
    """Give the model of what a level learned, its numbers rounded to eleven binary digits."""
    writer = Writer()
    writer.integer(level)
    _write(writer, start.shared)
    writer.integer(len(start.columns))
    for column, numbers in sorted(start.columns.items()):
        writer.integer(column)
        _write(writer, numbers)
    return Model(codec, bytes(writer.data))


def start_of(model: Model | None) -> Start:
    """Give the start of a model.

    Raises
    ------
    CorruptError
        When the model's payload is not what ``model_of`` makes.

    """
    if model is None:
        return Start()
    reader = Reader(model.payload, "exact model")
    _level(reader)
    shared = _read(reader)
    columns = {reader.integer(): _read(reader) for _ in range(reader.integer(_MOST_COLUMNS))}
    reader.end()
    return Start(shared, columns)


def level_of(model: Model) -> int:
    """Give the level at which a model was learned.

    Raises
    ------
    CorruptError
        When the model's payload is not what ``model_of`` makes.

    """
    return _level(Reader(model.payload, "exact model"))


def _level(reader: Reader) -> int:
    level = reader.integer(9)
    if level == 0:
        raise reader.fail("a level that there is not")
    return level


def _write(writer: Writer, numbers: Sequence[float]) -> None:
    """Append a list; what was learned from numbers that no motion has may be of no use."""
    with np.errstate(over="ignore"):
        learned = np.array(numbers, dtype="<f4")
    bits = learned.view("<u4") if _usable(learned) else np.empty(0, "<u4")
    writer.bytes((bits & _MANTISSA).tobytes())


def _usable(numbers: NDArray[np.float32]) -> bool:
    return bool((np.abs(numbers) <= _LARGEST).all())


def _read(reader: Reader) -> list[float]:
    data = reader.bytes()
    if len(data) % 4:
        raise reader.fail("a list of numbers cut off")
    numbers: NDArray[np.float32] = np.frombuffer(data, dtype="<f4")
    if not _usable(numbers):
        raise reader.fail("numbers that were not learned")
    return [float(number) for number in numbers]
