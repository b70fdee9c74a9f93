"""Text that refers to what a file's head says anyway: docs/format/layout.md, section "Patterns"."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.errors import CorruptError
from mocapress.formats.number_formats import packed
from mocapress.motion.frame_time import FrameTime
from mocapress.motion.number_format import NumberFormat
from mocapress.motion.skeleton import Skeleton

RAW, BREAK, NAME, CHANNELS, COUNT, TIME, PASS, VALUE = range(8)
"""The bytes that stand for something else; what each means depends on where it stands."""
NUMBER = 0x10
MOST_FORMATS = 16
_REFERENCE = re.compile(rb"(\x00.?|[\x01-\x08\x0b\x0c\x0e-\x1f])", re.DOTALL)
_SPECIAL = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f]")
_CONTROLS = bytes({*range(0x20)} - {0x09, 0x0A, 0x0D})
_WORDS = {
    "tx": "Xposition",
    "ty": "Yposition",
    "tz": "Zposition",
    "rx": "Xrotation",
    "ry": "Yrotation",
    "rz": "Zrotation",
    "sx": "Xscale",
    "sy": "Yscale",
    "sz": "Zscale",
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
    if len(text.translate(None, _CONTROLS)) == len(text):
        return text
    return _SPECIAL.sub(lambda found: b"\0" + found.group(), text)


def pieces(pattern: bytes) -> tuple[list[bytes], list[int]]:
    """Part a pattern into texts and the references between them.

    Returns
    -------
    tuple
        Texts, one more than references; and the references' bytes.

    Raises
    ------
    CorruptError
        When it ends within a piece.

    """
    parts = _REFERENCE.split(pattern)
    texts, references = parts[0::2], [part[0] for part in parts[1::2]]
    if RAW in references:
        if b"\0" in parts[1::2]:
            raise CorruptError("layout: a pattern cut off")
        return _with_raw(parts)
    return texts, references


def _with_raw(parts: list[bytes]) -> tuple[list[bytes], list[int]]:
    """Join the texts around bytes that stand for themselves."""
    texts, references = [bytearray(parts[0])], []
    for part, text in zip(parts[1::2], parts[2::2], strict=True):
        if part[0] == RAW:
            texts[-1] += part[1:] + text
        else:
            references.append(part[0])
            texts.append(bytearray(text))
    return [bytes(text) for text in texts], references


def of_header(
    references: References, encoding: str
) -> tuple[list[bytes | None], list[bytes | None], NDArray[np.float64], bytes]:
    """Give what a header may refer to as the core takes it; None for what cannot be printed."""

    def text(name: str) -> bytes | None:
        try:
            return name.encode(encoding)
        except UnicodeEncodeError:
            return None

    return (
        [text(name) for name in references.joints],
        [words.encode() if words is not None else None for words in references.channels],
        np.array(references.numbers, np.float64),
        references.time.encode(),
    )


def print_header(
    pattern: bytes, references: References, style: Style, rows: int, most: int
) -> bytes:
    """Give the header of a pattern.

    Parameters
    ----------
    pattern, references, style
        What is printed, and how.
    rows
        How many rows are printed behind it.
    most
        Bytes that may come out.

    Raises
    ------
    CorruptError
        When the pattern refers to what there is not, or too much comes out.

    """
    refer = of_header(references, style.encoding)
    formats = packed(style.formats)
    try:
        return _core.print_header(
            pattern, *refer, rows, style.line_break, style.indentation, formats, most
        )
    except ValueError as error:
        raise CorruptError(f"layout: {error}") from None


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
