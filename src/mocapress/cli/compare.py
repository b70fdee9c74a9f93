"""``compare``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.options import Asf, Debug, Force, Json, Lenient, Limit, Models

if TYPE_CHECKING:
    from mocapress.cli.batch import Job
    from mocapress.motion.kinematics import Array

_SHOWN = 10
"""Rows of each table, those of the largest errors; with --all, every one."""


def compare(
    first: Annotated[Path, typer.Argument(help="A motion file or .mcz.", show_default=False)],
    second: Annotated[Path, typer.Argument(help="The one to compare with it.", show_default=False)],
    largest: Annotated[
        float | None,
        typer.Option(
            "--max",
            help="Exit code 3 if a value differs by more, in the unit of its channel.",
            metavar="ERROR",
            min=0,
        ),
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help=f"All channels and joints, not the {_SHOWN} worst.")
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            "--picture",
            help="Draw errors over time by joint, and the worst frame. Needs Pillow.",
            metavar="OUT.png",
        ),
    ] = None,
    asf: Asf = None,
    models: Models = None,
    limit: Limit = None,
    lenient: Lenient = False,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Compare two clips of the same motion: errors by channel, joint and bone, and the PSNR."""
    from mocapress import api
    from mocapress.cli.batch import Job, run
    from mocapress.cli.models import open_models, places_for
    from mocapress.cli.pictures import check_kind, write_picture
    from mocapress.difference_picture import draw_difference
    from mocapress.errors import MocapressError, VerificationError
    from mocapress.motion.comparing import compare as measured
    from mocapress.storage import check_targets

    given = open_models(models or [])
    if picture is not None:
        check_kind(picture, "--picture")

    def work(job: "Job") -> dict[str, Any]:
        if picture is not None:
            check_targets([picture], force=force)
        clips = []
        for path in (first, second):
            source = Job(path, path.parent).opened(limit)
            places = places_for(job, given)
            try:
                clips.append(api.read_source(source, asf, models=places, strict=not lenient))
            except MocapressError as error:
                error.file = error.file or str(path)
                raise
        found = measured(*clips)
        if picture is not None:
            drawn = draw_difference(clips[0], clips[1], found, (str(first), str(second)))
            write_picture(picture, drawn, force=force)
        facts: dict[str, Any] = {
            "second": str(second),
            "frames": len(clips[0]),
            "largest_error": found.most,
            "psnr": found.psnr,
            "picture": None if picture is None else str(picture),
            "channels": _rows(found.channels, found.largest, found.mean),
            "joints": _rows(found.joints, found.largest_distance, found.mean_distance),
            "bones": _rows(found.bones, found.largest_drift, found.mean_drift),
        }
        if largest is not None and found.most > largest:
            raise VerificationError(
                f"differs from {second}",
                file=str(first),
                expected=f"errors up to {largest:g}",
                found=f"{found.most:g} in {max(facts['channels'], key=_size)['name']}",
            )
        return facts

    def show(job: "Job") -> None:
        facts = job.result
        print(
            f"{first} and {second}: {facts['frames']} frames, "
            f"largest error {facts['largest_error']:.6g}, PSNR {facts['psnr']:.2f} dB"
        )
        for what in ("channels", "joints", "bones"):
            rows = sorted(facts[what], key=_size, reverse=True)
            if rows and facts["largest_error"]:
                heading = "length between" if what == "bones" else what[:-1]
                print(f"{heading:<32} {'largest':>12} {'mean':>12}")
            for row in rows[: None if everything else _SHOWN] if facts["largest_error"] else ():
                print(f"{row['name']:<32} {row['largest']:>12.6g} {row['mean']:>12.6g}")

    run([Job(first, first.parent)], work, json=json, show=show, failure_code=3, debug=debug)


def _rows(
    names: tuple[str, ...], largest: "Array | None", mean: "Array | None"
) -> list[dict[str, Any]]:
    if largest is None or mean is None:
        return []
    return [
        {"name": name, "largest": float(most), "mean": float(usual)}
        for name, most, usual in zip(names, largest, mean, strict=True)
    ]


def _size(row: dict[str, Any]) -> float:
    return float(row["largest"])
