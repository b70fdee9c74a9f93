"""``mocapress bench qssd-model``."""

import json as jsonlib
import warnings
from math import inf
from pathlib import Path
from typing import Annotated, Any

import typer

from mocapress_bench.inputs import (
    Corpus,
    Debug,
    Force,
    Json,
    Markdown,
    clips_named,
    progress_line,
    usage,
)

_SETS = {"walking": ("07", "08", "16", "35"), "mixed": ("01", "02", "05", "06", "09", "12")}
_NOISES = (inf, 100.0, 40.0)


def qssd_model(
    corpus: Corpus = None,
    frames: Annotated[int, typer.Option(help="Frames of motion that are decomposed.")] = 3000,
    atoms: Annotated[int, typer.Option(help="K on motion; the paper: 2000.")] = 200,
    most: Annotated[int, typer.Option(help="L on motion.")] = 15,
    iterations: Annotated[int, typer.Option(help="On motion; the paper: 50.")] = 8,
    splits: Annotated[int, typer.Option(help="Into training and test; the paper: 10.")] = 2,
    coefficients: Annotated[
        str, typer.Option(help="Deviation of made-up coefficients, radians; 0: as printed.")
    ] = "0.5,1,2,0",
    simulated: Annotated[int, typer.Option(help="Iterations on made-up data.")] = 100,
    times: Annotated[
        str, typer.Option(help="Frames whose iterations are timed; nothing: none.")
    ] = "1000,5000",
    seed: Annotated[int, typer.Option(help="Of made-up data.")] = 0,
    json: Json = None,
    markdown: Markdown = None,
    plots: Annotated[
        Path | None, typer.Option("--plots", help="Draw Fig. 1 into this folder.", metavar="FOLDER")
    ] = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Repeat section 4 of the QSSD paper: simulation, errors on motion, time an iteration."""
    import mocapress as mp
    from mocapress.storage import write_whole
    from mocapress_bench import qssd_model as model
    from mocapress_bench import qssd_model_tables as tables

    paths, root = clips_named(corpus)
    show = progress_line(0)
    sets = {
        name: [path for path in paths if {*folders} & {*path.relative_to(root).parts}]
        for name, folders in _SETS.items()
    }
    sets = {name: own for name, own in sets.items() if own} or {"all clips": paths}
    results: dict[str, Any] = {"simulation": [], "errors": {}, "times": []}
    parts = []
    if coefficients and simulated > 0:
        results["simulation"] = model.simulate(
            model.MadeUp(),
            [float(size) for size in coefficients.split(",")],
            _NOISES,
            iterations=simulated,
            seed=seed,
            progress=show,
        )
        parts.append(tables.simulated(results["simulation"]))
    turns = None
    for name, own in sets.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mp.MotionWarning)
            clips = [mp.read(path) for path in own]
        if not any(clip.skeleton for clip in clips):
            usage("the clips have no skeletons")
        turns = model.turns_of([clip for clip in clips if clip.skeleton], frames)
        if len(turns) < 2 * atoms:
            usage(f"{len(turns)} frames are too few for {atoms} atoms")
        rows = model.errors_on_motion(turns, atoms, most, iterations, splits, show)
        results["errors"][name] = rows
        parts.append(tables.errors(name, rows))
        if times and not results["times"]:
            counts = [int(count) for count in times.split(",")]
            timed = model.turns_of([clip for clip in clips if clip.skeleton], max(counts))
            results["times"] = model.times(timed, counts, show)
    if results["times"]:
        parts.append(tables.times(results["times"]))
    for part in parts:
        print(part)
    if plots and results["simulation"]:
        try:
            tables.draw(results["simulation"], plots)
        except ImportError:
            usage("--plots needs matplotlib: pip install matplotlib")
    if json:
        write_whole(json, jsonlib.dumps(results, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, "\n".join(parts).encode(), force=force)
