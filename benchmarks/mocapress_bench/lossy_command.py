"""``mocapress bench lossy``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapress_bench.inputs import Force, Markdown, output, say, usage

if TYPE_CHECKING:
    from mocapress_bench.lossy import Point

CLIPS = "05_05,16_15,35_01"
TABLE = Path(__file__).parents[1] / "near_acl.tsv"


def lossy(
    corpus: Annotated[Path, typer.Argument(help="Folder with AMC clips and their skeletons.")],
    clips: Annotated[
        str, typer.Option("--clips", help="Names of clips that ACL's figures are known of.")
    ] = CLIPS,
    only: Annotated[
        str, typer.Option("--only", help="Contenders; commas between them. By default all.")
    ] = "",
    gltfpack: Annotated[
        Path | None,
        typer.Option(
            "--gltfpack",
            help="cli.js of the npm package gltfpack, beside which three is installed; without it, "
            "gltfpack is left out.",
            metavar="FILE",
        ),
    ] = None,
    plot: Annotated[Path | None, output("--plot", "Draw bits against errors.", "FILE.png")] = None,
    markdown: Markdown = None,
    force: Force = False,
) -> None:
    """Measure bytes against errors of joints: near, diffma, qssd, patterns, gltfpack, zfp, DCT."""
    import mocapress as mp
    from mocapress.storage import write_whole
    from mocapress_bench import lossy as bench
    from mocapress_bench.lossy_report import draw, report

    known = bench.contenders(gltfpack)
    wanted = [name for name in only.split(",") if name] or list(known)
    if missing := [name for name in wanted if name not in known]:
        usage(f"no contender {', '.join(missing)}; there are {', '.join(known)}")
    points: list[Point] = []
    names = [name for name in clips.split(",") if name]
    for name in names:
        path = next(iter(sorted(corpus.rglob(f"{name}.amc"))), None)
        if path is None:
            usage(f"no {name}.amc below {corpus}")
        clip = mp.retime(mp.read(path), 120)
        say([f"{name}: {clip.frames} frames"])
        points += bench.measured(clip, name, {one: known[one] for one in wanted})
    of_acl = bench.acl(TABLE, set(names))
    points += of_acl + bench.curvecodec(of_acl)
    text = report(bench.together(points), names)
    print(text)
    if markdown:
        write_whole(markdown, text.encode(), force=force)
    if plot:
        write_whole(plot, draw(bench.together(points)), force=force)
