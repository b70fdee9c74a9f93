"""What a command says of each file: a line or an object, as soon as the file is done."""

import json as jsonlib
import re
import sys
import traceback
from collections.abc import Callable
from math import isfinite
from typing import TYPE_CHECKING, Any

import typer

from mocapress.errors import MocapressError, ParameterError
from mocapress.storage import ExistsError

if TYPE_CHECKING:
    from mocapress.cli.batch import Job

DEFECT = 70
"""Exit code of a fault of mocapress, as EX_SOFTWARE of sysexits.h."""


class Report:
    """Results on stdout, warnings and failures on stderr; with JSON, all of them in one array."""

    def __init__(
        self,
        *,
        json: bool,
        show: Callable[["Job"], None],
        failure_code: int,
        quiet: bool,
        verbose: bool,
        debug: bool,
    ) -> None:
        self.json, self.show, self.failure_code, self.debug = json, show, failure_code, debug
        self.quiet, self.verbose = quiet, verbose
        self.reported: set[Job] = set()
        self.done: list[Job] = []
        self.failed: list[Job] = []

    @property
    def count(self) -> int:
        """How many jobs are reported."""
        return len(self.done) + len(self.failed)

    def add(self, job: "Job") -> None:
        """Report a job that is done or has failed."""
        if self.json:
            print("[" if not self.reported else ",", _json(job), sep="\n")
        elif job.error is not None:
            self._warn(job)
            if not isinstance(job.error, BrokenPipeError):  # whoever read stdout has seen enough
                say(message(job.error, str(job.source)))
        elif not self.quiet:
            self._warn(job)
            self.show(job)
            if self.verbose:
                say(_speed(job))
        if self.debug and job.error is not None:
            traceback.print_exception(job.error)
        sys.stdout.flush()
        self.reported.add(job)
        (self.done if job.error is None else self.failed).append(job)

    def _warn(self, job: "Job") -> None:
        for warning in job.warnings * (not self.quiet):
            say(f"warning: {_with_file(job, str(warning))}")
        if job.error is None and job.result.get("warning"):
            say(f"warning: {_with_file(job, str(job.result['warning']))}")

    def end(self, total: Callable[[list["Job"]], None] | None) -> None:
        """Report the sum; raise the exit code where something has failed."""
        if self.json:
            self._close()
        elif total and len(self.done) > 1 and not self.quiet:
            total(self.done)
        if any(is_defect(job.error) for job in self.failed):
            raise typer.Exit(DEFECT)
        if self.failed:
            raise typer.Exit(max(map(self._code, self.failed)))

    def _code(self, job: "Job") -> int:
        """Give the exit code of a failure; that of the command is for what is wrong in a file."""
        if isinstance(job.error, OSError | ExistsError):
            return 1
        alone = all(isinstance(failed.error, ParameterError) for failed in self.failed)
        return 2 if alone else self.failure_code

    def interrupt(self, jobs: int | None) -> None:
        """Say how far it came."""
        if self.json:
            self._close()
        of = "" if jobs is None else f"of {jobs} "
        say(f"interrupted; {len(self.done)} {of}files done")

    def _close(self) -> None:
        print("]" if self.reported else "[]")


def say(text: str) -> None:
    """Print a line to stderr."""
    print(f"mocapress: {_as_option(text)}", file=sys.stderr, flush=True)


def is_defect(error: Exception | None) -> bool:
    """Tell defects of mocapress from errors of inputs and of the system."""
    return error is not None and not isinstance(error, MocapressError | OSError | MemoryError)


def message(error: Exception, name: str) -> str:
    """Describe an error in one line that names the file."""
    if isinstance(error, OSError):
        text = f"{error.filename or name}: {error.strerror or error}"
    elif isinstance(error, MemoryError):
        text = "not enough memory"
    elif is_defect(error):
        kind = type(error).__name__
        text = f"a defect of mocapress: {kind}: {error}; --debug shows where"
    else:
        text = str(error)
    text = " ".join(text.split("\n"))
    return text if name in ("", "-") or name in text else f"{name}: {text}"


_ARGUMENT = re.compile(r"\b(\w+?)(?:_path)?=(?:True|\.\.\.)")


def _as_option(text: str) -> str:
    """Give a message in which arguments of Python, ``force=True``, are options: ``--force``."""
    return _ARGUMENT.sub(r"--\1", text)


def _json(job: "Job") -> str:
    return jsonlib.dumps(_finite(_row(job)), indent=1, allow_nan=False)


def _row(job: "Job") -> dict[str, Any]:
    row: dict[str, Any] = {"file": str(job.source)}
    if isinstance(job.error, MocapressError):
        row = _as_options(job.error.as_dict()) | row
    elif job.error is not None:
        row |= {"error": type(job.error).__name__, "what": message(job.error, str(job.source))}
    else:
        row |= job.result
    return row | {"warnings": [_as_options(warning.as_dict()) for warning in job.warnings]}


def _as_options(facts: dict[str, Any]) -> dict[str, Any]:
    return {k: _as_option(v) if isinstance(v, str) else v for k, v in facts.items()}


def _finite(value: Any) -> Any:
    """Replace what JSON cannot express, infinities and NaN, by null."""
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _speed(job: "Job") -> str:
    """Say how long a job took, and how fast that was where its size is known."""
    size = job.result.get("raw_bytes")
    speed = f", {size / job.seconds / 1e6:.1f} MB/s" if size and job.seconds else ""
    return f"{job.source}: {job.seconds:.2f} s{speed}"


def _with_file(job: "Job", text: str) -> str:
    name = str(job.source)
    return text if text.startswith(name) else f"{name}: {text}"
