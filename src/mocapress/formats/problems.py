"""What is not as it should be in a file that can be read nevertheless."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

from mocapress.errors import FormatError, MotionWarning

MISSING_ROWS = "missing-rows"
"""Fewer rows than declared."""
UNREADABLE_ROWS = "unreadable-rows"
"""Rows that are cut short, or whose numbers cannot be read."""
EXTRA_ROWS = "extra-rows"
"""More rows than declared; all of them are read."""
BYTES_AFTER_END = "bytes-after-end"
"""Something that is no row after the last row."""

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


def report(
    problems: Sequence[Problem], file: str | None = None, *, strict: bool = True, depth: int = 1
) -> None:
    """Raise the first problem that loses motion, where reading is strict; warn of the others.

    Parameters
    ----------
    problems
        As ``Split`` has them.
    file
        For the messages.
    strict
        Whether losing motion is an error; otherwise it is a warning, too.
    depth
        How many calls lie between this one and the one that a warning should point to.

    Raises
    ------
    FormatError
        With place, expected and found.

    """
    if strict:
        for problem in problems:
            if problem.loses_motion:
                raise problem.error(file)
    for problem in problems:
        warning = MotionWarning(problem.name, problem.error(file))
        warnings.warn(warning, stacklevel=depth + 2)
