"""Integers, byte strings and runs of the format's records (docs/format.md, "Conventions")."""

import struct


class CorruptError(Exception):
    """The file is not what the specification allows."""


class Record:
    """Fields that stand one behind the other."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def raw(self, count: int) -> bytes:
        """Take so many bytes."""
        if count > len(self.data) - self.at:
            raise CorruptError("a record is cut off")
        self.at += count
        return self.data[self.at - count : self.at]

    def integer(self) -> int:
        """Take an unsigned LEB128 number."""
        value = shift = 0
        while True:
            (byte,) = self.raw(1)
            value |= (byte & 127) << shift
            if byte < 128:
                return value
            shift += 7

    def signed(self) -> int:
        """Take a signed number."""
        return unzigzag(self.integer())

    def double(self) -> float:
        """Take a binary64 number."""
        return float(struct.unpack("<d", self.raw(8))[0])

    def bytes(self) -> bytes:
        """Take a length and so many bytes."""
        return self.raw(self.integer())

    def text(self) -> str:
        """Take UTF-8."""
        return self.bytes().decode()

    def numbers(self, count: int) -> list[float]:
        """Take so many numbers of so many decimals, or doubles."""
        decimals, found = self.integer(), list[float]()
        for _ in range(count):
            k = self.integer()
            number = (k - 1 >> 1) / 10.0**decimals if k else self.double()
            found.append(-number if k and k % 2 == 0 else number)
        return found

    def list_in_runs(self, count: int) -> list[int]:
        """Take a list of so many numbers: value, how often, until all are there."""
        values: list[int] = []
        while len(values) < count:
            value = self.integer()
            values += [value] * self.integer()
        if len(values) != count:
            raise CorruptError("runs longer than their list")
        return values

    def end(self) -> None:
        """See that nothing is left."""
        if self.at != len(self.data):
            raise CorruptError("bytes are left over behind a record")


def unzigzag(value: int) -> int:
    """Give the signed number: 0, 1, 2, 3 are 0, -1, 1, -2."""
    return value >> 1 if value % 2 == 0 else -(value + 1 >> 1)
