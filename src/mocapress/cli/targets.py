"""Where the outputs of a command go: decided, and checked, before anything is written."""

import os
import sys
import unicodedata
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from mocapress.cli.batch import STREAM, Job, is_folder, usage
from mocapress.cli.report import say
from mocapress.errors import MocapressError
from mocapress.storage import is_stream


def plan(
    jobs: Sequence[Job],
    output: str | None,
    rename: Callable[[Path], Path],
    *,
    force: bool,
    json: bool = False,
    text: bool = True,
    reads: Iterable[Path | None] = (),
    skip: bool = False,
    update: bool = False,
    parents: bool = False,
) -> list[Job]:
    """Give each job its target; end with the exit code of wrong usage where one cannot be.

    Parameters
    ----------
    jobs
        What is to be worked on.
    output
        The file or folder that was asked for; of a folder or of many files it is a folder.
    rename
        Gives the path of an output beside its source.
    force
        Whether outputs may replace files.
    json
        Whether results go to stdout as JSON.
    text
        Whether outputs may go to a terminal.
    reads
        Further files that are read, which no output may replace.
    skip, update
        Whether jobs whose output exists are left out; or only those whose output is as new as the
        source, and the others replaced.
    parents
        Whether all folders above the outputs may be made, and not only the last one of ``output``.

    Returns
    -------
    list
        The jobs, without those that were named twice, and those that were left out.

    """
    many = len(jobs) > 1 or any(job.in_folder for job in jobs)
    if output == "-" or (output is None and jobs[0].source == STREAM):
        _refuse_stdout(many=many, json=json, text=text or force)
        jobs[0].target = STREAM
        return [*jobs]
    if skip + update + force > 1:
        usage("--force, --skip-existing and --update exclude each other")
    folder = _is_folder(output, many=many) if output else False
    if output and not parents:
        _refuse_missing(Path(output) if folder else Path(output).parent)
    for job in jobs:
        job.force = force
        try:
            job.target = _target(job, output, rename, folder=folder)
        except (MocapressError, OSError) as error:
            job.error = error
    planned = [*{(job.source, job.target): job for job in jobs}.values()]
    _refuse_equal(planned)
    refuse_sources(planned, [*(job.source for job in planned), *reads])
    return _left(planned, update=update) if skip or update else planned


def _left(jobs: Sequence[Job], *, update: bool) -> list[Job]:
    """Leave out jobs whose output exists, or is as new as its source; say how many."""
    left = []
    for job in jobs:
        try:
            written = job.target.stat().st_mtime_ns if job.target else None
            job.force = update and written is not None and written < job.source.stat().st_mtime_ns
        except OSError:  # what is wrong is said when the job is done
            written = None
        if written is None or job.force:
            left.append(job)
    if len(left) < len(jobs):
        skipped = len(jobs) - len(left)
        say(f"{skipped} of {len(jobs)} files left out: their outputs exist")
    return left


def _refuse_missing(folder: Path) -> None:
    if not is_folder(folder) and not is_folder(folder.parent):
        usage(f"there is no folder {folder.parent}; -p makes it")


_ARCHIVES = (".zip", ".7z", ".tar", ".gz", ".tgz", ".bz2", ".xz", ".zst", ".mocapdb")


def refuse_other_kinds(output: str | None, allowed: Sequence[str], others: Iterable[str]) -> None:
    """Refuse a file whose suffix contradicts what is written to it."""
    if output is None or is_folder(output):
        return
    name = output.lower()
    if name.endswith(tuple(others)) and not name.endswith(tuple(allowed)):
        usage(f"-o {output}: the ending is that of another kind; expected {' or '.join(allowed)}")


def known_endings() -> tuple[str, ...]:
    """Give the suffixes of all kinds of files that mocapress knows."""
    from mocapress.formats import formats, suffixes

    return (*suffixes(formats()), ".mcz", ".mcm", ".json", ".json.xz", *_ARCHIVES)


def _target(job: Job, output: str | None, rename: Callable[[Path], Path], *, folder: bool) -> Path:
    if output is None:
        return rename(job.source)
    if not folder:
        return Path(output)
    return Path(output) / rename(job.source).relative_to(job.base)


def _is_folder(output: str, *, many: bool) -> bool:
    path = Path(output)
    named = os.path.basename(output) in ("", ".", "..")  # noqa: PTH119 - Path drops the slash
    if is_folder(path):
        return True
    if os.path.exists(path) and (many or named):  # noqa: PTH110 - see is_folder
        usage(f"-o {output} is not a folder, which many files need")
    if many and not named and path.suffix.lower() in (".mcz", ".mcm", ".json", ".xz"):
        usage(f"-o {output} looks like one file, and many are written; {output}/ makes a folder")
    return many or named


def _refuse_stdout(*, many: bool, json: bool, text: bool) -> None:
    if many:
        usage("stdout cannot take many outputs")
    if json:
        usage("stdout cannot take both the output and --json; -o gives the output a file")
    if not text and sys.stdout.isatty():
        usage("compressed data is not written to a terminal; --force does, -o - | ... pipes it")


def _refuse_equal(jobs: Sequence[Job]) -> None:
    """Refuse targets that are the same file, also if only the file system considers them equal."""
    clashes = []
    alike: dict[str, list[Job]] = defaultdict(list)
    for job in jobs:
        if job.target is not None and not _is_stream(job.target):
            real = os.path.realpath(job.target)
            alike[unicodedata.normalize("NFC", real.casefold())].append(job)
    for group in alike.values():
        if len(group) == 1:
            continue
        same: dict[object, list[Job]] = defaultdict(list)
        for job in group:
            found = _identity(job.target)
            same[found or os.path.realpath(str(job.target))].append(job)
            # Where they do exist already, the file system tells them apart. Else the first is
            # written, and the second is not to replace it.
            job.force = job.force and found is not None
        for equal in same.values():
            if len(equal) > 1:
                named = ", ".join(str(job.source) for job in equal)
                clashes.append(f"{equal[0].target} ({named})")
    if clashes:
        usage(f"several inputs have the same output; nothing was written: {'; '.join(clashes)}")


def refuse_sources(jobs: Sequence[Job], reads: Iterable[Path | None]) -> None:
    """Refuse targets that are also inputs, under any name."""
    read = {_identity(path): path for path in reads}
    for job in jobs:
        found = _identity(job.target)
        if found is not None and found in read and not _is_stream(job.target):
            usage(f"{job.target} would overwrite an input, {read[found]}; nothing was written")


def _identity(path: Path | None) -> tuple[int, int] | None:
    try:
        found = os.fstat(0) if path == STREAM else path.stat() if path else None
    except OSError:
        return None
    return (found.st_dev, found.st_ino) if found else None


def _is_stream(path: Path | None) -> bool:
    try:
        return path is None or is_stream(path)
    except OSError:
        return False
