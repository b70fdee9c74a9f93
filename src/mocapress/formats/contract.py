"""What a format is: everything that the rest of mocapress knows of a kind of motion file."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError
from mocapress.formats.layout import Layout
from mocapress.formats.problems import Problem
from mocapress.formats.rows import RowsOf, rows_of
from mocapress.motion import Clip, Column, Skeleton
from mocapress.records import Ranges

Near = Callable[[str, str], bytes | None]
"""Gives the contents of a file beside a motion file, None where there is none: ``near("_motion",
"_channels.tsv")`` that of ``walk_channels.tsv`` for ``walk_motion.tsv``."""


class StoredLayout(ABC):
    """Everything of a file that is not in its streams, where it is not rows of text."""

    __slots__ = ()
    format: str
    """Id of the format."""

    @property
    @abstractmethod
    def sizes(self) -> list[tuple[int, int]]:
        """Give frames and columns of each stream."""

    @abstractmethod
    def pieces(self, rows: RowsOf, most_bytes: int = ...) -> Iterator[bytes]:
        """Give the file's bytes one part after the other, asking for rows as they are printed.

        Raises
        ------
        CorruptError
            When the layout does not fit, or more than ``most_bytes`` would come out.

        """

    @abstractmethod
    def record(self) -> bytes:
        """Give the layout as it is stored; the format's ``read_layout`` reads it."""

    def join(self, streams: Sequence[NDArray[np.float64]], most_bytes: int = 2**62) -> bytes:
        """Give the file's bytes from the values of all streams, each (F, C).

        Raises
        ------
        CorruptError
            When they do not fit, or more than ``most_bytes`` would come out.

        """
        if [values.shape for values in streams] != self.sizes:
            raise CorruptError("the streams do not fit the layout")
        return b"".join(self.pieces(rows_of(streams), most_bytes))


class Split(NamedTuple):
    """A motion file taken apart."""

    clip: Clip
    layout: Layout
    """Of rows of text; ``NO_ROWS`` where the file is none."""
    problems: tuple[Problem, ...]
    """Where the file departs from its format. What is no row is in the layout's tail."""
    stored: StoredLayout | None = None
    """The layout of a file that is no rows of text."""


class LongSplit(NamedTuple):
    """A file taken apart that is not held in memory as a whole."""

    clip: Clip
    """Its streams, without their frames."""
    frames: tuple[int, ...]
    """Of each stream."""
    problems: tuple[Problem, ...]
    stored: StoredLayout
    parts: Callable[[], Iterator[Mapping[str, NDArray[np.float64]]]]
    """Gives the rows of streams, some frames after the other."""


def split_of(clip: Clip, layout: Layout, problems: Sequence[Problem], file: str | None) -> Split:
    """Put a split together; the columns get the number formats that the layout found."""
    columns = tuple(
        Column(column.name, column.joint, column.kind, column.unit, number_format)
        for column, number_format in zip(clip.columns, layout.formats, strict=True)
    )
    named = replace(clip.with_columns(columns), name=Path(file).stem if file else "")
    return Split(named, layout, tuple(problems))


def _as_it_is(clip: Clip) -> Clip:
    return clip


@dataclass(frozen=True, slots=True, eq=False)
class Format:
    """A format: one file makes one of these, the registry finds it.

    Functions that a format does not have are None: an exporter has no ``split``, a format of
    skeletons only ``read_skeleton``.
    """

    id: str
    """Names the format in options and in compressed files, e.g. ``amc``."""
    name: str
    """For people, e.g. ``AMC``."""
    suffixes: tuple[str, ...]
    """Endings of file names in lower case, the usual one first."""
    recognises: Callable[[bytes], bool]
    """Tells from the first 64 KiB, without a byte order mark and blanks before them, whether a file
    is of this format. What no format recognises goes by its suffix."""
    split: Callable[[bytes, Skeleton | None, str | None], Split] | None = None
    """Takes a file's bytes apart, given the skeleton of its companion and the file's name for
    messages. Raises ``FormatError`` when not a single frame can be read."""
    split_long: Callable[[Ranges, str | None], LongSplit] | None = None
    """Takes a file apart that is larger than is held at once, of the name given."""
    outline: Callable[[Ranges, str | None], LongSplit] | None = None
    """Does the same without looking at the frames; the layout does not print the file then."""
    read: Callable[[bytes, Skeleton | None, str | None], Split] | None = None
    """Reads motion out of a file that is no rows of numbers, and is compressed as any other file:
    what it gives has no layout."""
    read_skeleton: Callable[[bytes, str | None], Skeleton] | None = None
    """Reads a file that holds a skeleton and no motion; the name is for messages."""
    fit: Callable[[Clip], Clip] = _as_it_is
    """Converts any clip to one that the format can hold. Raises ``UnsupportedError``."""
    write: Callable[[Clip], Mapping[str, bytes]] | None = None
    """Prints a clip that was made to fit: contents by suffix, the file itself first, then what
    belongs beside it. Numbers are printed in their columns' formats, else with the fewest digits.
    """
    read_layout: Callable[[bytes], StoredLayout] | None = None
    """Reads the record of a layout of the format's own. Without it, layouts are those of rows."""
    completed: Callable[[bytes], bytes] | None = None
    """Puts right what a file says of its numbers, where a lossy codec has changed these."""
    describe: Callable[[Any, Clip, Near], Clip] | None = None
    """Gives streams as they are stored the names and units that such a layout knows, or a file
    beside. Raises ``FormatError`` where that file does not fit; it is then left away."""
    configured: "Callable[[Mapping[str, str]], Format] | None" = None
    """Gives the format with options of writing, such as ``{"max": "0.1cm"}``. Raises
    ``ParameterError``."""
    written: tuple[str, ...] = ()
    """The suffixes that ``write`` is for, where it is not for all."""
    any_columns: bool = False
    """Whether files hold any columns, those of some channels alone, too."""
    timed: bool = True
    """Whether files have to state their frame time."""
    companion: str | None = None
    """Id of the format in which the skeleton lies beside the file."""
