"""Reading and writing the small binary records of the container and its parts.

Integers are unsigned LEB128 (seven bits a byte, lowest first) unless said otherwise; byte strings
are their length and their bytes. A reader never goes past its data and never believes a length.
"""

from mocapress.errors import CorruptError


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


class Reader:
    """Takes fields off, in order; ``section`` names the data in errors."""

    def __init__(self, data: bytes | memoryview, section: str) -> None:
        self.data = memoryview(data)
        self.section = section
        self.position = 0

    def fail(self, what: str) -> CorruptError:
        """Give the error that says what is wrong here."""
        return CorruptError(f"{self.section}: {what}", offset=self.position)

    def raw(self, count: int) -> bytes:
        """Take that many bytes."""
        if count > len(self.data) - self.position:
            raise self.fail(f"{count} bytes announced, {len(self.data) - self.position} left")
        self.position += count
        return bytes(self.data[self.position - count : self.position])

    def integer(self, most: int = 2**63 - 1) -> int:
        """Take an unsigned integer of at most ``most``."""
        value = shift = 0
        while True:
            byte = self.raw(1)[0]
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                break
            shift += 7
            if shift > 63:
                raise self.fail("integer too long")
        if value > most:
            raise self.fail(f"{value} where at most {most} may stand")
        return value

    def signed(self) -> int:
        """Take a signed integer."""
        value = self.integer(2**64 - 1)
        return value >> 1 if value & 1 == 0 else -((value + 1) >> 1)

    def count(self, least_bytes: int = 1) -> int:
        """Take the number of records that follow, of at least so many bytes each."""
        return self.integer((len(self.data) - self.position) // least_bytes)

    def bytes(self) -> bytes:
        """Take a length and that many bytes."""
        return self.raw(self.integer())

    def end(self) -> None:
        """See that nothing is left."""
        if self.position != len(self.data):
            raise self.fail(f"{len(self.data) - self.position} bytes too many")
