"""``mocapress bench diffma``."""

import json as jsonlib

from mocapress_bench.inputs import (
    Corpus,
    Debug,
    Force,
    Json,
    Markdown,
    clips_named,
    progress_line,
    say,
    usage,
)


def diffma(
    corpus: Corpus = None,
    json: Json = None,
    markdown: Markdown = None,
    force: Force = False,
    debug: Debug = False,  # noqa: ARG001
) -> None:
    """Repeat the evaluation of DiffMA, beside zfp and LZMA, and measure our extensions."""
    from mocapress.storage import write_whole
    from mocapress_bench.diffma import measure, speed
    from mocapress_bench.diffma_tables import report, speeds

    paths, root = clips_named(corpus)
    rows, notes = measure(paths, root, progress=progress_line(len(paths)))
    say(notes)
    if not rows:
        usage("none of the clips can be read")
    longest = max(rows, key=lambda row: row["frames"] * row["channels"])
    parts = [report(rows), speeds(speed(root / longest["clip"]))]
    for part in parts:
        print(part)
    if json:
        write_whole(json, jsonlib.dumps(rows, indent=1).encode(), force=force)
    if markdown:
        write_whole(markdown, "\n".join(parts).encode(), force=force)
