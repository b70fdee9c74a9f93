"""Running a command over many files: finding them, working in parallel, storing, reporting."""

import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from mocapress.cli.progress import bar
from mocapress.cli.report import Report
from mocapress.cli.warned import collecting, kept
from mocapress.errors import MotionWarning, ParameterError
from mocapress.storage import Contents, check_targets, is_stream, write_all

if TYPE_CHECKING:
    from mocapress.source import Source

STREAM = Path("-")
_AHEAD = 2
"""Jobs that are ready when a thread is done with one."""
# Windows has no SIGHUP.
_ENDING = [
    signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]


@dataclass(slots=True, eq=False)
class Job:
    """One file, what to do with it, and the result."""

    source: Path
    """``-`` is stdin."""
    base: Path
    """The folder that was named, or the file's own: outputs keep the path from here."""
    in_folder: bool = False
    """Whether it was found in a folder that was named."""
    target: Path | None = None
    """Where the output goes, if there is one; ``-`` is stdout."""
    beside: tuple[str, ...] = ()
    """Endings of further outputs, of the target's name."""
    force: bool = False
    """Whether files that exist are replaced."""
    remove: bool = False
    """Whether the source is removed once the output is written."""
    times: bool = True
    """Whether outputs get the source's modification time; they always get its permissions."""
    stored: bool = False
    """Whether the source is no file but a name in a library."""
    share: float = 0
    """How much of all the work it is: bytes, where they are known."""
    outputs: dict[Path, Contents] = field(default_factory=dict)
    """What was made and is to be stored, all of it or nothing."""
    modified: int | None = None
    """What the outputs get as their modification time, in nanoseconds since 1970."""
    result: dict[str, Any] = field(default_factory=dict)
    seconds: float = 0
    error: Exception | None = None
    warnings: list[MotionWarning] = field(default_factory=list)

    def opened(self, limit: int | None = None) -> "Source":
        """Open the file, or stdin, of which so many bytes may be restored."""
        from mocapress.source import LIMIT, Source

        named = sys.stdin.buffer if self.source == STREAM else self.source
        return Source(named, limit=LIMIT if limit is None else limit)


def named(inputs: list[Path] | None) -> list[Path]:
    """Give the inputs that were named; without any, stdin, unless somebody would have to type."""
    if not inputs and sys.stdin.isatty():
        usage("no files are named; --help shows how")
    return inputs or [STREAM]


def find(inputs: Sequence[Path], suffixes: tuple[str, ...]) -> list[Job]:
    """Turn files and folders into jobs; of a folder, all files below it with these suffixes."""
    jobs = []
    for path in inputs:
        if path != STREAM and is_folder(path):
            jobs += [Job(found, path, in_folder=True) for found in _below(path, suffixes)]
        else:
            jobs.append(Job(path, path.parent))
    for job in jobs:
        job.share = size_of(job.source)
    if not jobs:
        usage(f"no {' or '.join(suffixes)} files in {', '.join(map(str, inputs))}")
    if len(jobs) > 1 and any(job.source == STREAM for job in jobs):
        usage("stdin cannot be one of many inputs")
    return jobs


def size_of(path: Path) -> int:
    """Give the bytes of a file; 0 for a stream, and for what cannot be looked at and will fail."""
    try:
        return path.stat().st_size
    except (OSError, ValueError):
        return 0


def is_folder(path: str | Path) -> bool:
    """Tell whether a path is a folder; one that cannot be looked at fails later, as a file."""
    return os.path.isdir(path)  # noqa: PTH112 - Path.is_dir raises for a name that is too long


def is_hidden(name: str) -> bool:
    """Tell whether a file or folder is left out where folders are gone through."""
    return name.startswith(".")


def _below(folder: Path, suffixes: tuple[str, ...]) -> list[Path]:
    found, unreadable = [], []
    # A folder that cannot be read becomes a job that fails; it must not be missed in silence.
    for place, folders, names in os.walk(
        folder, onerror=lambda error: unreadable.append(Path(error.filename))
    ):
        folders[:] = [name for name in folders if not is_hidden(name)]
        seen = [name for name in names if not is_hidden(name)]
        paths = [Path(place, name) for name in seen if name.lower().endswith(suffixes)]
        found += [path for path in paths if path.is_file()]
    return sorted([*found, *unreadable])


def usage(message: str) -> NoReturn:
    """End with the exit code of wrong usage."""
    typer.echo(f"mocapress: {message}", err=True)
    raise typer.Exit(2)


