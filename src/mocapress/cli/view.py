"""``view``."""

import webbrowser
from collections.abc import Sequence
from pathlib import Path

import typer

from mocapress.cli.batch import usage
from mocapress.cli.warned import collecting, kept
from mocapress.errors import MocapressError
from mocapress.storage import write_whole
from mocapress.viewer import embed, page
from mocapress.viewer.server import PageServer


def view_files(
    inputs: Sequence[Path],
    *,
    export: Path | None,
    lossless: bool,
    max_error: float,
    asf: Path | None,
    port: int,
    browser: bool,
    strict: bool,
    force: bool,
) -> None:
    """Serve a page that plays the files, or write it."""
    stated = None if lossless or export is None else max_error
    try:
        with collecting():
            clips = [
                embed.file(path, asf_path=asf, max_error=stated, strict=strict) for path in inputs
            ]
        for warning in kept():
            typer.echo(f"mocapress: warning: {warning}", err=True)
        document = page.document(clips, " · ".join(path.name for path in inputs) or "mocapress")
        if export:
            write_whole(export, document.encode(), force=force)
    except (MocapressError, OSError, MemoryError) as error:
        typer.echo(f"mocapress: {_message(error)}", err=True)
        raise typer.Exit(1) from error
    if export:
        print(f"{export}: {export.stat().st_size} bytes, {_exactness(stated)}")
    else:
        _serve(document, port, browser=browser)


def _serve(document: str, port: int, *, browser: bool) -> None:
    try:
        server = PageServer(document, page.policy(), port)
    except OSError as error:
        usage(f"port {port}: {error.strerror}")
    with server:
        print(f"{server.url} plays them; Ctrl-C ends it", flush=True)
        if browser:
            webbrowser.open(server.url)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()


def _exactness(max_error: float | None) -> str:
    return "exact values" if max_error is None else f"no value off by more than {max_error:g}"


def _message(error: Exception) -> str:
    if isinstance(error, OSError):
        return f"{error.filename}: {error.strerror}"
    return "not enough memory" if isinstance(error, MemoryError) else str(error)
