"""``mocapress bench patterns``."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from mocapress_bench.patterns import Row


def patterns(
    corpus: Annotated[
        Path, typer.Argument(help="Folder with amc/cmu/SUBJECT, and C3D files below it.")
    ],
    arms: Annotated[float, typer.Option("--arms", help="Target of ARMS, mm.")] = 6.5,
    subject: Annotated[str, typer.Option("--subject", help="Of the CMU database.")] = "16",
    frames: Annotated[int, typer.Option("--frames", help="Of the subject.", min=100)] = 12_000,
    c3d: Annotated[
        str, typer.Option("--c3d", help="Pattern of C3D files' names below the folder.")
    ] = "HDM_mm_*.c3d",
    others: Annotated[
        str, typer.Option("--others", help="More subjects, measured briefly; commas between them.")
    ] = "",
    other_c3d: Annotated[
        str, typer.Option("--other-c3d", help="Patterns of more C3D files; commas between them.")
    ] = "",
    only_others: Annotated[bool, typer.Option("--only-others", help="Nothing but these.")] = False,
    pictures: Annotated[
        Path | None, typer.Option("--pictures", help="Draw into this folder.", metavar="DIR")
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", help="File for the tables.")
    ] = None,
) -> None:
    """Measure the codec patterns beside its rivals, on joint positions and on markers."""
    from mocapress.cli.report import say
    from mocapress_bench.patterns import cmu, compared, growth, of_c3d, told, weighted
    from mocapress_bench.patterns_more import bone_lengths, brief, draw, roots, seen

    spec = f"patterns:arms={arms:g}"
    sets = [] if only_others else [cmu(corpus / "amc/cmu" / subject, frames)]
    sets += [] if only_others else [of_c3d(path) for path in sorted(corpus.rglob(c3d))]
    more = [cmu(corpus / "amc/cmu" / name, frames) for name in filter(None, others.split(","))]
    for pattern in filter(None, other_c3d.split(",")):
        more += [seen(path) for path in sorted(corpus.rglob(pattern))]
    tables: list[tuple[str, Iterator[Row]]] = []
    for data in sets:
        size = f"{data.clip.frames} frames, {data.clip.channels // 3} markers"
        tables.append((f"{data.name}: {size}", compared(data, arms, say)))
        middle = data.clip.columns[3 * (data.clip.channels // 6)].name.rpartition(".")[0]
        tables.append((f"{data.name}: weights", weighted(data, middle)))
        tables.append((f"{data.name}: lengths between markers", bone_lengths(data, spec)))
        tables.append((f"{data.name}: the root", roots(data, spec)))
        if pictures:
            pictures.mkdir(parents=True, exist_ok=True)
            draw(data, spec, pictures)
    if sets:
        tables.append((f"{sets[0].name}: growth", growth(sets[0], arms)))
    for data in more:
        size = f"{data.clip.frames} frames, {data.clip.channels // 3} markers"
        tables.append((f"{data.name}: {size}", brief(data, arms)))
    text = f"# Patterns, ARMS of at most {arms:g} mm\n"
    for title, rows in tables:
        text += f"\n## {title}\n\n"
        found: list[Row] = []
        for row in rows:
            found.append(row)
            if markdown:  # what is there so far, as a run takes long
                markdown.write_text(text + told(found))
        text += told(found)
    print(text)
