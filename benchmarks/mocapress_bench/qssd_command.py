"""``mocapress bench qssd``."""

import json as jsonlib
from pathlib import Path
from typing import Annotated

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


def qssd(
    corpus: Corpus = None,
    subjects: Annotated[
        str, typer.Option(help="Only these folders of the corpus: 07,08,16,35.")
    ] = "",
    model: Annotated[
        Path | None, typer.Option(help="A dictionary; otherwise one is learned from the clips.")
    ] = None,
    training: Annotated[str, typer.Option(help="How it is learned.")] = "qssd",
    steps: Annotated[str, typer.Option(help="Steps of weights.")] = "0.25,0.5,0.75,1",
    json: Json = None,
    markdown: Markdown = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Measure QSSD on a collection: ratio with everything counted, ARMS, degrees, speed."""
    import mocapress as mp
    from mocapress.storage import write_whole
    from mocapress_bench.qssd import measure, table

    paths, root = clips_named(corpus)
    named = {name for name in subjects.split(",") if name}
    paths = [p for p in paths if not named or named & set(p.relative_to(root).parts)]
    if not paths:
        usage("no clips of these subjects")
    sizes = [float(step) for step in steps.split(",")]
    learned = mp.load_model(model) if model else mp.train(paths, training)
    progress = progress_line(2 * len(paths))
    rows = measure(paths, sizes, learned, held_out=bool(model), progress=progress)
    rows += measure(paths, sizes, None, progress=progress)
    if not rows:
        usage("none of the clips can be read")
    print(table(rows))
    if json:
        write_whole(json, jsonlib.dumps(rows, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, table(rows).encode(), force=force)
