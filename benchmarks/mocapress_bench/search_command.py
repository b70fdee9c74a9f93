"""``mocapress bench search``."""

import json as jsonlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress_bench.inputs import Debug, Force, Json, Markdown, output, progress_line, usage

if TYPE_CHECKING:
    from mocapress_bench.search_data import Take

_CUTS = "hdm05"
_TAKES = "mocap6"
_TRIALS = "cmu_labels.tsv"


def search(
    data: Annotated[Path, typer.Argument(help="Folder with hdm05/labels.tsv and cuts.")],
    corpus: Annotated[
        Path | None,
        typer.Option(help="CMU's trials by subject, for cmu_labels.tsv.", metavar="FOLDER"),
    ] = None,
    only: Annotated[str, typer.Option(help="Methods whose names begin so, by commas.")] = "",
    seeds: Annotated[int, typer.Option(help="Runs of methods that draw.", min=1)] = 5,
    stretches: Annotated[
        bool, typer.Option(help="Search in long takes, too: joined cuts, and mocap6/.")
    ] = True,
    clips: Annotated[bool, typer.Option(help="Rank whole clips.")] = True,
    json: Json = None,
    markdown: Markdown = None,
    plots: Annotated[Path | None, output("--plots", "Draw confusion matrices to this PNG.")] = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Rank labelled clips by example with all methods, every clip being the query once."""
    from mocapress.storage import write_whole
    from mocapress_bench import search_tables as tables
    from mocapress_bench.search import HELD_OUT, METHODS, measure

    begins = tuple(name.strip() for name in only.split(",") if name.strip())
    methods = {name: m for name, m in METHODS.items() if not begins or name.startswith(begins)}
    if not methods:
        usage(f"no method is called {only}; there are {', '.join(METHODS)}")
    show = progress_line(0)
    sets = _read(data, corpus, show)
    results: dict[str, Any] = {}
    confused = {}
    parts = []
    for told, takes in sets.items() if clips else ():
        rows = []
        for name, method in methods.items():
            if name == HELD_OUT and told != "CMU labels":
                continue
            show(f"{told}: {name}")
            measured = measure(name, method, takes, seeds)
            rows.append(measured.row)
            if measured.confused and told == "HDM05":
                confused[name] = measured.confused
        classes = len({take.label for take in takes})
        results[told] = rows
        parts.append(tables.ranked(f"{told}: {len(takes)} clips, {classes} classes", rows))
    if stretches:
        rows = list(_stretches(data, corpus, sets, set(methods), seeds, show))
        results["stretches"] = rows
        parts += [tables.stretches(rows)] if rows else []
    parts += [tables.confused(name, *found) for name, found in confused.items()]
    results["confusion"] = {
        name: {"classes": classes, "per cent": matrix.round(2).tolist()}
        for name, (classes, matrix) in confused.items()
    }
    for part in parts:
        print(part)
    if plots and confused:
        try:
            tables.draw(confused, plots)
        except ImportError:
            usage("--plots needs matplotlib: pip install matplotlib")
    if json:
        write_whole(json, jsonlib.dumps(results, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, "\n".join(parts).encode(), force=force)


def _read(data: Path, corpus: Path | None, show: Callable[[str], None]) -> "dict[str, list[Take]]":
    from mocapress.errors import MocapressError
    from mocapress_bench.search_data import read_cuts, read_trials

    sets = {}
    try:
        if (data / _CUTS).is_dir():
            sets["HDM05"] = read_cuts(data / _CUTS, show)
        if corpus is not None:
            sets["CMU labels"] = read_trials(data / _TRIALS, corpus, progress=show)
    except (OSError, KeyError, MocapressError) as error:
        usage(f"{data}: {error}")
    if not sets:
        usage(f"no folder {_CUTS} in {data}")
    return sets


def _stretches(
    data: Path,
    corpus: Path | None,
    sets: "dict[str, list[Take]]",
    names: set[str],
    seeds: int,
    show: Callable[[str], None],
) -> Iterator[dict[str, Any]]:
    from mocapress_bench.search_own import own_stretches
    from mocapress_bench.search_stretches import (
        joined,
        labelled,
        match_webs,
        measure,
        measure_labels,
    )

    finders = {"mocapress": own_stretches, "match webs (Kovar 2004)": match_webs}
    named = {name: finder for name, finder in finders.items() if name in names}
    skeletons = sorted(corpus.rglob("*.asf")) if corpus is not None else []
    for name, finder in named.items():
        show(f"stretches: {name}")
        row: dict[str, Any] = {"method": name}
        if "HDM05" in sets:
            takes = sets["HDM05"]
            row |= measure(finder, takes, [joined(takes, seed) for seed in range(min(seeds, 2))])
        if (data / _TAKES).is_dir() and skeletons:
            queries, longs = labelled(data / _TAKES, skeletons[0])
            row |= measure_labels(finder(longs), queries, longs)
        yield row
