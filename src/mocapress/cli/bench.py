"""``bench``."""

import json as jsonlib
import sys
from pathlib import Path
from typing import Any

import typer

from mocapress import api, codecs
from mocapress.bench import app_figures, learning, lossless, pareto, tables
from mocapress.cli.batch import usage
from mocapress.errors import CorruptError, MocapressError, ParameterError
from mocapress.storage import write_whole

_FEW = 10


def bench_lossless_files(
    corpus: Path | None,
    *,
    json: Path | None,
    markdown: Path | None,
    plots: Path | None,
    only: str,
    folds: int | None,
    model: Path | None,
    train_frames: int,
    repeat: int,
    force: bool,
) -> None:
    """Measure, print the totals, and write what was asked for."""
    folder = corpus or sample_folder()
    paths = lossless.clips_in(folder) if folder.is_dir() else [folder]
    root = folder if folder.is_dir() else folder.parent
    if not paths:
        usage(f"no AMC or BVH files in {folder}")
    try:
        learned = learning.given(paths, only, model) if model else []
        if folds:
            learned += learning.cross_validated(
                paths, only, folds=folds, most_frames=train_frames, progress=progress_line(0)
            )
        rows, notes = lossless.measure(
            paths,
            root,
            only=only,
            learned=learned,
            repeat=repeat,
            progress=progress_line(len(paths)),
        )
    except (ParameterError, CorruptError, FileNotFoundError) as error:
        usage(str(error))
    for note in notes:
        typer.echo(f"mocapress: {note}", err=True)
    if not rows:
        usage("none of the clips can be read")
    largest = max(paths, key=lambda path: path.stat().st_size)
    with_models = {one.name for one in learned}
    names = [name for name in tables.grouped(rows, "codec") if name not in with_models]
    memory = {name: lossless.peak_memory(largest, name)["peak_mb"] for name in names}
    parts = [tables.totals(rows, memory), tables.by_group(rows)]
    if len(paths) <= _FEW:
        parts.append(tables.by_clip(rows))
    if plots:
        numbers = _figures(paths, rows, plots)
        parts.append(app_figures.report(numbers))
    for part in parts:
        print(part)
    if json:
        write_whole(json, jsonlib.dumps(rows, indent=1).encode(), force=force)
    if markdown:
        whole = parts if len(paths) <= _FEW else [*parts, tables.by_clip(rows)]
        write_whole(markdown, "\n".join(whole).encode(), force=force)
    if not all(row["exact"] for row in rows):
        typer.echo("mocapress: not everything was restored exactly", err=True)
        raise typer.Exit(3)


def demo_files() -> None:
    """Compress and restore the samples with every lossless codec, beside gzip, xz and zstd."""
    from rich.console import Console
    from rich.table import Table

    folder = sample_folder()
    lossless_ids = [name for name in codecs.codec_ids() if codecs.codec(name).lossless]
    names = [*lossless_ids, "gzip -9", "xz -9e", "zstd -22"]
    rows, notes = lossless.measure(lossless.clips_in(folder), folder, only=",".join(names))
    for note in notes:
        typer.echo(f"mocapress: {note}", err=True)
    table = Table(title="Compressed, restored and compared with the original by SHA-256")
    for name in ("clip", "codec", "raw", "compressed", "ratio", "µs/frame", "back", "restored"):
        table.add_column(name, justify="left" if name in ("clip", "codec") else "right")
    last = None
    for row in rows:
        same = "[green]same[/]" if row["exact"] else "[bold red]DIFFERS[/]"
        table.add_row(
            row["clip"] if row["clip"] != last else "",
            row["codec"],
            f"{row['raw_bytes']:,}",
            f"{row['compressed_bytes']:,}",
            f"{row['raw_bytes'] / row['compressed_bytes']:.2f}",
            f"{row['encode_us_per_frame']:.1f}",
            f"{row['decode_us_per_frame']:.1f}",
            f"{row['sha256'][:8]} {same}",
        )
        last = row["clip"]
    Console(width=None if sys.stdout.isatty() else 110).print(table)
    if not all(row["exact"] for row in rows):
        raise typer.Exit(3)


def _figures(paths: list[Path], rows: list[tables.Row], folder: Path) -> dict[str, Any]:
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
        usage("--plots needs matplotlib: pip install 'mocapress[bench]'")
    return numbers


def sample_folder() -> Path:
    """Give the samples of a checkout."""
    checkout = Path(lossless.__file__).parents[3] / "samples"
    if not checkout.is_dir():
        usage("name a folder of clips")
    return checkout


def progress_line(total: int) -> Any:
    """Give what to call with each clip's name: shows it, and how far one has come."""
    count = 0

    def show(what: str) -> None:
        nonlocal count
        count += 1
        if sys.stderr.isatty():
            typer.echo(f"\r\033[K{f'{count}/{total} ' if total else ''}{what}", err=True, nl=False)

    return show
