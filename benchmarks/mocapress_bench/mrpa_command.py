"""``mocapress bench mrpa``."""

import json as jsonlib
from collections import defaultdict
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

_WALK = "02_01.amc"
_LONG_ENOUGH = 240
_MOST_TAKES = 24

Plots = Annotated[
    Path | None,
    typer.Option("--plots", help="Draw Figs. 5 to 8 into this folder.", metavar="FOLDER"),
]
Only = Annotated[str, typer.Option("--only", help="Folders below the corpus, separated by commas.")]


def mrpa(
    corpus: Corpus = None,
    only: Only = "",
    json: Json = None,
    markdown: Markdown = None,
    plots: Plots = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Repeat the evaluation of MRPA on libraries, one a folder, and measure what parents bring."""
    from mocapress.errors import MocapressError
    from mocapress.storage import write_whole
    from mocapress_bench import mrpa_tables
    from mocapress_bench.mrpa import measure_library, read_library, sweep
    from mocapress_bench.mrpa_planted import measure_planted

    paths, root = clips_named(corpus)
    folders: dict[str, list[Path]] = defaultdict(list)
    for path in paths:
        folders[str(path.parent.relative_to(root))].append(path)
    wanted = [name for name in only.split(",") if name] or sorted(folders)
    if unknown := set(wanted) - set(folders):
        usage(f"no clips in {', '.join(sorted(unknown))} below {root}")
    show = progress_line(0)
    try:
        libraries = [read_library(name, folders[name]) for name in wanted]
        rows = [measure_library(library, show) for library in libraries]
        smallest = min(libraries, key=lambda library: abs(len(library.values) - 3500))
        swept = sweep(smallest, show)
        show("planted")
        takes = [clip for library in libraries for clip in library.clips]
        alike = [
            clip
            for clip in takes
            if clip.frames >= _LONG_ENOUGH
            and [column.name for column in clip.columns]
            == [column.name for column in takes[0].columns]
        ]
        planted = measure_planted(alike[:_MOST_TAKES])
    except MocapressError as error:
        usage(str(error))
    results: dict[str, Any] = {"libraries": rows, "sweep": swept, "planted": planted}
    parts = [mrpa_tables.ratios(rows), mrpa_tables.counts(rows), mrpa_tables.times(rows)]
    walks = [path for path in paths if path.name == _WALK]
    if walks:
        results["walk"] = sweep(read_library(_WALK, walks[:1]), show)
        parts.append(mrpa_tables.walk(results["walk"]))
    parts += [f"{smallest.name}:\n", mrpa_tables.swept(swept), mrpa_tables.planted(planted)]
    if plots:
        try:
            mrpa_tables.draw(swept, plots)
        except ImportError:
            usage("--plots needs matplotlib: pip install matplotlib")
    for part in parts:
        print(part)
    if json:
        write_whole(json, jsonlib.dumps(results, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, "\n".join(parts).encode(), force=force)
