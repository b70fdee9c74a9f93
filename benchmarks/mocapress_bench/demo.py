"""``mocapress bench demo``: the samples, compressed and restored; needs no rival installed."""

import sys

import typer

from mocapress_bench.inputs import Debug, clips_named, say


def demo(debug: Debug = False) -> None:  # noqa: ARG001
    """Compress and restore the samples of a checkout with every codec, beside gzip and xz."""
    from rich.console import Console
    from rich.table import Table

    from mocapress import codecs
    from mocapress_bench.lossless import measure

    paths, root = clips_named(None)
    lossless = [name for name in codecs.codec_ids() if codecs.codec(name).lossless]
    rows, notes = measure(paths, root, only=",".join([*lossless, "gzip -9", "xz -9e"]))
    say(notes)
    table = Table(title="Compressed, restored and compared with the original by SHA-256")
    for name in (
        "clip",
        "codec",
        "bytes",
        "compressed",
        "ratio",
        "encode, µs/frame",
        "decode",
        "restored (SHA-256)",
    ):
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
