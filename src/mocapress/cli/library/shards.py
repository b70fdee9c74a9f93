"""Commands over the shards of a sharded library: each job is a shard, done here or elsewhere."""

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from mocapress.cli.batch import Job, run
from mocapress.cli.report import say
from mocapress.codecs import Codec, Model
from mocapress.errors import CorruptError
from mocapress.library.clips import StoredClip
from mocapress.library.sharded import ShardedLibrary, building, manifest, publishing
from mocapress.library.sharded.building import Made
from mocapress.library.sharded.executor import Executor, executor
from mocapress.library.sharded.manifest import shard_file

ADDED, RECODED = ("raw_bytes", "stored_bytes"), ("bytes_before", "bytes_after")
publishing_lock = threading.Lock()
"""Held while the manifest is changed: the threads of a job would only have to try again."""


def add_shards(
    library: ShardedLibrary | None,
    inputs: Sequence[str],
    into: str,
    *,
    codec: Codec,
    model: Model | None,
    labels: Sequence[str],
    index: bool,
    cluster: str | None,
    jobs: int,
    json: bool,
    debug: bool,
) -> None:
    """Add files, a shard's worth at a time."""
    assert library is not None
    plans = [
        library.plan(name, into, codec=codec, model=model, labels=labels, index=index)
        for name in inputs
    ]
    there = [name for plan in plans for name in plan.there]
    if labels and there:
        library.label_all((name for name in there if name in library), labels)
    tasks = [task for plan in plans for task in plan.tasks]
    of_job = {
        Job(Path(f"{task.source.file(task.files[0].name)} and on"), Path(), share=task.size): task
        for task in tasks
    }

    def work(job: Job, where: Executor) -> dict[str, Any]:
        task = of_job[job]
        made = where.call(building.add, task)
        with publishing_lock:
            manifest.publish(library.store, publishing.with_added(library.store, made))
        return _facts(made) | {
            "files": len(task.files) - len(made.failed),
            "raw_bytes": made.raw,
            "stored_bytes": sum(made.shards.values()),
        }

    def show(job: Job) -> None:
        found = job.result
        _tell(job)
        print(f"{_shards(job)}: {found['files']} files, {_sizes([job], *ADDED)}")

    def total(done: list[Job]) -> None:
        files = sum(job.result["files"] for job in done)
        print(f"{library.url}: {files} added, {len(there)} unchanged; {_sizes(done, *ADDED)}")

    if not tasks and not json:
        print(f"{library.url}: {len(there)} unchanged")
    _run(of_job, work, cluster, jobs, json=json, show=show, total=total, debug=debug)
    library.refresh(manifest.load(library.store))
    for name in inputs if tasks else ():
        # Skeletons that no clip has had.
        for task in library.plan(name, into, codec=codec, model=model, labels=labels).tasks:
            library.publish(building.add(task))


def verify_shards(
    library: ShardedLibrary,
    clips: Sequence[StoredClip],
    *,
    cluster: str | None,
    jobs: int,
    json: bool,
    debug: bool,
) -> None:
    """Check clips, a shard at a time."""
    of_job = {
        Job(Path(shard_file(task.shard)), Path(), stored=True, share=task.size): task
        for task in library.reading_tasks(clips)
    }

    def work(job: Job, where: Executor) -> dict[str, Any]:
        faults = where.call(building.verify, of_job[job])
        if faults:
            what = "; ".join(f"{name}: {fault}" for name, fault in faults)
            raise CorruptError(what, file=str(job.source))
        return {"ok": True, "clips": len(of_job[job].clips)}

    _run(
        of_job,
        work,
        cluster,
        jobs,
        json=json,
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
    debug: bool,
) -> None:
    """Code clips anew, a shard at a time; shards that are coded in this way already stay."""
    of_job = {
        Job(Path(shard_file(task.of.shard)), Path(), stored=True, share=task.of.size): task
        for task in library.remaking(clips, codec)
    }

    def work(job: Job, where: Executor) -> dict[str, Any]:
        task = of_job[job]
        made = where.call(building.remake, task)
        with publishing_lock:
            manifest.publish(library.store, publishing.with_remade(task.of.shard, made))
        before, after = made.sizes
        return _facts(made) | {"bytes_before": before, "bytes_after": after}

    def show(job: Job) -> None:
        _tell(job)
        print(f"{job.source}: {_sizes([job], *RECODED)}, now {_shards(job)}")

    def total(done: list[Job]) -> None:
        print(f"{len(done)} shards: {_sizes(done, *RECODED)}")

    if not of_job and not json:
        print(f"{library.url}: all are coded in this way already")
    _run(of_job, work, cluster, jobs, json=json, show=show, total=total, debug=debug)


def _run(
    of_job: Mapping[Job, Any],
    work: Callable[[Job, Executor], dict[str, Any]],
    cluster: str | None,
    jobs: int,
    *,
    json: bool,
    show: Callable[[Job], None],
    total: Callable[[list[Job]], None],
    debug: bool,
    failure_code: int = 1,
) -> None:
    """Do the tasks of jobs where they are to be done; end with an exit code if files failed."""
    with executor(cluster, jobs if len(of_job) > 1 else 1) as where:
        run(
            list(of_job),
            lambda job: work(job, where),
            threads=where.width,
            json=json,
            show=show,
            total=total,
            failure_code=failure_code,
            debug=debug,
            whole=sum(job.share for job in of_job),
            close=where.stop,
        )
    if any(job.result.get("failed") for job in of_job):
        raise typer.Exit(failure_code)


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
