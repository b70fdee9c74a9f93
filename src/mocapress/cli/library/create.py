"""``library create``."""

from pathlib import Path
from typing import Annotated

import typer

from mocapress.cli.library.opening import File, telling
from mocapress.cli.options import Debug


def create(
    file: File,
    shard_size: Annotated[
        str | None,
        typer.Option(
            "--shard-size",
            help="Of a sharded library: bytes of a shard, e.g. 64MB; 256MB without it.",
            metavar="SIZE",
        ),
    ] = None,
    index: Annotated[
        bool,
        typer.Option(
            "--index/--no-index",
            help="Whether clips are indexed for search when they are added; reindex does it later.",
        ),
    ] = True,
    debug: Debug = False,
) -> None:
    """Make a library without clips; a sharded one of a URL or a name that ends with a slash."""
    from mocapress.cli.batch import usage
    from mocapress.library.library import is_sharded

    with telling(file, debug=debug):
        if is_sharded(file):
            from mocapress.library import sharded
            from mocapress.library.sharded.manifest import SHARD_BYTES

            size = _bytes(shard_size) if shard_size else SHARD_BYTES
            sharded.create(file, size, indexed=index)
            return
        if shard_size:
            usage("--shard-size is of sharded libraries: a URL, or a name that ends with a slash")
        from mocapress.library.database import create

        create(Path(file), indexed=index)


def _bytes(text: str) -> int:
    """Read a number of bytes, with a unit such as MB of 1024 x 1024 bytes or none."""
    from mocapress.cli.batch import usage

    number = text.upper().removesuffix("B")
    scale = {"K": 2**10, "M": 2**20, "G": 2**30}.get(number[-1:], 1)
    digits = number if scale == 1 else number[:-1]
    if not digits.isdecimal() or not int(digits):
        usage(f"--shard-size: expected a number of bytes such as 64MB; found {text!r}")
    return int(digits) * scale
