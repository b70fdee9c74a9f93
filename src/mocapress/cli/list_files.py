"""``list``."""

from typing import TYPE_CHECKING, Any

from mocapress.cli.options import Debug, Inputs, Jobs, Json

if TYPE_CHECKING:
    from mocapress.cli.batch import Job


def list_files(
    inputs: Inputs,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """List .mcz files, one a line: sizes in bytes, ratio, frames, codec and name."""
    from mocapress.cli.batch import find, run
    from mocapress.cli.paging import paged

    files = find(inputs, (".mcz",))
    with paged(not json) as paging:
        if not json:
            print(_HEAD)
        run(
            files,
            _work,
            threads=jobs,
            json=json,
            show=_show,
            total=_total,
            debug=debug,
            progress=not paging,
        )


_HEAD = f"{'compressed':>12} {'original':>12} {'ratio':>7} {'frames':>9}  {'codec':<16} name"


def _work(job: "Job") -> dict[str, Any]:
    from mocapress import api, codecs

    opened = api.Opened(job.opened())
    mcz, original = opened.mcz, opened.mcz.original
    return {
        "compressed_bytes": mcz.size,
        "raw_bytes": original.size if original else None,
        "ratio": original.size / mcz.size if original else None,
        "frames": opened.frames() if opened.streams else None,
        "codec": codecs.spec(opened.codec()) if opened.streams else "general-purpose",
        "lossless": opened.codec().lossless if opened.streams else True,
        "name": (original.name if original else "") or None,
    }


def _show(job: "Job") -> None:
    facts = job.result
    frames = "-" if facts["frames"] is None else str(facts["frames"])
    print(f"{_sizes([job])} {frames:>9}  {facts['codec']:<16} {job.source}")


def _total(jobs: "list[Job]") -> None:
    frames = sum(job.result["frames"] or 0 for job in jobs)
    print(f"{_sizes(jobs)} {frames:>9}  {len(jobs)} files")


def _sizes(jobs: "list[Job]") -> str:
    """Give sizes and ratio of files, as far as they hold an original."""
    small = sum(job.result["compressed_bytes"] for job in jobs)
    if any(job.result["raw_bytes"] is None for job in jobs):
        return f"{small:>12} {'-':>12} {'-':>7}"
    raw = sum(job.result["raw_bytes"] for job in jobs)
    return f"{small:>12} {raw:>12} {raw / small:>7.2f}"
