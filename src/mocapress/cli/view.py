"""``view``."""

from pathlib import Path
from typing import Annotated

import typer

from mocapress.cli.options import Asf, Debug, Force, Lenient


def view(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Motion files, .mcz, or folders; given two, the second is compared with the first."
        ),
    ] = None,
    export: Annotated[
        Path | None,
        typer.Option("--export", help="Write the page to this file instead.", metavar="PAGE.html"),
    ] = None,
    max_error: Annotated[
        float | None,
        typer.Option(
            "--max-error",
            help="Export DiffMA JSON in which no value is off by more, in the file's units, "
            "instead of exact values.",
            min=1e-12,
        ),
    ] = None,
    asf: Asf = None,
    port: Annotated[
        int,
        typer.Option("--port", help="Port on 127.0.0.1; 0 chooses a free one.", min=0, max=65535),
    ] = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    lenient: Lenient = False,
    force: Force = False,
    debug: Debug = False,
) -> None:
    """Play motion files in the browser, side by side, or write a page that plays them."""
    from mocapress.cli.report import message, say
    from mocapress.cli.targets import known_endings, refuse_other_kinds
    from mocapress.cli.warned import collecting, kept
    from mocapress.errors import MocapressError
    from mocapress.storage import check_targets, write_whole
    from mocapress.viewer import embed, page

    inputs = _found(files or [])
    refuse_other_kinds(str(export) if export else None, (".html",), known_endings())
    stated = max_error if export else None
    name = ""
    try:
        if export:
            check_targets([export], force=force)
        clips = []
        for path in inputs:
            name = str(path)
            with collecting():
                clip = embed.file(
                    path,
                    asf_path=asf,
                    max_error=stated,
                    level=embed.LEVEL if export else embed.FAST,
                    strict=not lenient,
                )
                clips.append(clip)
            for warning in kept():
                say(f"warning: {warning}")
        title = " · ".join(path.name for path in inputs) or "mocapress"
        # Names of files need not be UTF-8, a page is.
        title = title.encode(errors="surrogateescape").decode(errors="replace")
        document = page.document(clips, title, assets=embed.assets(clips) if export else None)
        if export:
            name = str(export)
            write_whole(export, document.encode(), force=force)
    except (MocapressError, OSError, MemoryError) as error:
        if debug:
            raise
        say(message(error, name))
        raise typer.Exit(1) from error
    if export:
        print(f"{export}: {len(document.encode())} bytes, {_exactness(stated)}")
    else:
        _serve(document, port, browser=browser)


def _found(paths: list[Path]) -> list[Path]:
    """Give the files that were named, and those below folders that were."""
    from mocapress.cli.batch import find
    from mocapress.formats import readable, suffixes

    of_motion = suffixes(of for of in readable() if of.read_skeleton is None)
    return [job.source for job in find(paths, (*of_motion, ".mcz"))] if paths else []


def _serve(document: str, port: int, *, browser: bool) -> None:
    import webbrowser

    from mocapress.cli.batch import usage
    from mocapress.viewer import page
    from mocapress.viewer.server import PageServer

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
