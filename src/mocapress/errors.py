"""Errors that mocapress raises on bad input, parameters or files.

Every error says what was wrong, where, what was expected and what was found. Nothing else reaches
a user for input that is wrong; any other exception is a defect of mocapress.
"""


class MocapressError(Exception):
    """Base of all errors of mocapress.

    Parameters
    ----------
    what
        One sentence without the place, e.g. ``"wrong number of values"``.
    file
        The file concerned, when there is one.
    line
        Line number, counted from 1.
    offset
        Byte offset, counted from 0.
    expected, found
        What should have stood there and what did.

    """

    def __init__(
        self,
        what: str,
        *,
        file: str | None = None,
        line: int | None = None,
        offset: int | None = None,
        expected: str | None = None,
        found: str | None = None,
    ) -> None:
        super().__init__(what)
        self.what = what
        self.file = file
        self.line = line
        self.offset = offset
        self.expected = expected
        self.found = found

    def __str__(self) -> str:
        place = [part for part in (self.file, self.line and f"line {self.line}") if part]
        if self.offset is not None:
            place.append(f"byte {self.offset}")
        text = f"{', '.join(place)}: {self.what}" if place else self.what
        if self.expected is not None:
            text += f"; expected {self.expected}"
        if self.found is not None:
            text += f"; found {self.found}"
        return text

    def as_dict(self) -> dict[str, str | int]:
        """Give the error as plain data, for ``--json``."""
        fields = {
            "error": type(self).__name__,
            "what": self.what,
            "file": self.file,
            "line": self.line,
            "offset": self.offset,
            "expected": self.expected,
            "found": self.found,
        }
        return {key: value for key, value in fields.items() if value is not None}


class FormatError(MocapressError):
    """A motion file (AMC, ASF, BVH) does not follow its format."""


class CorruptError(MocapressError):
    """A compressed file is damaged: truncated, altered, or not written by mocapress."""


class UnsupportedError(MocapressError):
    """The input is valid, but asks for something that this version cannot do."""


class LimitError(UnsupportedError):
    """More would be restored than the user allows."""

    def __init__(self, limit: int, found: int, file: str | None = None) -> None:
        super().__init__(
            "more would be restored than the limit allows; limit=... sets another",
            file=file,
            expected=f"at most {limit} bytes",
            found=str(found),
        )


class ParameterError(MocapressError):
    """A parameter of a codec or command has a value it cannot have."""


class BusyError(MocapressError):
    """Another process is writing to the library, and did not end in time."""


class MissingModelError(MocapressError):
    """The model that a compressed file needs was not found."""


class MotionWarning(UserWarning):
    """Something departs from the format, or had to be assumed; reading went on.

    Parameters
    ----------
    name
        A short fixed name, such as ``extra-rows``, that scripts may rely on.
    fact
        What it is, with place, expected and found.

    """

    def __init__(self, name: str, fact: MocapressError) -> None:
        super().__init__(str(fact))
        self.name = name
        self.fact = fact

    def as_dict(self) -> dict[str, str | int]:
        """Give the warning as plain data, for ``--json``."""
        fields = self.fact.as_dict()
        del fields["error"]
        return {"warning": self.name} | fields


class VerificationError(MocapressError):
    """A codec failed, or what it decodes is not what it encoded; nothing has been written."""
