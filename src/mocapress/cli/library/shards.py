"""Commands over the shards of a sharded library: each job is a shard, done here or elsewhere."""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from mocapress.cli.batch import Job, run
from mocapress.cli.report import say
from mocapress.codecs import Codec
from mocapress.errors import CorruptError
from mocapress.library.clips import StoredClip
from mocapress.library.sharded import (
    ShardedLibrary,
    archives,
    building,
    manifest,
    publishing,
    remaking,
)
from mocapress.library.sharded.building import Adding, Made
from mocapress.library.sharded.executor import Executor, executor
from mocapress.library.sharded.manifest import shard_file
from mocapress.library.sharded.planning import Plan
from mocapress.library.sharded.remaking import Recoding
from mocapress.library.sharded.store import Store

ADDED, RECODED = ("raw_bytes", "stored_bytes"), ("bytes_before", "bytes_after")
publishing_lock = threading.Lock()
"""Held while the manifest is changed: the threads of a job would only have to try again."""


def add_shards(
    library: ShardedLibrary,
    plans: Sequence[Plan],
    *,
    labels: Sequence[str] = (),
    cluster: str | None,
    jobs: int,
    json: bool,
    quiet: bool,
    debug: bool,
) -> None:
    """Add files, a shard's worth at a time."""
    there = [name for plan in plans for name in plan.there]
    if labels and there:
        library.label_all((name for name in there if name in library), labels)
    of_job: dict[Job, Adding] = {}

    def work(job: Job, where: Executor) -> dict[str, Any]:
        task = of_job[job]
        try:
            made = where.call(building.add, task)
        finally:
            task.discard()
        with publishing_lock:
            publishing.publish_added(library.store, made, labels)
        there.extend(made.touched)
        return _facts(made) | {
            "files": len(task.files) - len(made.failed) - len(made.touched),
            "unchanged": [*made.touched],
            "raw_bytes": made.raw,
            "stored_bytes": sum(made.shards.values()),
        }

    def show(job: Job) -> None:
        found = job.result
        _tell(job)
        if found["files"] or not found["unchanged"]:
            print(f"{_shards(job)}: {found['files']} files, {_sizes([job], *ADDED)}")

    def total(done: list[Job]) -> None:
        files = sum(job.result["files"] for job in done)
        print(f"{library.url}: {files} added, {len(there)} unchanged; {_sizes(done, *ADDED)}")

    tasks = [task for plan in plans for task in plan.tasks]
    if not (tasks or json or quiet or any(plan.faults for plan in plans)):
        print(f"{library.url}: {len(there)} unchanged")
    with archives.place_for(library.store, cluster) as place:
        coming = _coming(plans, place, of_job)
        _run(
            coming if any(plan.archive for plan in plans) else [*coming],
            work,
            cluster,
            jobs if len(tasks) > 1 else 1,
            json=json,
            quiet=quiet,
            show=show,
            total=total,
            debug=debug,
            whole=sum(task.size for task in tasks),
        )
        for task in (task for plan in plans for task in plan.left(library.store, place)):
            publishing.publish_added(library.store, building.add(task), labels)
    _end_if_failed(of_job)


def _coming(plans: Iterable[Plan], place: Store, of_job: dict[Job, Adding]) -> Iterator[Job]:
    """Give the jobs of tasks as these are ready, and failed ones of what cannot be read."""
    for plan in plans:
        for task in plan.ready(place):
            job = Job(Path(f"{task.source.file(task.files[0].name)} and on"), Path())
            job.share, of_job[job] = task.size, task
            yield job
        for error in plan.faults:
            failed = Job(Path(error.file or ""), Path(), stored=True)
            failed.error = error
            yield failed


def _end_if_failed(jobs: Iterable[Job]) -> None:
    """End with an exit code if files of shards failed."""
    if any(job.result.get("failed") for job in jobs):
        raise typer.Exit(1)


def verify_shards(
    library: ShardedLibrary,
    clips: Sequence[StoredClip],
    *,
    cluster: str | None,
    jobs: int,
    json: bool,
    quiet: bool,
    debug: bool,
) -> None:
    """Check clips, a shard at a time."""
    of_job = {
        Job(Path(shard_file(task.shard)), Path(), stored=True, share=task.size): task
        for task in library.reading_tasks(clips)
    }

    def work(job: Job, where: Executor) -> dict[str, Any]:
        faults = where.call(remaking.verify, of_job[job])
        if faults:
            what = "; ".join(f"{name}: {fault}" for name, fault in faults)
            raise CorruptError(what, file=str(job.source))
        return {"ok": True, "clips": len(of_job[job].clips)}

    _run(
        list(of_job),
        work,
        cluster,
        jobs,
        json=json,
        quiet=quiet,
        show=lambda job: print(f"{job.source}: {job.result['clips']} clips, ok"),
        total=lambda done: print(f"{sum(job.result['clips'] for job in done)} clips are sound"),
        debug=debug,
        failure_code=3,
    )


