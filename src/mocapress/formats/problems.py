"""What is not as it should be in a file that can be read nevertheless."""

from dataclasses import dataclass

from mocapress import _core
from mocapress.errors import FormatError
from mocapress.formats.encodings import FileText

MISSING_ROWS = "missing-rows"
"""Fewer rows than declared."""
UNREADABLE_ROWS = "unreadable-rows"
"""Rows that are cut short, or whose numbers cannot be read."""
EXTRA_ROWS = "extra-rows"
"""More rows than declared; all of them are read."""
BYTES_AFTER_END = "bytes-after-end"
"""Something that is no row after the last row."""
NOT_NUMBERS = "not-numbers"
"""Values such as ``nan`` and ``inf``."""
EXTRA_NUMBERS = "extra-numbers"
"""More numbers in every row than there are channels; they become columns of no joint."""
SCALE_CHANNELS = "scale-channels"
"""Channels that scale; kinematics leaves them out."""

_LOSING = frozenset({MISSING_ROWS, UNREADABLE_ROWS})


@dataclass(frozen=True, slots=True)
class Problem:
    """One departure of a file from its format.

    Strict reading refuses what loses motion and warns of the rest; lenient reading warns of both.
    """

    name: str
    """A short fixed name, such as ``extra-rows``, that scripts may rely on."""
    loses_motion: bool
    """Whether frames that the file should hold are missing from the clip."""
    what: str
    line: int | None = None
    """Counted from 1."""
    offset: int | None = None
    """In bytes."""
    expected: str | None = None
    found: str | None = None

    @classmethod
    def of(
        cls,
        name: str,
        what: str,
        line: int | None = None,
        offset: int | None = None,
        expected: str | None = None,
        found: str | None = None,
    ) -> "Problem":
        """Make a problem of a known name, which says whether it loses motion."""
        return cls(name, name in _LOSING, what, line, offset, expected, found)

    @classmethod
    def told(cls, fact: _core.Problem, text: FileText) -> "Problem":
        """Make one of what the core found in a file."""
        return cls(
            fact.name,
            fact.loses_motion,
            fact.what,
            fact.line,
            text.offset(fact.offset),
            fact.expected,
            fact.found,
        )

    def error(self, file: str | None = None) -> FormatError:
        """Give the error that says the same."""
        return FormatError(
            self.what,
            file=file,
            line=self.line,
            offset=self.offset,
            expected=self.expected,
            found=self.found,
        )
