"""Coded streams: the range coder beside raw bits, and the intervals of the fast levels."""

import struct

from records import CorruptError, Record


class Bit:
    """How likely a bit is 0, in 1/65536, learned at two rates."""

    def __init__(self, chance: int = 32768) -> None:
        self.fast = self.slow = chance

    def chance_of_zero(self) -> int:
        """Give the chance by which the bit is coded."""
        return (self.fast + self.slow) >> 1

    def learn(self, one: bool) -> None:
        """Follow a bit."""
        self.fast += ((15 if one else 65520 + 2**4) - self.fast) >> 4
        self.slow += ((15 if one else 65520 + 2**7) - self.slow) >> 7


def tree(bits: int, chances: list[int] | None = None) -> list[Bit]:
    """Make the models of a symbol; the first is not used."""
    return [Bit(chance) for chance in chances or [32768] * 2**bits]


class Coded:
    """A coded stream: size of the coded part, coded part, raw part."""

    def __init__(self, payload: bytes) -> None:
        record = Record(payload)
        self.coded = record.bytes()
        self.bits = payload[record.at :]
        self.read = self.raw_read = 0
        self.range = 2**64 - 1
        self.code = self._word() << 32 | self._word()

    def _word(self) -> int:
        self.read += 4
        return int.from_bytes(self.coded[self.read - 4 : self.read].ljust(4, b"\0"), "big")

    def _narrow(self, start: int, size: int) -> None:
        self.code -= start
        self.range = size
        if self.range < 2**32:
            self.code = self.code << 32 | self._word()
            self.range <<= 32

    def chance(self, of_zero: int) -> bool:
        """Take a bit whose chance of a 0 is told."""
        bound = (self.range >> 16) * of_zero
        one = self.code >= bound
        self._narrow(bound if one else 0, self.range - bound if one else bound)
        return one

    def bit(self, model: Bit) -> bool:
        """Take a bit by a model, which learns."""
        one = self.chance(model.chance_of_zero())
        model.learn(one)
        return one

    def uniform(self, count: int) -> int:
        """Take one of so many numbers, up to 2^17, all equally likely."""
        each = self.range // count
        value = self.code // each
        self._narrow(each * value, each)
        return value

    def one_of(self, count: int) -> int:
        """Take one of so many numbers; of many, the lowest bits are raw."""
        if count < 2:
            return 0
        low = max((count - 1).bit_length() - 16, 0)
        high = self.uniform((count - 1 >> low) + 1)
        return high << low | self.raw(low)

    def raw(self, count: int) -> int:
        """Take so many raw bits."""
        start, self.raw_read = self.raw_read, self.raw_read + count
        held = int.from_bytes(self.bits[start // 8 : (self.raw_read + 7) // 8], "little")
        return held >> start % 8 & (1 << count) - 1

    def end(self) -> None:
        """See that exactly the bytes there are were read."""
        whole = len(self.coded) <= self.read <= len(self.coded) + 8
        if not whole or len(self.bits) != (self.raw_read + 7) // 8:
            raise CorruptError("a stream is too short or too long")


class Intervals:
    """The stream of levels 1 and 2 of exact: intervals of 2^16 (rANS)."""

    def __init__(self, payload: bytes) -> None:
        self.words = [word for (word,) in struct.iter_unpack("<I", payload)][::-1]
        self.state: int = self.words.pop() | self.words.pop() << 32

    def slot(self) -> int:
        """Tell where the next interval is."""
        return self.state % 2**16

    def take(self, start: int, size: int) -> None:
        """Take an interval."""
        self.state = size * (self.state >> 16) + self.slot() - start
        if self.state < 2**31:
            self.state = self.state << 32 | self.words.pop()

    def bit(self, model: Bit) -> bool:
        """Take a bit by a model, which learns."""
        chance = model.chance_of_zero()
        one = self.slot() >= chance
        self.take(chance if one else 0, 2**16 - chance if one else chance)
        model.learn(one)
        return one

    def uniform(self, count: int) -> int:
        """Take one of so many equally likely numbers."""
        value = self.slot() * count >> 16
        start, end = (-(-v * 2**16 // count) for v in (value, value + 1))
        self.take(start, end - start)
        return value

    def raw(self, count: int) -> int:
        """Take so many raw bits, 16 at a time."""
        value = 0
        for done in range(0, count, 16):
            bits = min(count - done, 16)
            value |= self.uniform(2**bits) << done
        return value

    def end(self) -> None:
        """See that the writer began here."""
        if self.state != 2**31 or self.words:
            raise CorruptError("a stream is too short or too long")


def symbol(stream: Coded | Intervals, models: list[Bit]) -> int:
    """Take a symbol of a tree, from its highest bit on."""
    node = 1
    while node < len(models):
        node = 2 * node + stream.bit(models[node])
    return node - len(models)


def magnitude(stream: Coded | Intervals, length: int) -> int:
    """Take a number of so many bits, the leading one of which is not written."""
    return length if length < 2 else 1 << length - 1 | stream.raw(length - 1)
