"""Running a command over many files: finding them, working in parallel, reporting."""

import json as jsonlib
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import typer

from mocapress.cli.warned import collecting, kept
from mocapress.errors import MocapressError, MotionWarning, ParameterError
from mocapress.source import Source

STREAM = Path("-")


@dataclass(frozen=True, slots=True)
class Job:
    """One file to work on: ``source`` is ``-`` for stdin."""

    source: Path
    base: Path
    """The folder that was named, or the file's own: outputs keep the path from here."""


@dataclass(slots=True)
class Outcome:
    """What came of one file."""

    source: Path
    result: dict[str, Any] = field(default_factory=dict)
    error: MocapressError | OSError | MemoryError | None = None
    warnings: list[MotionWarning] = field(default_factory=list)


def find(inputs: Sequence[Path], suffixes: tuple[str, ...]) -> list[Job]:
    """Turn files and folders into jobs; of a folder, all files below it with these endings."""
    jobs = []
    for path in inputs:
        if path != STREAM and path.is_dir():
            jobs += [
                Job(found, path)
                for found in sorted(path.rglob("*"))
                if found.name.lower().endswith(suffixes) and found.is_file()
            ]
        else:
            jobs.append(Job(path, path.parent))
    if not jobs:
        usage(f"no {' or '.join(suffixes)} files in {', '.join(map(str, inputs))}")
    if len(jobs) > 1 and any(job.source == STREAM for job in jobs):
        usage("stdin cannot be one of many inputs")
    return jobs


def usage(message: str) -> NoReturn:
    """End with the exit code of wrong usage."""
    typer.echo(f"mocapress: {message}", err=True)
    raise typer.Exit(2)


def opened(job: Job) -> Source:
    """Open a job's file, or stdin."""
    return Source(sys.stdin.buffer) if job.source == STREAM else Source(job.source)


def target(job: Job, output: Path | None, rename: Callable[[Path], Path], *, many: bool) -> Path:
    """Say where a job's output goes; ``rename`` gives the name where none was asked for."""
    if output == STREAM or (output is None and job.source == STREAM):
        if many:
            usage("stdout cannot take many outputs")
        return STREAM
    if output is None:
        return rename(job.source)
    if many or output.is_dir() or str(output).endswith("/"):
        return output / rename(job.source).relative_to(job.base)
    return output


def run(
    jobs: Sequence[Job],
    work: Callable[[Job], dict[str, Any]],
    *,
    threads: int,
    json: bool,
    show: Callable[[list[Outcome]], None],
    failure_code: int = 1,
) -> None:
    """Work on all jobs; report results and errors; end with the exit code."""
    with collecting():
        outcomes = _work_all(jobs, work, threads)
    failed = [outcome for outcome in outcomes if outcome.error]
    if json:
        rows = [
            {"file": str(outcome.source)}
            | (_as_dict(outcome) if outcome.error else outcome.result)
            | {"warnings": [warning.as_dict() for warning in outcome.warnings]}
            for outcome in outcomes
        ]
        typer.echo(jsonlib.dumps(rows, indent=1))
    else:
        done = [outcome for outcome in outcomes if not outcome.error]
        for outcome in outcomes:
            for warning in outcome.warnings:
                typer.echo(f"mocapress: warning: {_of_file(outcome, str(warning))}", err=True)
        for outcome in done:
            if outcome.result.get("warning"):
                typer.echo(f"mocapress: warning: {_with_file(outcome)}", err=True)
        if done:
            show(done)
        for outcome in failed:
            typer.echo(f"mocapress: {_message(outcome)}", err=True)
    if failed:
        parameters = all(isinstance(outcome.error, ParameterError) for outcome in failed)
        raise typer.Exit(2 if parameters else failure_code)


def _work_all(
    jobs: Sequence[Job], work: Callable[[Job], dict[str, Any]], threads: int
) -> list[Outcome]:
    outcomes = [Outcome(job.source) for job in jobs]

    def one(index: int) -> None:
        try:
            outcomes[index].result = work(jobs[index])
        except (MocapressError, OSError, MemoryError) as error:
            outcomes[index].error = error
        outcomes[index].warnings = kept()

    if len(jobs) == 1:
        one(0)
        return outcomes
    from rich.console import Console
    from rich.progress import Progress

    with (
        Progress(
            console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()
        ) as bar,
        ThreadPoolExecutor(threads) as pool,
    ):
        task = bar.add_task("", total=len(jobs))
        futures = [pool.submit(one, index) for index in range(len(jobs))]
        try:
            for future in as_completed(futures):
                future.result()
                bar.advance(task)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return outcomes


def _with_file(outcome: Outcome) -> str:
    return _of_file(outcome, str(outcome.result["warning"]))


def _of_file(outcome: Outcome, text: str) -> str:
    name = str(outcome.source)
    return text if text.startswith(name) else f"{name}: {text}"


def _message(outcome: Outcome) -> str:
    error, name = outcome.error, str(outcome.source)
    if isinstance(error, OSError):
        text = f"{error.filename or name}: {error.strerror or error}"
    elif isinstance(error, MemoryError):
        text = "not enough memory"
    else:
        text = str(error)
    return text if name == "-" or name in text else f"{name}: {text}"


def _as_dict(outcome: Outcome) -> dict[str, Any]:
    if isinstance(outcome.error, MocapressError):
        return outcome.error.as_dict() | {"file": str(outcome.source)}
    return {"error": type(outcome.error).__name__, "what": _message(outcome)}
