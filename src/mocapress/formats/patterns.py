"""Text that refers to what a file's head says anyway: docs/format/layout.md, section "Patterns"."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from decimal import Decimal

from mocapress.errors import CorruptError
from mocapress.motion.clip import FrameTime
from mocapress.motion.number_format import NumberFormat
from mocapress.motion.skeleton import Skeleton

RAW, BREAK, NAME, CHANNELS, COUNT, TIME, PASS, VALUE = range(8)
"""The bytes that stand for something else; what each means depends on where it stands."""
NUMBER = 0x10
MOST_FORMATS = 16
_PIECE = re.compile(
    rb"\x00(.)|([\x00-\x08\x0b\x0c\x0e-\x1f])|([^\x00-\x08\x0b\x0c\x0e-\x1f]+)", re.S
)
_SPECIAL = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f]")
_WORDS = {
    "tx": "Xposition",
    "ty": "Yposition",
    "tz": "Zposition",
    "rx": "Xrotation",
    "ry": "Yrotation",
    "rz": "Zrotation",
}


@dataclass(frozen=True, slots=True)
class References:
    """What the patterns of a layout may refer to."""

    joints: tuple[str, ...] = ()
    """Names of the skeleton's joints."""
    channels: tuple[str | None, ...] = ()
    """Of each joint its number of channels and their words; None where one has no word."""
    numbers: tuple[float, ...] = ()
    """Of each joint the offset and the end sites."""
    bones: tuple[str, ...] = ()
    """The bone of each column."""
    time: str = ""
    """The frame time; empty where there is none."""

    @classmethod
    def of(
        cls, skeleton: Skeleton | None, bones: Sequence[str], frame_time: FrameTime
    ) -> "References":
        """Take them from skeleton, columns and frame time."""
        joints = skeleton.joints if skeleton else ()
        return cls(
            tuple(joint.name for joint in joints),
            tuple(_channel_words(joint.channels) for joint in joints),
            tuple(x for joint in joints for v in (joint.offset, *joint.ends) for x in v),
            tuple(bones),
            decimal_text(frame_time) if isinstance(frame_time, Decimal) else "",
        )


@dataclass(frozen=True, slots=True)
class Style:
    """How patterns of one layout are to be printed."""

    line_break: bytes = b"\n"
    indentation: bytes = b""
    encoding: str = "latin-1"
    formats: tuple[NumberFormat, ...] = ()
    """Of the numbers in the header."""


def decimal_text(value: Decimal) -> str:
    """Print a decimal without an exponent, at least one digit before the point."""
    return f"{value:f}"


def raw(text: bytes) -> bytes:
    """Give the pattern of a text that refers to nothing."""
    return _SPECIAL.sub(lambda found: b"\0" + found.group(), text)


def pieces(pattern: bytes) -> Iterator[tuple[int, bytes]]:
    """Give what a pattern consists of: texts, as (-1, text), and references, as (byte, b"").

    Raises
    ------
    CorruptError
        When it ends within a piece.

    """
    position = 0
    for found in _PIECE.finditer(pattern):
        position = found.end()
        code = found.group(2)
        if code == b"\0":
            break
        yield (code[0], b"") if code else (-1, found.group(1) or found.group(3))
    else:
        if position == len(pattern):
            return
    raise CorruptError("layout: a pattern cut off")


@dataclass(slots=True)
class Header:
    """Prints the header's pattern."""

    references: References
    style: Style
    rows: int
    """How many rows are printed behind it."""
    most: int
    """Bytes that may come out."""
    print_numbers: Callable[[Sequence[float], NumberFormat], Sequence[bytes]]
    _out: list[bytes] = field(default_factory=list)
    _length: int = 0
    _open: int = 0
    _joint: int = -1
    _number: int = 0

    def print(self, pattern: bytes) -> bytes:
        """Give the header.

        Raises
        ------
        CorruptError
            When the pattern refers to what there is not, or too much comes out.

        """
        texts = self._number_texts(pattern)
        parts = list(pieces(pattern))
        for index, (code, text) in enumerate(parts):
            if code == -1:
                self._put(text)
            elif code == BREAK:
                closes = index + 1 < len(parts) and parts[index + 1][1][:1] == b"}"
                depth = max(max(self._open, 0) - closes, 0)
                self._put(self.style.line_break)
                self._put(self.style.indentation, depth)
            elif code >= NUMBER or code == PASS:
                self._put(next(texts))
            else:
                self._put(self._word(code))
        return b"".join(self._out)

    def _word(self, code: int) -> bytes:
        refer = self.references
        if code == NAME:
            self._joint += 1
            if self._joint < len(refer.joints):
                return encoded(refer.joints[self._joint], self.style.encoding)
        elif code == CHANNELS and 0 <= self._joint < len(refer.channels):
            words = refer.channels[self._joint]
            if words is not None:
                return words.encode()
        elif code == COUNT:
            return b"%d" % self.rows
        elif code == TIME and refer.time:
            return refer.time.encode()
        raise CorruptError("layout: a pattern refers to what is not there")

    def _number_texts(self, pattern: bytes) -> Iterator[bytes]:
        """Give the texts of the numbers in the order of the pattern; each format prints at once."""
        codes = [code for code, _ in pieces(pattern) if code >= NUMBER or code == PASS]
        if len(codes) > len(self.references.numbers):
            raise CorruptError("layout: more numbers than the skeleton has")
        texts = [b""] * len(codes)
        for k in set(codes) - {PASS}:
            if k - NUMBER >= len(self.style.formats):
                raise CorruptError("layout: a number in no format")
            places = [place for place, code in enumerate(codes) if code == k]
            values = [self.references.numbers[place] for place in places]
            printed = self.print_numbers(values, self.style.formats[k - NUMBER])
            for place, text in zip(places, printed, strict=True):
                texts[place] = text
        return iter(texts)

    def _put(self, text: bytes, times: int = 1) -> None:
        self._length += len(text) * times
        if self._length > self.most:
            raise CorruptError("layout: a longer header than may be")
        self._open += times * (text.count(b"{") - text.count(b"}"))
        self._out.append(text * times)


def encoded(name: str, encoding: str) -> bytes:
    """Give a name's bytes.

    Raises
    ------
    CorruptError
        When it has characters that the encoding lacks.

    """
    try:
        return name.encode(encoding)
    except UnicodeEncodeError:
        raise CorruptError("layout: a name that cannot be printed") from None


def _channel_words(channels: Sequence[str]) -> str | None:
    if not set(channels) <= set(_WORDS):
        return None
    return " ".join([str(len(channels)), *(_WORDS[kind] for kind in channels)])
