"""``mocapress bench qssd-rivals``."""

import json as jsonlib
import warnings
from pathlib import Path
from typing import Annotated

import typer

from mocapress_bench.inputs import (
    Corpus,
    Debug,
    Force,
    Json,
    Markdown,
    clips_named,
    progress_line,
    usage,
)
from mocapress_bench.qssd_command import Subjects, of_subjects


def qssd_rivals(
    corpus: Corpus = None,
    subjects: Subjects = "",
    atoms: Annotated[int, typer.Option(help="K.", min=1)] = 100,
    most: Annotated[int, typer.Option(help="L, atoms of a frame.", min=1, max=64)] = 15,
    iterations: Annotated[int, typer.Option(help="Of learning.", min=1)] = 8,
    steps: Annotated[str, typer.Option(help="Steps of weights, of their mean.")] = "0.25,0.5,1",
    json: Json = None,
    markdown: Markdown = None,
    pictures: Annotated[
        Path | None,
        typer.Option(help="Draw atoms and coded poses into this folder. Needs Pillow."),
    ] = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Measure ways to combine atoms as whole codecs: QSSD, K-SVD, and options of the outlook."""
    import mocapress as mp
    from mocapress.codecs.qssd.decomposition import ComponentSums, LogSums, Products, Space
    from mocapress.errors import MocapressError
    from mocapress.storage import write_whole
    from mocapress_bench.qssd import table
    from mocapress_bench.qssd_options import FewJoints, NonNegative, SumOne
    from mocapress_bench.qssd_pictures import draw_atoms, draw_poses
    from mocapress_bench.qssd_rivals import Poses, measure, poses_of

    paths, root = clips_named(corpus)
    progress = progress_line(0)
    clips: list[Poses] = []
    for path in of_subjects(paths, root, subjects):
        progress(path.name)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", mp.MotionWarning)
                made = poses_of(mp.read(path), path.stat().st_size)
        except MocapressError:
            continue
        if made.clip.frames and (not clips or made.turns.shape[1] == clips[0].turns.shape[1]):
            clips.append(made)
    if not clips:
        usage("none of the clips can be read")
    spaces: dict[str, Space] = {
        "QSSD": Products(),
        "QSSD, weights change places": Products(sort=True),
        "K-SVD, components": ComponentSums(),
        "K-SVD, logarithms": LogSums(),
        "K-SVD, logarithms, no weight below 0": NonNegative(),
        "K-SVD, logarithms, weights of one sum": SumOne(),
        "K-SVD, logarithms, atoms over 6 joints": FewJoints(),
    }
    measured = measure(
        clips,
        spaces,
        atoms=atoms,
        most=most,
        steps=[float(step) for step in steps.split(",")],
        iterations=iterations,
        progress=progress,
    )
    print(table(measured.rows))
    if json:
        write_whole(json, jsonlib.dumps(measured.rows, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, table(measured.rows).encode(), force=force)
    if pictures:
        pictures.mkdir(exist_ok=True)
        for name, picture in (
            ("qssd_atoms.png", draw_atoms(measured, clips[0])),
            ("qssd_poses.png", draw_poses(clips[0])),
        ):
            write_whole(pictures / name, picture, force=force)
