"""Progress over many files, on a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Advance = Callable[[str, float], None]
"""Told of each file that is done: its name, and how many bytes it was."""


@contextmanager
def bar(whole: float | None, jobs: int | None) -> Iterator[Advance]:
    """Show the file done last, how many are done, MB/s and the time left, below the results.

    Parameters
    ----------
    whole
        Bytes of all files; None where that is not known.
    jobs
        How many files there are, as far as known. A single one has no progress.

    """
    if jobs == 1 or not sys.stderr.isatty():
        yield lambda _name, _share: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    of = "" if jobs is None else f"/{jobs}"
    with Progress(
        TextColumn("{task.fields[done]}" + of),
        BarColumn(20),
        TextColumn("{task.fields[speed]}"),
        TimeRemainingColumn(),
        TextColumn("{task.description}", markup=False),
        console=Console(stderr=True),
        transient=True,
        redirect_stdout=sys.stdout.isatty(),
    ) as shown:
        task = shown.add_task("", total=whole or None, done=0, speed="")
        done = 0

        def advance(name: str, share: float) -> None:
            nonlocal done
            done += 1
            shown.update(task, description=name, done=done)
            shown.advance(task, share)
            of_task = shown.tasks[0]
            if of_task.elapsed:
                speed = of_task.completed / of_task.elapsed / 1e6
                shown.update(task, speed=f"{speed:.1f} MB/s")

        yield advance
