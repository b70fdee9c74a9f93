"""``search``."""

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Asf, Debug, Force, Joints, Json, Models
from mocapress.cli.selecting import Frames, Seconds, Time

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mocapress.library import Library, SearchHit, StoredClip
    from mocapress.library.sheet import Tile
    from mocapress.models import Place
    from mocapress.motion import Clip

_PLAYED = 5
"""Hits that are played beside the query."""


def search(
    file: File,
    query: Annotated[
        str,
        typer.Argument(
            metavar="QUERY",
            help="A motion file or .mcz, or else the name of a clip in the library.",
            show_default=False,
        ),
    ],
    frames: Frames = None,
    time: Time = None,
    top: Annotated[int, typer.Option("--top", min=1, metavar="N", help="Hits at most.")] = 20,
    within: Annotated[
        bool,
        typer.Option("--within", help="Find where in long clips it occurs, not whole clips."),
    ] = False,
    mirror: Annotated[
        bool, typer.Option("--mirror", help="Also find the mirror image of the query.")
    ] = False,
    by: Annotated[
        str | None,
        typer.Option(
            "--by",
            metavar="NAME",
            help="Compare whole clips by a published signature instead, which reads all motion: "
            "qssd, qssd-dots, ksvd or patterns.",
        ),
    ] = None,
    sheet: Annotated[
        Path | None,
        typer.Option("--sheet", help="Draw query and hits. Needs Pillow.", metavar="HITS.png"),
    ] = None,
    view: Annotated[
        bool,
        typer.Option("--view", help=f"Play query and best {_PLAYED} hits in the browser."),
    ] = False,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    asf: Asf = None,
    joints: Joints = None,
    models: Models = None,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Find the clips of a library that move as a clip does, or a stretch of one.

    --frames and --time take the stretch from the query. A clip of the library does not find itself.
    """
    import json as jsonlib

    from mocapress.cli.batch import usage
    from mocapress.cli.models import open_models
    from mocapress.cli.pictures import check_kind
    from mocapress.motion.standard_joints import read_mapping
    from mocapress.storage import check_targets

    if frames is not None and time is not None:
        usage("--frames and --time exclude each other")
    if sheet:
        check_kind(sheet, "--sheet")
    with _searchable(file, debug=debug, models=open_models(models or [])) as library:
        if sheet:
            check_targets([sheet], force=force)
        clip = _clip(library, query, asf)
        stretch = frames if time is None else _stretch(clip, time)
        hits = library.search(
            clip,
            frames=stretch,
            top=top,
            within=within,
            mirror=mirror,
            joints=None if joints is None else read_mapping(joints),
            by=by,
        )
        rows = [_row(rank, hit) for rank, hit in enumerate(hits, 1)]
        print(jsonlib.dumps(rows, indent=1)) if json else _print(rows)
        if sheet:
            _draw(library, clip, stretch, hits, sheet, force=force)
        if view:
            _play(library, clip, stretch, hits, browser=browser)


@contextmanager
def _searchable(file: str, *, debug: bool, models: "Sequence[Place]") -> "Iterator[Library]":
    """Open a library; the index that clips lack is made now, and kept where that is possible."""
    from mocapress.cli.report import say
    from mocapress.library.index import is_wanted
    from mocapress.library.library import is_sharded

    with opened(file, debug=debug, models=models) as library:
        missing = library.lacking()
        place = Path(library.location)
        with library.db.reading() as connection:
            wanted = is_wanted(connection)
        kept = (
            wanted
            and not is_sharded(library.location)
            and all(os.access(there, os.W_OK) for there in (place, place.parent))
        )
        if missing and not kept:
            say(
                f"{file}: {missing} clips have no index for search, and the library "
                f"{'cannot be changed here' if wanted else 'was made without one'}: "
                "it is made for this search alone"
            )
        if not missing or not kept:
            yield library
            return
    say(f"{file}: {missing} clips had no index for search, which is made and kept")
    with opened(file, "a", debug=debug, models=models) as library:
        yield library


def _clip(library: "Library", query: str, asf: Path | None) -> "Clip | StoredClip":
    from mocapress import api
    from mocapress.cli.batch import Job, is_folder
    from mocapress.cli.models import places_for
    from mocapress.errors import ParameterError

    path = Path(query)
    if path.exists() and not is_folder(path):
        job = Job(path, path.parent)
        return api.read_source(
            job.opened(), asf, models=places_for(job, library.models), strict=False
        )
    if query not in library:
        raise ParameterError("neither a file nor a clip of the library", file=query)
    return library[query]


def _stretch(clip: "Clip | StoredClip", time: Seconds) -> slice:
    from fractions import Fraction

    from mocapress.motion.editing import frames_between
    from mocapress.search.standard import ASSUMED_RATE

    frame_time = Fraction(clip.frame_time or 1 / ASSUMED_RATE)
    return frames_between(time.start, time.end, frame_time)


def _row(rank: int, hit: "SearchHit") -> dict[str, Any]:
    return {
        "rank": rank,
        "clip": hit.name,
        "start": hit.start,
        "end": hit.end,
        "from": hit.seconds[0],
        "to": hit.seconds[1],
        "score": hit.score,
        "labels": hit.labels,
    }


def _print(rows: "Sequence[dict[str, Any]]") -> None:
    """Print a table: times in seconds."""
    width = max([4, *(len(row["clip"]) for row in rows)])
    print(f"rank  {'clip':<{width}}     from       to    score  labels".rstrip())
    for row in rows:
        line = (
            f"{row['rank']:>4}  {row['clip']:<{width}} {row['from']:>8.2f} {row['to']:>8.2f} "
            f"{row['score']:>8.3f}  {','.join(row['labels'])}"
        )
        print(line.rstrip())


def _draw(
    library: "Library",
    query: "Clip | StoredClip",
    stretch: slice | None,
    hits: "Sequence[SearchHit]",
    output: Path,
    *,
    force: bool,
) -> None:
    from mocapress.cli.pictures import write_picture
    from mocapress.cli.report import message, say
    from mocapress.library.sheet import draw, tile_of

    found = [
        tile_of(
            library,
            library[hit.name],
            hit.frames,
            f"{rank}.  {hit.seconds[0]:.2f} to {hit.seconds[1]:.2f} s  "
            f"score {hit.score:.3f}  {'  '.join(hit.labels)}",
        )
        for rank, hit in enumerate(hits, 1)
    ]
    picture, failures = draw([_tile(library, query, stretch), *found])
    write_picture(output, picture, force=force)
    for error in failures:
        say(message(error, error.file or ""))
    if failures:
        raise typer.Exit(1)


def _tile(library: "Library", query: "Clip | StoredClip", stretch: slice | None) -> "Tile":
    from mocapress import figures
    from mocapress.library.sheet import Tile, tile_of
    from mocapress.motion import Clip

    if not isinstance(query, Clip):
        return tile_of(library, query, stretch, "query")
    clip = query if stretch is None else query[stretch]
    return Tile(query.name, "query", lambda count: (clip, figures.moments(clip.frames, count)))


def _play(
    library: "Library",
    query: "Clip | StoredClip",
    stretch: slice | None,
    hits: "Sequence[SearchHit]",
    *,
    browser: bool,
) -> None:
    from mocapress.cli.view import serve
    from mocapress.motion import Clip
    from mocapress.viewer import embed, page
    from mocapress.viewer.server import nothing

    if isinstance(query, Clip):
        clip = query if stretch is None else query[stretch]
    else:
        clip = library.load(query, stretch, strict=False)
    played = [(clip, f"query: {query.name}")]
    for rank, hit in enumerate(hits[:_PLAYED], 1):
        played.append((library.load(hit.name, hit.frames, strict=False), f"{rank}: {hit.name}"))
    content = [embed.exact(clip, name, level=embed.FAST) for clip, name in played]
    document = page.document(content, "search", served=True)
    serve(document, 0, browser=browser, more=nothing)
