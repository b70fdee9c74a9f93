"""``bench diffma``."""

import json as jsonlib
from pathlib import Path

import typer

from mocapress.bench import diffma, diffma_tables
from mocapress.bench.lossless import clips_in
from mocapress.cli.batch import usage
from mocapress.cli.bench import progress_line, sample_folder
from mocapress.storage import write_whole


def bench_diffma_files(
    corpus: Path | None, *, json: Path | None, markdown: Path | None, force: bool
) -> None:
    """Measure, print the tables, and write what was asked for."""
    folder = corpus or sample_folder()
    paths = clips_in(folder) if folder.is_dir() else [folder]
    root = folder if folder.is_dir() else folder.parent
    if not paths:
        usage(f"no AMC or BVH files in {folder}")
    rows, notes = diffma.measure(paths, root, progress=progress_line(len(paths)))
    for note in notes:
        typer.echo(f"mocapress: {note}", err=True)
    if not rows:
        usage("none of the clips can be read")
    longest = max(rows, key=lambda row: row["frames"] * row["channels"])
    parts = [diffma_tables.report(rows), diffma_tables.speeds(diffma.speed(root / longest["clip"]))]
    for part in parts:
        print(part)
    if json:
        write_whole(json, jsonlib.dumps(rows, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, "\n".join(parts).encode(), force=force)
