"""Reading and writing the small binary records of which the files of mocapress are made.

Integers are unsigned LEB128 (seven bits a byte, lowest first) unless said otherwise; byte strings
are their length and their bytes. A reader never goes past its data and never believes a length.
docs/format.md, section "Conventions", has all of them.
"""

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError, UnsupportedError

_MOST_DECIMALS = 15


class Ranges(Protocol):
    """A file of which parts are read."""

    @property
    def size(self) -> int:
        """Number of bytes."""
        ...

    def read(self, start: int = 0, stop: int | None = None) -> bytes:
        """Give bytes [start, stop), or as many of them as there are."""
        ...


@dataclass(frozen=True, slots=True)
class Held:
    """Bytes in memory, as a file of which parts are read."""

    data: bytes

    @property
    def size(self) -> int:
        """Number of bytes."""
        return len(self.data)

    def read(self, start: int = 0, stop: int | None = None) -> bytes:
        """Give bytes [start, stop), or as many of them as there are."""
        return self.data[start:stop]


class Writer:
    """Collects fields."""

    def __init__(self) -> None:
        self.data = bytearray()

    def integer(self, value: int) -> None:
        """Append an unsigned integer."""
        while value > 0x7F:
            self.data.append(value & 0x7F | 0x80)
            value >>= 7
        self.data.append(value)

    def signed(self, value: int) -> None:
        """Append a signed integer, zigzag: 0, -1, 1, -2, ... become 0, 1, 2, 3, ..."""
        self.integer(value << 1 if value >= 0 else (-value << 1) - 1)

    def bytes(self, value: bytes) -> None:
        """Append a length and that many bytes."""
        self.integer(len(value))
        self.data += value

    def text(self, value: str) -> None:
        """Append a text in UTF-8."""
        try:
            self.bytes(value.encode())
        except UnicodeEncodeError:
            raise UnsupportedError("a text that is not Unicode", found=ascii(value)) from None

    def double(self, value: float) -> None:
        """Append a float64."""
        self.data += struct.pack("<d", value)

    def runs(self, values: Sequence[int] | NDArray[np.int64]) -> None:
        """Append a list of whole numbers in which equal neighbours stand together."""
        listed = np.asarray(values, np.int64)
        starts = np.flatnonzero(np.diff(listed, prepend=listed[:1] - 1))
        for value, count in zip(
            listed[starts].tolist(), np.diff(starts, append=len(listed)).tolist(), strict=True
        ):
            self.integer(value)
            self.integer(count)

    def text_runs(self, values: Iterable[str]) -> None:
        """Append a list of texts in which equal neighbours stand together."""
        for value, run in groupby(values):
            self.text(value)
            self.integer(sum(1 for _ in run))

    def numbers(self, values: Sequence[float]) -> None:
        """Append float64 numbers, those with few decimals as whole numbers of their last place."""
        listed = np.array(values, np.float64)
        decimals, whole, fits = _decimals(listed)
        self.integer(decimals)
        negative = np.signbit(listed)
        for value, m, s, fit in zip(
            values, whole.tolist(), negative.tolist(), fits.tolist(), strict=True
        ):
            if fit:
                self.integer(2 * m + s + 1)
            else:
                self.integer(0)
                self.double(value)


class Reader:
    """Takes fields off, in order; ``section`` names the data in errors."""

    def __init__(self, data: bytes | memoryview, section: str) -> None:
        self.data = memoryview(data)
        self.section = section
        self.position = 0

    def fail(self, what: str) -> CorruptError:
        """Give the error that says what is wrong here."""
        return CorruptError(f"{self.section}: {what}", offset=self.position)

    @property
    def left(self) -> int:
        """Number of bytes that have not been taken."""
        return len(self.data) - self.position

    def raw(self, count: int) -> bytes:
        """Take that many bytes."""
        taken = bytes(self.data[self.position : self.position + count])
        if len(taken) < count:
            raise self.fail(f"{count} bytes announced, {self.left} left")
        self.position += count
        return taken

    def integer(self, most: int = 2**63 - 1) -> int:
        """Take an unsigned integer of at most ``most``."""
        value = shift = 0
        try:
            # Most take one byte.
            while (byte := self.data[self.position]) >= 0x80:
                self.position += 1
                value |= (byte & 0x7F) << shift
                shift += 7
                if shift > most.bit_length():
                    raise self.fail("integer too long")
        except IndexError:
            raise self.fail("an integer cut off") from None
        self.position += 1
        value |= byte << shift
        if value > most:
            raise self.fail(f"{value} where at most {most} may stand")
        return value

    def signed(self) -> int:
        """Take a signed integer."""
        value = self.integer(2**64 - 1)
        return value >> 1 if value & 1 == 0 else -((value + 1) >> 1)

    def count(self, least_bytes: int = 1) -> int:
        """Take the number of records that follow, of at least so many bytes each."""
        return self.integer((self.left) // least_bytes)

    def bytes(self) -> bytes:
        """Take a length and that many bytes."""
        return self.raw(self.integer())

    def text(self) -> str:
        """Take a text."""
        try:
            return self.bytes().decode()
        except UnicodeDecodeError:
            raise self.fail("not a text") from None

    def double(self) -> float:
        """Take a float64."""
        value: float = struct.unpack("<d", self.raw(8))[0]
        return value

    def runs(self, count: int, most: int) -> NDArray[np.int64]:
        """Take a list of so many whole numbers of at most ``most``, (count,) int64."""
        values, counts = [], []
        left = count
        while left:
            values.append(self.integer(most))
            counts.append(self._run(left))
            left -= counts[-1]
        return np.repeat(np.array(values, np.int64), np.array(counts, np.int64))

    def text_runs(self, count: int) -> list[str]:
        """Take a list of so many texts."""
        values: list[str] = []
        while len(values) < count:
            value = self.text()
            values += [value] * self._run(count - len(values))
        return values

    def _run(self, most: int) -> int:
        run = self.integer(most)
        if run == 0:
            raise self.fail("an empty run")
        return run

    def numbers(self, count: int) -> list[float]:
        """Take so many float64 numbers."""
        scale = float(10 ** self.integer(_MOST_DECIMALS))
        values = []
        for _ in range(count):
            k = self.integer(2**54) - 1
            magnitude = (k >> 1) / scale
            values.append(self.double() if k < 0 else -magnitude if k & 1 else magnitude)
        return values

    def end(self) -> None:
        """See that nothing is left."""
        if self.position != len(self.data):
            raise self.fail(f"{self.left} bytes too many")


def _decimals(
    values: NDArray[np.float64],
) -> tuple[int, NDArray[np.int64], NDArray[np.bool_]]:
    """Find the fewest decimals with which most numbers are whole numbers of the last place."""
    best = 0, np.zeros(len(values), np.int64), np.zeros(len(values), np.bool_)
    # No number this large has decimals; infinities and NaN are none of ours.
    magnitudes = np.abs(values)
    magnitudes[~(magnitudes < 2.0**53)] = np.nan
    for decimals in range(_MOST_DECIMALS + 1):
        scaled = magnitudes * float(10**decimals)
        fits = scaled < 2.0**53
        whole = np.rint(np.where(fits, scaled, 0.0))
        fits &= whole / float(10**decimals) == magnitudes
        if decimals == 0 or fits.sum() > best[2].sum():
            best = decimals, whole.astype(np.int64), fits
        if fits.all():
            break
    return best
