"""The tables and figures of the MRPA paper, measured beside published."""

from pathlib import Path
from typing import Any

from mocapress_bench.mrpa import Row
from mocapress_bench.tables import markdown

# Table 4: gzip, Non-SOM, APP, MRPA; "salsa" is 15 clips there, and one in the corpus.
PAPER = {
    "09": ("run", 2.79, 3.56, 3.62, 4.01),
    "05": ("modern dance", 2.78, 3.64, 3.78, 3.96),
    "60": ("salsa", 2.74, 3.41, 3.68, 4.12),
}
_PAPER_INPUTS = {10: (50, 141), 60: (23, 222), 90: (4, 152)}


def ratios(rows: list[Row]) -> str:
    """Lay out Table 4: ratios of file sizes to payloads, and the paper's below."""
    names = list(rows[0]["ratios"])
    lines = []
    for row in rows:
        lines.append(
            [row["library"], str(row["frames"]), *(f"{row['ratios'][name]:.2f}" for name in names)]
        )
        if row["library"] in PAPER:
            title, gzip, non_som, app, mrpa = PAPER[row["library"]]
            told = {"gzip": gzip, "Non-SOM": non_som, "APP": app, "MRPA as published": mrpa}
            lines.append([f"paper, {title}", "", *(str(told.get(name, "")) for name in names)])
    return markdown(["library", "frames", *names], lines)


def counts(rows: list[Row]) -> str:
    """Say what the stages found."""
    names = ["radius", "paths", "segments", "index entries", "predicted frames", "needs"]
    lines = [[row["library"], *(f"{row[name]:.0f}" for name in names)] for row in rows]
    return markdown(["library", *names[:-1], "parents in mrpa"], lines)


def times(rows: list[Row]) -> str:
    """Lay out Table 5: processor time a frame, in microseconds."""
    names = list(rows[0]["µs a frame"])
    lines = [
        [row["library"], *(f"{row['µs a frame'][name]:.1f}" for name in names)] for row in rows
    ]
    return markdown(["µs a frame", *names], lines)


def walk(rows: dict[str, list[Row]]) -> str:
    """Lay out Tables 1 and 2."""
    inputs = []
    for row in rows["valid_path"]:
        told = _PAPER_INPUTS.get(row["valid_path"], ("", ""))
        own = [str(row["inputs"]), str(row["predicted frames"])]
        inputs.append([str(row["valid_path"]), *own, *map(str, told)])
    segments = [
        [str(row["length"]), ", ".join(f"[{first}-{last}]" for first, last in row["segments"])]
        for row in rows["length"]
    ]
    return "\n".join(
        [
            markdown(
                ["ValidPathThr", "inputs", "predicted frames", "paper: inputs", "predicted"], inputs
            ),
            markdown(["LengthThr", "segments"], segments),
        ]
    )


def swept(rows: dict[str, list[Row]]) -> str:
    """Lay out the numbers of Figs. 5 to 8 and of Table 3."""
    parts = []
    for name, own in rows.items():
        lines = [
            [
                str(row[name]),
                *(str(row[key]) for key in ("inputs", "predicted frames", "index entries")),
                f"{row['ratio']:.3f}",
            ]
            for row in own
        ]
        parts.append(
            markdown([name, "inputs", "predicted frames", "index entries", "ratio"], lines)
        )
    return "\n".join(parts)


def planted(row: dict[str, Any]) -> str:
    """Lay out what was found of what was planted."""
    return markdown(
        ["planted library", ""],
        [
            [name, f"{value:.3f}" if isinstance(value, float) else str(value)]
            for name, value in row.items()
        ],
    )


def draw(rows: dict[str, list[Row]], folder: Path) -> None:
    """Draw Figs. 5 to 8.

    Raises
    ------
    ImportError
        When matplotlib is not there.

    """
    from importlib import import_module

    matplotlib = import_module("matplotlib")
    matplotlib.use("Agg")
    plt = import_module("matplotlib.pyplot")
    folder.mkdir(parents=True, exist_ok=True)
    for number, (name, keys) in enumerate(
        [
            ("valid_path", ("predicted frames", "index entries")),
            ("valid_path", ("ratio",)),
            ("iou", ("predicted frames",)),
            ("iou", ("ratio",)),
        ],
        5,
    ):
        plt.figure(figsize=(6, 3.5))
        for key in keys:
            values = [row[name] for row in rows[name]]
            plt.plot(values, [row[key] for row in rows[name]], "o-", label=key)
        plt.xlabel({"valid_path": "ValidPathThr", "iou": "IoUThr"}[name])
        plt.legend()
        plt.tight_layout()
        plt.savefig(folder / f"fig{number}_{name}.png", dpi=100)
        plt.close()