def recompress_shards(
    library: ShardedLibrary,
    clips: Sequence[StoredClip],
    codec: Codec,
    *,
    cluster: str | None,
    jobs: int,
    json: bool,
    quiet: bool,
    debug: bool,
) -> None:
    """Code clips anew, a shard at a time; shards that are coded in this way already stay."""

    def show(job: Job) -> None:
        _tell(job)
        print(f"{job.source}: {_sizes([job], *RECODED)}, now {_shards(job)}")

    def total(done: list[Job]) -> None:
        print(f"{len(done)} shards: {_sizes(done, *RECODED)}")

    tasks = library.remaking(clips, codec)
    if not (tasks or json or quiet):
        print(f"{library.url}: all are coded in this way already")
    _remake(library, tasks, cluster, jobs, json, quiet, debug, show, total)


def reindex_shards(
    library: ShardedLibrary,
    joints: Mapping[str, str] | None,
    *,
    cluster: str | None,
    jobs: int,
    json: bool,
    quiet: bool,
    debug: bool,
) -> None:
    """Make the index for search anew, a shard at a time."""

    def counted(job: Job) -> str:
        without = job.result["without"]
        more = f", {without} without a body to be searched" if without else ""
        return f"{job.result['indexed']} clips indexed{more}"

    def show(job: Job) -> None:
        _tell(job)
        print(f"{job.source}: {counted(job)}, now {_shards(job)}")

    def total(done: list[Job]) -> None:
        print(f"{library.url}: {sum(job.result['indexed'] for job in done)} clips indexed")

    _remake(library, library.reindexing(joints), cluster, jobs, json, quiet, debug, show, total)


def _remake(
    library: ShardedLibrary,
    tasks: Sequence[Recoding],
    cluster: str | None,
    jobs: int,
    json: bool,
    quiet: bool,
    debug: bool,
    show: Callable[[Job], None],
    total: Callable[[list[Job]], None],
) -> None:
    """Make shards anew; each takes the place of the old one when it is made."""
    of_job = {
        Job(Path(shard_file(task.of.shard)), Path(), stored=True, share=task.of.size): task
        for task in tasks
    }

    def work(job: Job, where: Executor) -> dict[str, Any]:
        task = of_job[job]
        made = where.call(remaking.remake, task)
        with publishing_lock:
            manifest.publish(library.store, publishing.with_remade(task.of.shard, made))
        (before, after), (indexed, without) = made.sizes, made.indexed
        sizes = {"bytes_before": before, "bytes_after": after}
        counts = {"indexed": indexed, "without": without}
        return _facts(made) | (counts if task.indexed else sizes)

    _run(
        list(of_job),
        work,
        cluster,
        jobs,
        json=json,
        quiet=quiet,
        show=show,
        total=total,
        debug=debug,
    )
    _end_if_failed(of_job)


def _run(
    jobs_there: Iterable[Job],
    work: Callable[[Job, Executor], dict[str, Any]],
    cluster: str | None,
    jobs: int,
    *,
    json: bool,
    quiet: bool,
    show: Callable[[Job], None],
    total: Callable[[list[Job]], None],
    debug: bool,
    failure_code: int = 1,
    whole: float | None = None,
) -> None:
    """Do the tasks of jobs where they are to be done."""
    alone = isinstance(jobs_there, Sequence) and len(jobs_there) < 2
    with executor(cluster, 1 if alone else jobs) as where:
        run(
            jobs_there,
            lambda job: work(job, where),
            threads=where.width,
            json=json,
            quiet=quiet,
            show=show,
            total=total,
            failure_code=failure_code,
            debug=debug,
            whole=whole,
            close=where.stop,
        )


def _facts(made: Made) -> dict[str, Any]:
    return {
        "shards": [*made.shards],
        "failed": [{"file": name, "what": what} for name, what in made.failed],
        "file_warnings": [{"file": name, "what": what} for name, what in made.warnings],
    }


def _tell(job: Job) -> None:
    """Say which files of a shard failed, and what was noticed."""
    for fault in job.result["failed"]:
        say(f"{fault['file']}: {fault['what']}")
    for warning in job.result["file_warnings"]:
        say(f"warning: {warning['file']}: {warning['what']}")


def _shards(job: Job) -> str:
    return ", ".join(shard_file(name) for name in job.result["shards"]) or "no shard"


def _sizes(jobs: Iterable[Job], before: str, after: str) -> str:
    done = [job.result for job in jobs]
    return f"{sum(r[before] for r in done)} -> {sum(r[after] for r in done)} bytes"
