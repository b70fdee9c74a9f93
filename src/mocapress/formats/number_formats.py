"""Finding the number format of every column from how its numbers are written."""

from collections import Counter
from collections.abc import Sequence
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import UnsupportedError
from mocapress.formats.rows import merged_statistics
from mocapress.motion.number_format import NumberFormat, NumberKind
from mocapress.records import Reader, Writer

SHORTEST = NumberFormat(NumberKind.SHORTEST)
"""How numbers are printed that were never text."""
_MOST_DIGITS = 40
_MOST_EXPONENT_DIGITS = 8
# Of a time or a rate that a header states: digits, and digits before or behind the point.
_STATED_DIGITS, _STATED_SIZE = 100, 18


def packed(formats: tuple[NumberFormat, ...]) -> NDArray[np.uint8]:
    """Give formats as the compiled core takes them: (C, 6) uint8."""
    rows = [
        (f.kind, f.digits, f.exponent_digits, f.point_zero, f.bare_point, f.upper) for f in formats
    ]
    return np.array(rows, dtype=np.uint8).reshape(len(formats), 6)


def detect(
    statistics: NDArray[np.uint8],
    sample: NDArray[np.float64],
    texts: Sequence[Sequence[bytes | None]],
) -> tuple[NumberFormat, ...]:
    """Choose a format per column.

    Parameters
    ----------
    statistics
        (C, 8), see ``rows.Body``.
    sample
        (R, C), some rows.
    texts
        How these are written: R lists of C texts, None where the row has no such number.

    The format that fits most columns is preferred, so that files come out with few formats.

    """
    columns = statistics.shape[0]
    theirs = [text for row in texts for text in row[:columns]]

    def misses(candidate: NumberFormat) -> NDArray[np.int64]:
        """Count the numbers of each column that are written otherwise, (C,)."""
        ours = printed(sample.ravel(), candidate)
        if ours == theirs:
            return np.zeros(columns, np.int64)
        wrong = [b is not None and a != b for a, b in zip(ours, theirs, strict=True)]
        counts: NDArray[np.int64] = np.array(wrong, np.int64).reshape(-1, columns).sum(axis=0)
        return counts

    for candidate in _candidates(merged_statistics(statistics)):
        if not misses(candidate).any():
            return tuple(candidate for _ in range(columns))
    candidates = list(
        dict.fromkeys(
            candidate
            for row in [merged_statistics(statistics), *np.unique(statistics, axis=0)[:64]]
            for candidate in _candidates(row)
        )
    )
    counts = np.array([misses(candidate) for candidate in candidates])
    votes = Counter[int]()
    for c in range(columns):
        votes.update(np.flatnonzero(counts[:, c] == counts[:, c].min()).tolist())
    order = sorted(range(len(candidates)), key=lambda i: (-votes[i], i))
    return tuple(candidates[min(order, key=lambda i: counts[i, c])] for c in range(columns))


def write_format(writer: Writer, f: NumberFormat) -> None:
    """Append a format as a record (docs/format/layout.md, section "Number formats")."""
    flags = f.point_zero | f.bare_point << 1 | f.upper << 2
    writer.data += bytes((f.kind, f.digits, f.exponent_digits, flags))


def read_format(reader: Reader) -> NumberFormat:
    """Take a format."""
    kind, digits, exponent_digits, flags = reader.raw(4)
    if (
        kind > max(NumberKind)
        or digits > _MOST_DIGITS
        or exponent_digits > _MOST_EXPONENT_DIGITS
        or flags > 7
        or (kind == NumberKind.GENERAL and not 1 <= digits <= 17)
    ):
        raise reader.fail("no such number format")
    zero, bare, upper = bool(flags & 1), bool(flags & 2), bool(flags & 4)
    return NumberFormat(NumberKind(kind), digits, exponent_digits, zero, bare, upper)


def printed(
    values: NDArray[np.float64] | Sequence[float], number_format: NumberFormat
) -> list[bytes]:
    """Print values, (N,), in a format."""
    column = np.array(values, np.float64).reshape(-1, 1)
    text: bytes = _core.print_rows(
        column,
        np.empty(0, np.int64),
        np.zeros(len(values), np.int32),
        [(False, [b"", b"\n"], [0], [0])],
        packed((number_format,)),
        np.empty(0, np.uint64),
        np.empty(0, np.uint32),
        [],
        [],
        2**62,
    )
    return text.split(b"\n")[:-1]


def to_state(number: Decimal) -> str:
    """Print a time or a rate for a header.

    Raises
    ------
    UnsupportedError
        When it is absurd, so that it would not be read again.

    """
    if not _is_usual(number):
        raise UnsupportedError(
            "frame time", expected=f"1e-{_STATED_SIZE} to 1e{_STATED_SIZE}", found=f"{number:.6g}"
        )
    return f"{number:f}"


def _is_usual(number: Decimal) -> bool:
    # Whatever is done with others would take time and memory without end.
    usual = number.is_finite() and abs(number.adjusted()) < _STATED_SIZE
    return usual and len(number.as_tuple().digits) <= _STATED_DIGITS and number >= 0


def _candidates(row: NDArray[np.uint8]) -> list[NumberFormat]:
    least, most, significant, exponent_digits, trailing, whole, bare, upper = (int(x) for x in row)
    most = min(most, 40)
    style = {
        "exponent_digits": min(max(exponent_digits, 2), 8) if exponent_digits else 2,
        "bare_point": bool(bare),
        "upper": bool(upper),
    }
    kinds: list[tuple[NumberKind, int, bool]] = []
    if least >= most:
        kinds.append((NumberKind.FIXED, most, False))
    point_zero = bool(trailing) and not whole
    if not trailing or point_zero:
        kinds += [
            (NumberKind.GENERAL, digits, point_zero)
            for digits in sorted({max(significant, 1), 6})
            if significant <= digits <= 17
        ]
        kinds += [
            (NumberKind.TRIMMED, most, point_zero),
            (NumberKind.SHORTEST, 0, point_zero),
            (NumberKind.SHORTEST32, 0, point_zero),
        ]
    if least < most:
        kinds.append((NumberKind.FIXED, most, False))
    if exponent_digits and 0 < significant <= 41:
        kinds.append((NumberKind.SCIENTIFIC, significant - 1, False))
    return [NumberFormat(kind, digits, point_zero=pz, **style) for kind, digits, pz in kinds]  # type: ignore[arg-type]
