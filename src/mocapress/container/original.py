"""The original file's facts and layout, and what belongs to it: docs/format.md, "File", "Notes"."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from mocapress.container import limits
from mocapress.container.packing import pack, unpack, unpacked_parts
from mocapress.errors import CorruptError
from mocapress.formats.problems import Problem
from mocapress.records import Reader, Writer

_LOSES_MOTION = 1


@dataclass(frozen=True, slots=True)
class Original:
    """The file that was compressed, but for its numbers."""

    format: str
    """Id of its format; empty where it is no motion."""
    name: str
    """Without folders; may be empty."""
    size: int
    """Bytes."""
    digest: bytes
    """SHA-256."""
    problems: tuple[Problem, ...]
    """Where it departs from its format."""
    packed: bytes
    """Its layout or, without a format, the file itself."""

    def layout(self) -> bytes:
        """Give the layout as bytes.

        Raises
        ------
        CorruptError
            When it cannot be unpacked.

        """
        return unpack(self.packed, "layout", limits.most_layout(self.size, len(self.packed)))

    def contents(self) -> Iterator[bytes]:
        """Give the file, where it is no motion, part after part.

        Raises
        ------
        CorruptError
            When it cannot be unpacked.

        """
        return unpacked_parts(self.packed, "contents", self.size)


class Companion(NamedTuple):
    """Another file that belongs to the original."""

    format: str
    name: str
    data: bytes


def write_original(original: Original) -> bytes:
    """Give the content of the section."""
    writer = Writer()
    writer.text(original.format)
    writer.text(original.name)
    writer.integer(original.size)
    writer.data += original.digest
    writer.data += write_problems(original.problems)
    return bytes(writer.data) + original.packed


def write_problems(problems: Sequence[Problem]) -> bytes:
    """Give problems as the section has them."""
    writer = Writer()
    writer.integer(len(problems))
    for problem in problems:
        writer.integer(_LOSES_MOTION * problem.loses_motion)
        writer.text(problem.name)
        writer.text(problem.what)
        writer.integer(problem.line or 0)
        writer.integer(0 if problem.offset is None else problem.offset + 1)
        writer.text(problem.expected or "")
        writer.text(problem.found or "")
    return bytes(writer.data)


def read_problems(reader: Reader) -> tuple[Problem, ...]:
    """Take problems.

    Raises
    ------
    CorruptError
        When there are none such.

    """
    return tuple(_read_problem(reader) for _ in range(reader.integer(limits.PROBLEMS)))


def read_original(content: bytes, length: int) -> Original:
    """Read the content of the section in a file of so many bytes.

    Raises
    ------
    CorruptError
        When it is no such section.

    """
    reader = Reader(content, "file section")
    kind, name, size = reader.text(), reader.text(), reader.integer()
    if size > limits.most_original(length):
        raise CorruptError(f"{size} bytes announced in a file of {length}")
    digest = reader.raw(32)
    problems = read_problems(reader)
    return Original(kind, name, size, digest, problems, reader.raw(reader.left))


def _read_problem(reader: Reader) -> Problem:
    flags, name, what = reader.integer(1), reader.text(), reader.text()
    line, offset = reader.integer(), reader.integer()
    expected, found = reader.text(), reader.text()
    return Problem(
        name,
        bool(flags & _LOSES_MOTION),
        what,
        line or None,
        offset - 1 if offset else None,
        expected or None,
        found or None,
    )


def write_notes(notes: Mapping[str, str]) -> bytes:
    """Give the content of the section."""
    writer = Writer()
    writer.integer(len(notes))
    for key, value in notes.items():
        writer.text(key)
        writer.text(value)
    return pack(bytes(writer.data))


def read_notes(content: bytes) -> dict[str, str]:
    """Read the content of the section.

    Raises
    ------
    CorruptError
        When it is no such section.

    """
    reader = Reader(unpack(content, "notes", limits.UNPACKED), "notes")
    notes = {}
    for _ in range(reader.integer(limits.FACTS)):
        key = reader.text()
        notes[key] = reader.text()
    reader.end()
    return notes


def write_companion(companion: Companion) -> bytes:
    """Give the content of the section."""
    writer = Writer()
    writer.text(companion.format)
    writer.text(companion.name)
    return bytes(writer.data) + pack(companion.data)


def read_companion(content: bytes, most: int) -> Companion:
    """Read the content of the section, whose file has at most so many bytes.

    Raises
    ------
    CorruptError
        When it is no such section.

    """
    reader = Reader(content, "companion")
    kind, name = reader.text(), reader.text()
    packed = reader.raw(reader.left)
    return Companion(kind, name, unpack(packed, "companion", most))
