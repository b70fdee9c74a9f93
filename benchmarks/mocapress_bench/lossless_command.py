"""``mocapress bench lossless``."""

import json as jsonlib
from pathlib import Path
from typing import Annotated, Any

import typer

from mocapress_bench.inputs import (
    Debug,
    Force,
    Json,
    Markdown,
    clips_named,
    progress_line,
    say,
    usage,
)

_FEW = 10
Plots = Annotated[
    Path | None,
    typer.Option("--plots", help="Draw the figures into this folder.", metavar="FOLDER"),
]
Only = Annotated[
    str,
    typer.Option("--only", help="Codecs, e.g. app:t=10, and tools, separated by commas."),
]
Folds = Annotated[
    int | None,
    typer.Option(
        "--folds",
        min=2,
        help="Also measure codecs with models, cross-validated: folders are dealt to N folds, each "
        "coded with a model of the others.",
        metavar="N",
    ),
]
TrainFrames = Annotated[
    int, typer.Option("--train-frames", min=1, help="Frames that each of these models learns from.")
]
ModelFile = Annotated[
    Path | None, typer.Option("--model", help="Also measure with this model.", metavar="FILE.mcm")
]
Corpus = Annotated[
    str | None,
    typer.Argument(
        help="Folder of clips; without it, the samples of a checkout. With --cluster also a URL, "
        "or a sharded library."
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        help="Measure on a Dask cluster, tcp://HOST:8786, or on N workers that are started here, "
        "local:N. The memory is not measured then.",
        metavar="CLUSTER",
    ),
]
Repeat = Annotated[int, typer.Option("--repeat", min=1, help="Report the best of N runs.")]


def lossless(
    corpus: Corpus = None,
    json: Json = None,
    markdown: Markdown = None,
    plots: Plots = None,
    only: Only = "",
    folds: Folds = None,
    train_frames: TrainFrames = 40_000,
    model: ModelFile = None,
    repeat: Repeat = 1,
    cluster: Cluster = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Compare every lossless codec with each other and with general-purpose tools."""
    from mocapress.errors import CorruptError, ParameterError
    from mocapress_bench import app_figures, learning, tables
    from mocapress_bench.lossless import measure, peak_memory

    if cluster is not None:
        if folds or model or plots or corpus is None:
            usage("--cluster needs a folder, and goes without --folds, --model and --plots")
        rows, notes = _spread(corpus, cluster, only, repeat)
        _report(rows, notes, {}, [], json, markdown, force=force)
        return
    paths, root = clips_named(None if corpus is None else Path(corpus))
    try:
        learned = learning.given(paths, only, model) if model else []
        if folds:
            learned += learning.cross_validated(
                paths, only, folds=folds, most_frames=train_frames, progress=progress_line(0)
            )
        rows, notes = measure(
            paths,
            root,
            only=only,
            learned=learned,
            repeat=repeat,
            progress=progress_line(len(paths)),
        )
    except (ParameterError, CorruptError, FileNotFoundError) as error:
        usage(str(error))
    if not rows:
        say(notes)
        usage("none of the clips can be read")
    largest = max(paths, key=lambda path: path.stat().st_size)
    with_models = {one.name for one in learned}
    names = [name for name in tables.grouped(rows, "codec") if name not in with_models]
    memory = {name: peak_memory(largest, name)["peak_mb"] for name in names}
    more = [app_figures.report(_figures(paths, rows, plots))] if plots else []
    _report(rows, notes, memory, more, json, markdown, force=force)


def _spread(
    corpus: str, cluster: str, only: str, repeat: int
) -> tuple[list[dict[str, Any]], list[str]]:
    from mocapress.errors import MocapressError
    from mocapress_bench.cluster import spread

    try:
        return spread(corpus, cluster, only=only, repeat=repeat, progress=progress_line(0))
    except (MocapressError, OSError) as error:
        usage(str(error))


def _report(
    rows: list[dict[str, Any]],
    notes: list[str],
    memory: dict[str, float],
    more: list[str],
    json: Path | None,
    markdown: Path | None,
    *,
    force: bool,
) -> None:
    """Print the tables and write what is asked for; end with 3 if something did not come back."""
    from mocapress.storage import write_whole
    from mocapress_bench import tables

    say(notes)
    few = len({row["clip"] for row in rows}) <= _FEW
    clips = [tables.by_clip(rows)]
    parts = [tables.totals(rows, memory), tables.by_group(rows), *(clips if few else []), *more]
    for part in parts:
        print(part)
    if json:
        write_whole(json, jsonlib.dumps(rows, indent=1).encode(), force=force)
    if markdown:
        whole = parts if few else [*parts, *clips]
        write_whole(markdown, "\n".join(whole).encode(), force=force)
    if not all(row["exact"] for row in rows):
        say(["not everything was restored exactly"])
        raise typer.Exit(3)


def _figures(paths: list[Path], rows: list[dict[str, Any]], folder: Path) -> dict[str, Any]:
    from mocapress import api
    from mocapress.errors import MocapressError
    from mocapress_bench import app_figures, pareto

    clips = []
    for path in paths:
        try:
            clips.append((api.read(path), path.stat().st_size))
        except MocapressError:
            continue  # said already
    numbers = app_figures.measure(clips, progress_line(0))
    try:
        app_figures.draw(numbers, folder)
        pareto.draw(rows, folder / "ratio_and_speed.png")
    except ImportError:
        usage("--plots needs matplotlib: pip install matplotlib")
    return numbers
