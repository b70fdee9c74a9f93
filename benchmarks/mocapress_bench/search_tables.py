"""Tables and pictures of the evaluation of search."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress_bench.tables import markdown

_COLUMNS = {
    "true positives": "true positives",
    "true positives across": "across actors",
    "first": "P@1",
    "first across": "across",
    "five": "P@5",
    "five across": "across",
    "mAP": "mAP",
    "mAP across": "across",
    "split": "1-NN split",
    "nearest by the same actor": "nearest by the same actor",
    "mirrored": "mirrored query",
    "mirrored, option": "with the option",
}


def ranked(name: str, rows: Sequence[dict[str, Any]]) -> str:
    """Lay out how well methods rank, per cent, and what they cost."""
    used = [key for key in _COLUMNS if any(row[key] is not None for row in rows)]
    lines = []
    for row in rows:
        cells = ["" if row[key] is None else f"{row[key]:.1f}" for key in used]
        if row["seeds"] > 1:
            cells[0] += f" ± {row['spread']:.1f}"
        cost = [f"{row[key]:.2g}" for key in ("ms a clip", "ms a query")]
        lines.append([row["method"], *cells, *cost, f"{row['bytes']:.0f}"])
    head = [name, *(_COLUMNS[key] for key in used), "ms a clip", "ms a query", "bytes a clip"]
    return markdown(head, lines)


def stretches(rows: Sequence[dict[str, Any]]) -> str:
    """Lay out how well methods find stretches of long takes."""
    names = {
        "recall at R": "joined cuts: recall at R, %",
        "IoU": "mean IoU",
        "ms a query in takes": "ms a query",
        "frame AP": "labelled takes: frame AP, %",
        "first right": "first hit right, %",
    }
    lines = [
        [row["method"], *(f"{row[key]:.3g}" if row.get(key) is not None else "" for key in names)]
        for row in rows
    ]
    return markdown(["stretches", *names.values()], lines)


def confused(name: str, classes: list[str], matrix: NDArray[np.float64]) -> str:
    """Lay out a confusion matrix: rows are queries' classes, columns those of what was found."""
    lines = [
        [one, *(f"{value:.0f}" if value >= 0.5 else "" for value in row)]
        for one, row in zip(classes, matrix, strict=True)
    ]
    return markdown([name, *classes], lines)


def draw(named: dict[str, tuple[list[str], NDArray[np.float64]]], path: Path) -> None:
    """Draw confusion matrices side by side (Fig. 7).

    Raises
    ------
    ImportError
        When matplotlib is not there.

    """
    matplotlib: Any = import_module("matplotlib")
    matplotlib.use("Agg")
    plt: Any = import_module("matplotlib.pyplot")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure, all_axes = plt.subplots(
        1, len(named), figsize=(7 * len(named), 6.5), squeeze=False, layout="constrained"
    )
    for axes, (name, (classes, matrix)) in zip(all_axes[0], named.items(), strict=True):
        axes.imshow(matrix, cmap="Blues", vmin=0, vmax=100)
        for (row, column), value in np.ndenumerate(matrix):
            if value >= 0.5:
                colour = "white" if value > 50 else "black"
                axes.text(column, row, f"{value:.0f}", ha="center", va="center", color=colour)
        axes.set_xticks(range(len(classes)), classes, rotation=45, ha="right")
        axes.set_yticks(range(len(classes)), classes)
        axes.set_title(f"{name}, %")
        axes.set_xlabel("found")
        axes.set_ylabel("asked for")
    figure.savefig(path, dpi=70, bbox_inches="tight")
    plt.close(figure)
