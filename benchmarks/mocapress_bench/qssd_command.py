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

Subjects = Annotated[
    str, typer.Option("--subjects", help="Only these folders of the corpus: 07,08,16,35.")
]


def qssd(
    corpus: Corpus = None,
    subjects: Subjects = "",
    model: Annotated[
        Path | None, typer.Option(help="A dictionary; otherwise one is learned from the clips.")
    ] = None,
    learn_from: Annotated[
        str, typer.Option(help="Learn from these folders alone; the other clips are held out.")
    ] = "",
    sizes: Annotated[
        str, typer.Option(help="Measure so many clips of the collection, too: 10,20,40.")
    ] = "",
    training: Annotated[str, typer.Option(help="How it is learned.")] = "qssd",
    steps: Annotated[str, typer.Option(help="Steps of weights.")] = "0.25,0.5,0.75,1",
    options: Annotated[
        str, typer.Option(help="Further parameters of the codec: protect=0.1.")
    ] = "",
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
    paths = of_subjects(paths, root, subjects)
    widths = [float(step) for step in steps.split(",")]
    progress = progress_line(0)
    rows = []
    if model:
        told = f"dictionary {model.name}"
        rows += measure(paths, widths, mp.load_model(model), told, progress, options)
    elif learn_from:
        seen = of_subjects(paths, root, learn_from)
        others = [path for path in paths if path not in set(seen)]
        if not others:
            usage("--learn-from leaves no clips to hold out")
        learned = mp.train(seen, training)
        rows += measure(
            seen, widths, learned, "clips that the dictionary has seen", progress, options
        )
        rows += measure(others, widths, learned, "clips held out", progress, options)
        rows += measure(
            others, widths, None, "the same clips without a dictionary", progress, options
        )
    else:
        for count in [int(size) for size in sizes.split(",") if size] + [len(paths)]:
            some = paths[:: -(-len(paths) // count)] if 0 < count < len(paths) else paths
            learned = mp.train(some, training)
            rows += measure(
                some, widths, learned, f"dictionary of these {len(some)}", progress, options
            )
        rows += measure(paths, widths, None, "without a dictionary", progress, options)
    if not rows:
        usage("none of the clips can be read")
    print(table(rows))
    if json:
        write_whole(json, jsonlib.dumps(rows, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, table(rows).encode(), force=force)


def of_subjects(paths: list[Path], root: Path, subjects: str) -> list[Path]:
    """Choose the clips in these folders, all where none is named."""
    named = {name for name in subjects.split(",") if name}
    chosen = [p for p in paths if not named or named & set(p.relative_to(root).parts)]
    if not chosen:
        usage(f"no clips in folders {subjects}")
    return chosen
