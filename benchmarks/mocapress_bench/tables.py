"""Rows of the benchmark as Markdown tables."""

from collections import defaultdict
from collections.abc import Iterable
from pathlib import PurePath
from typing import Any

Row = dict[str, Any]


def markdown(header: list[str], rows: Iterable[list[str]]) -> str:
    """Lay out a table: the first column left-aligned, the others right-aligned."""
    lines = ["| " + " | ".join(header) + " |", "|---" + "|---:" * (len(header) - 1) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]) + "\n"


def totals(rows: list[Row], memory: dict[str, float] | None = None) -> str:
    """Sum over all clips, one line per contender, strongest first; models count."""
    lines = []
    models = any(row["model_bytes"] for row in rows)
    for codec, own in sorted(grouped(rows, "codec").items(), key=lambda item: -_ratio(item[1])):
        samples = sum(row["frames"] * row["channels"] for row in own)
        raw, small, frames = sum_of(own, "raw_bytes"), stored(own), sum_of(own, "frames")
        lines.append(
            [
                marked(codec, own),
                f"{raw:,.0f}",
                f"{small:,.0f}",
                *([f"{sum(row['model_bytes'] for row in own):,}"] if models else []),
                f"{raw / small:.3f}",
                f"{8 * small / samples:.2f}",
                f"{_weighted(own, 'encode_us_per_frame') / frames:.2f}",
                f"{_weighted(own, 'decode_us_per_frame') / frames:.2f}",
                f"{raw / 1e6 / sum_of(own, 'compress_s'):.1f}",
                f"{raw / 1e6 / sum_of(own, 'decompress_s'):.1f}",
                f"{memory[codec]:.0f}" if memory and codec in memory else "",
                f"{sum(row['exact'] for row in own)}/{len(own)}",
            ]
        )
    header = ["codec", "raw bytes", "compressed", *(["of which models"] if models else []), "ratio"]
    header += ["bits/sample", "encode µs/frame", "decode µs/frame", "compress MB/s"]
    header += ["restore MB/s", "peak MB", "exact"]
    return markdown(header, lines) + _footnote(rows)


def by_group(rows: list[Row]) -> str:
    """Give ratios per folder of clips (the paper's Table 2), one column per contender."""
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[str(PurePath(row["clip"]).parent)].append(row)
    codecs = grouped(rows, "codec")
    lines = []
    for group, own in [*groups.items(), ("all", rows)]:
        by_codec = grouped(own, "codec")
        first = by_codec[next(iter(codecs))]
        lines.append(
            [group, str(len(first)), f"{sum_of(first, 'frames'):.0f}"]
            + [f"{_ratio(by_codec[codec]):.3f}" for codec in codecs]
        )
    names = [marked(codec, own) for codec, own in codecs.items()]
    return markdown(["clips of", "clips", "frames", *names], lines) + _footnote(rows)


def by_clip(rows: list[Row]) -> str:
    """Give ratios per clip, one column per contender; models do not count."""
    names = [marked(codec, own) for codec, own in grouped(rows, "codec").items()]
    lines = [
        [clip, f"{own[0]['frames']}", f"{own[0]['raw_bytes']:,}"]
        + [f"{row['raw_bytes'] / row['compressed_bytes']:.3f}" for row in own]
        for clip, own in grouped(rows, "clip").items()
    ]
    return markdown(["clip", "frames", "raw bytes", *names], lines)


def marked(codec: str, rows: list[Row]) -> str:
    """Give a contender's name, with a mark where only the values are counted."""
    return f"{codec} †" if rows[0]["counts"] == "values" else codec


def stored(rows: list[Row]) -> float:
    """Sum the bytes needed to restore the files: compressed files and models."""
    return sum_of(rows, "compressed_bytes") + float(sum(row["model_bytes"] for row in rows))


def _footnote(rows: list[Row]) -> str:
    if all(row["counts"] == "file" for row in rows):
        return ""
    return (
        "\n† The values alone: the text around them is not counted, in this contender's favour.\n"
    )


def grouped(rows: list[Row], key: str) -> dict[str, list[Row]]:
    """Group rows."""
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[row[key]].append(row)
    return groups


def sum_of(rows: list[Row], key: str) -> float:
    """Add up a field, never to 0, so that it can divide."""
    return float(sum(row[key] for row in rows)) or 1e-9


def _ratio(rows: list[Row]) -> float:
    return sum_of(rows, "raw_bytes") / stored(rows)


def _weighted(rows: list[Row], key: str) -> float:
    return float(sum(row[key] * row["frames"] for row in rows))