def run(
    jobs: Iterable[Job],
    work: Callable[[Job], dict[str, Any]],
    *,
    threads: int = 1,
    json: bool,
    show: Callable[[Job], None],
    total: Callable[[list[Job]], None] | None = None,
    failure_code: int = 1,
    quiet: bool = False,
    verbose: bool = False,
    debug: bool = False,
    whole: float | None = None,
    close: Callable[[], None] | None = None,
    progress: bool = True,
) -> None:
    """Work on all jobs, report each as it is done, and end with the exit code.

    Parameters
    ----------
    jobs
        With their targets, where there are outputs. They are asked for as they are needed.
    work
        Gives the facts of a job's result, and leaves what is to be stored in ``outputs``.
    threads
        Jobs at a time; 0: as many as there are cores.
    json
        Whether results are reported as JSON.
    show, total
        Print a result, and the sum of several.
    failure_code
        Of inputs that are bad.
    quiet, verbose
        Whether nothing but errors is printed; whether time and speed are, too.
    debug
        Whether errors come with their tracebacks.
    whole
        The sum of all shares, where the number of jobs is not known before.
    close
        What to do before a signal ends the process.
    progress
        Whether progress is shown, on a terminal.

    """
    report = Report(
        json=json,
        show=show,
        failure_code=failure_code,
        quiet=quiet,
        verbose=verbose,
        debug=debug,
    )
    done: queue.SimpleQueue[Job | int] = queue.SimpleQueue()
    storing = _Storing()

    def one(job: Job) -> None:
        begun_at = time.monotonic()
        try:
            if job.error is None:
                job.result = _worked(job, work, storing)
        except Exception as error:  # noqa: BLE001 - whatever it is, it must not stop the others
            job.error = error
        finally:
            job.seconds = time.monotonic() - begun_at
            job.warnings = kept()
            job.outputs.clear()
            done.put(job)

    number = len(jobs) if isinstance(jobs, Sequence) else None
    if whole is None and isinstance(jobs, Sequence):
        whole = sum(job.share for job in jobs)
    threads = threads or os.cpu_count() or 1
    pool = ThreadPoolExecutor(threads)
    coming, begun, more = iter(jobs), 0, True
    try:
        with collecting(), _signals(done.put), bar(whole, number if progress else 1) as advance:
            while True:
                while more and begun - report.count < threads + _AHEAD:
                    job = next(coming, None)
                    more = job is not None
                    if job is not None:
                        pool.submit(one, job)
                        begun += 1
                if begun == report.count:
                    break
                told = done.get()
                if isinstance(told, int):
                    _stop(told, number, done, storing, report, close)
                report.add(told)
                advance(str(told.source), told.share)
    finally:
        pool.shutdown(cancel_futures=True)
    report.end(total)


class _Storing:
    """The jobs that are storing their outputs just now; none begins once this is closed."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.closed = False
        self.begun: set[Job] = set()

    def begin(self, job: Job) -> None:
        with self.lock:
            if self.closed:
                threading.Event().wait()  # until the process ends
            self.begun.add(job)

    def close(self) -> set[Job]:
        with self.lock:
            self.closed = True
            return {*self.begun}


def _worked(job: Job, work: Callable[[Job], dict[str, Any]], storing: _Storing) -> dict[str, Any]:
    files = job.target is not None and job.target != STREAM
    like = None
    if files:
        assert job.target is not None
        more = [job.target.with_suffix(ending) for ending in job.beside]
        check_targets([job.target, *more], force=job.force)
        no_file = job.stored or job.source in (STREAM, job.target)
        like = None if no_file else job.source.stat()
    result = work(job)
    if not files:
        for data in job.outputs.values():
            # What is wrong shows at the end; before that nothing must be given.
            _to_stdout(data if isinstance(data, bytes) else b"".join(data))
    elif job.outputs:
        for path in job.outputs:
            path.parent.mkdir(parents=True, exist_ok=True)
        if not any(is_stream(path) for path in job.outputs):  # a FIFO may never be read
            storing.begin(job)
        write_all(job.outputs, force=job.force, like=like, times=job.times, modified=job.modified)
        if job.remove and like:
            _remove(job.source, like)
    return result


def _remove(source: Path, read: os.stat_result) -> None:
    """Remove a file whose output is written, if it is still the file that was read."""
    found = source.lstat()
    if (found.st_ino, found.st_size, found.st_mtime_ns) != (
        read.st_ino,
        read.st_size,
        read.st_mtime_ns,
    ):
        raise ParameterError(
            "not removed, though its output is written: it is a link, or was changed meanwhile",
            file=str(source),
        )
    source.unlink()


def _to_stdout(data: bytes) -> None:
    """Write past the buffer, which would try again at the end what has failed."""
    stdout = getattr(sys.stdout.buffer, "raw", sys.stdout.buffer)
    rest = memoryview(data)
    try:
        while rest:
            rest = rest[stdout.write(rest) :]
    except OSError as error:
        raise OSError(error.errno, error.strerror, "standard output") from error


def _stop(
    signal_number: int,
    jobs: int | None,
    done: "queue.SimpleQueue[Job | int]",
    storing: _Storing,
    report: Report,
    close: Callable[[], None] | None,
) -> NoReturn:
    """Let what is being stored be stored, report it, and end whatever else is running."""
    waited = storing.close() - report.reported
    try:
        while waited or not done.empty():
            job = done.get()
            if isinstance(job, int):  # asked twice
                break
            waited.discard(job)
            with suppress(OSError):  # whoever read what is said may be gone
                report.add(job)
        if close:
            close()
        report.interrupt(jobs)
        sys.stdout.flush()
        sys.stderr.flush()
    finally:  # other threads wait for what was closed, and would be waited for
        os._exit(128 + signal_number)


@contextmanager
def _signals(put: Callable[[int], None]) -> Iterator[None]:
    """Have signals that end the process told as a number first; those ignored stay so."""
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in _ENDING:
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                before[number] = signal.signal(number, lambda number, _: put(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
