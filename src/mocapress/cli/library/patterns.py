"""``library patterns``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapress.cli.library.opening import File, Label, Patterns, chosen, opened
from mocapress.cli.options import Debug, Json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mocapress.library import Library
    from mocapress.library.recurring import Recurring

_MOST_LINES = 50
_MOST_PLAYED = 3
"""Pairs."""


def patterns(
    file: File,
    clips: Patterns = None,
    label: Label = None,
    valid_path: Annotated[
        int, typer.Option("--frames", min=1, help="The least frames that count.", metavar="N")
    ] = 55,
    radius: Annotated[
        float | None,
        typer.Option(
            "--radius",
            min=0,
            help="How far postures may differ, in weighted degrees; otherwise as far as one moves "
            "in a tenth of a second.",
        ),
    ] = None,
    pictures: Annotated[
        Path | None,
        typer.Option("--pictures", help="Draw paths and forest into this folder.", metavar="DIR"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", "-f", help="Overwrite pictures.")] = False,
    view: Annotated[
        bool, typer.Option("--view", help="Play the longest pairs side by side in the browser.")
    ] = False,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Show which frames of which clips resemble each other."""
    import json as jsonlib

    from mocapress.codecs.mrpa import Thresholds
    from mocapress.library.recurring import recurring

    thresholds = Thresholds(valid_path=valid_path, radius=radius or None)
    with opened(file, debug=debug) as library:
        found = recurring(chosen(library, clips, label), thresholds)
        if pictures is not None:
            from mocapress.cli.library.pattern_pictures import draw

            drawn = draw(found, pictures, force=force)
        if json:
            print(jsonlib.dumps([group.as_dict() for group in found], indent=1))
        else:
            for group in found:
                _show(group)
            if not found:
                print("no motion")
            if pictures is not None:
                print(*drawn, sep="\n")
        if view:
            _play(library, found, browser=browser)


def _play(library: "Library", groups: "Sequence[Recurring]", *, browser: bool) -> None:
    """Play the longest pairs, what resembles and what it resembles side by side."""
    from mocapress.cli.batch import usage
    from mocapress.cli.view import serve
    from mocapress.viewer import embed, page
    from mocapress.viewer.server import nothing

    pairs = sorted((pair for group in groups for pair in group.pairs()), key=lambda p: -len(p))
    if not pairs:
        usage("nothing recurs in these clips; expected two that resemble each other")
    content = [
        embed.exact(
            library.load(place.clip, slice(place.first, place.last + 1), strict=False),
            str(place),
            level=embed.FAST,
        )
        for pair in pairs[:_MOST_PLAYED]
        for place in (pair.frames, pair.earlier)
    ]
    serve(page.document(content, "patterns", served=True), 0, browser=browser, more=nothing)


def _show(group: "Recurring") -> None:
    pairs = group.pairs()
    total = sum(pair.frames.last + 1 - pair.frames.first for pair in pairs)
    print(
        f"{len(group.names)} clips, {len(group.found.clips)} frames: {total} resemble earlier ones "
        f"(radius {group.found.trellis.radius:.4g})"
    )
    for pair in pairs[:_MOST_LINES]:
        print(f"  {pair.frames}  like  {pair.earlier}  distance {pair.distance:.3g}")
    if len(pairs) > _MOST_LINES:
        print(f"  and {len(pairs) - _MOST_LINES} shorter; --json gives all")
    for tree in group.trees():
        for place, depth in tree:
            print(f"  {'  ' * depth}{'tree: ' if depth == 0 else ''}{place}")
