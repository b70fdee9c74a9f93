"""``view``."""

from base64 import b64decode
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.options import Asf, Debug, Force, Lenient

if TYPE_CHECKING:
    from collections.abc import Callable

    from mocapress.viewer.server import Answer

MANIFESTS = "manifest/*.parquet"
"""What the folder of a sharded library has, and one of motion files has not."""


def view(
    files: Annotated[
        list[str] | None,
        typer.Argument(
            help="Motion files, .mcz, folders, or one library, also the folder or URL of a sharded "
            "one; of two files that are alike, the second is compared with the first."
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
    near: Annotated[
        str | None,
        typer.Option(
            "--near",
            help="Export motion by the codec near with these parameters, e.g. max=0.1cm or "
            "p=0.1cm, instead of exact values.",
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
    from mocapress import codecs
    from mocapress.cli.batch import usage
    from mocapress.cli.report import message, say
    from mocapress.cli.targets import known_endings, refuse_other_kinds
    from mocapress.cli.warned import collecting, kept
    from mocapress.errors import MocapressError
    from mocapress.storage import check_targets, write_whole
    from mocapress.viewer import embed, page
    from mocapress.viewer.server import nothing

    if any(_is_library(name) for name in files or []):
        _serve_library(files or [], export, port, browser=browser, strict=not lenient, debug=debug)
        return
    inputs = _found([Path(name) for name in files or []])
    refuse_other_kinds(str(export) if export else None, (".html",), known_endings())
    if near is not None and (max_error is not None or not export):
        usage("--near is for --export, instead of --max-error")
    stated = max_error if export else None
    name = "--near" if near is not None else ""
    try:
        lossy = codecs.codec(f"near:{near}") if near is not None else None
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
                    near=lossy,
                    level=embed.LEVEL if export else embed.FAST,
                    strict=not lenient,
                )
                clips.append(clip)
            for warning in kept():
                say(f"warning: {warning}")
        title = " · ".join(path.name for path in inputs) or "mocapress"
        # Names of files need not be UTF-8, a page is.
        title = title.encode(errors="surrogateescape").decode(errors="replace")
        assets = embed.assets(clips) if export else None
        document = page.document(clips, title, assets=assets, served=export is None)
        if export:
            name = str(export)
            write_whole(export, document.encode(), force=force)
    except (MocapressError, OSError, MemoryError) as error:
        if debug:
            raise
        say(message(error, name))
        raise typer.Exit(1) from error
    if export:
        print(f"{export}: {len(document.encode())} bytes, {_exactness(stated, near, clips)}")
    else:
        serve(document, port, browser=browser, more=nothing)


def _is_library(name: str) -> bool:
    """Tell a library from motion files and folders of them."""
    return name.lower().endswith(".mocapdb") or "://" in name or any(Path(name).glob(MANIFESTS))


def _found(paths: list[Path]) -> list[Path]:
    """Give the files that were named, and those below folders that were."""
    from mocapress.cli.batch import find
    from mocapress.formats import readable, suffixes

    of_motion = suffixes(of for of in readable() if of.read_skeleton is None)
    return [job.source for job in find(paths, (*of_motion, ".mcz"))] if paths else []


def _serve_library(
    inputs: list[str],
    export: Path | None,
    port: int,
    *,
    browser: bool,
    strict: bool,
    debug: bool,
) -> None:
    from mocapress.cli.batch import usage
    from mocapress.cli.report import message, say
    from mocapress.errors import MocapressError
    from mocapress.viewer import page
    from mocapress.viewer.library import ServedLibrary

    library = inputs[0]
    if len(inputs) > 1:
        usage("a library is viewed alone; expected one file")
    if export is not None:
        usage("--export makes a page of clips, not of a library; `library extract` gives its clips")
    try:
        with ServedLibrary(library, strict=strict) as served:
            document = page.document([], served.name, served=True, library=served.name)
            serve(document, port, browser=browser, more=served.answer)
    except (MocapressError, OSError) as error:
        if debug:
            raise
        say(message(error, library))
        raise typer.Exit(1) from error


def serve(
    document: str,
    port: int,
    *,
    browser: bool,
    more: "Callable[[str], Answer | None]",
) -> None:
    """Serve a page until Ctrl-C."""
    import webbrowser

    from mocapress.cli.batch import usage
    from mocapress.viewer import page
    from mocapress.viewer.server import PageServer, first_of

    try:
        server = PageServer(document, page.policy(served=True), port, first_of(more, page.lent))
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


def _exactness(max_error: float | None, near: str | None, clips: list[dict[str, Any]]) -> str:
    if near is not None:
        motion = sum(len(b64decode(clip["mcz"])) for clip in clips if "mcz" in clip)
        return f"{motion} of them motion, near:{near}"
    return "exact values" if max_error is None else f"no value off by more than {max_error:g}"
