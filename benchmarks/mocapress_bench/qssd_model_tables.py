"""The figure and the tables of section 4 of the QSSD paper, measured beside published."""

from importlib import import_module
from pathlib import Path
from typing import Any

from mocapress_bench.qssd_model import Row
from mocapress_bench.tables import markdown

_TABLE_1 = {
    "walking": {"QSSD": (0.0030, 0.0053), "K-SVD, components": (0.0135, 0.0271)},
    "mixed": {"QSSD": (0.0052, 0.0105), "K-SVD, components": (0.0148, 0.0293)},
}
_TABLE_2 = {
    "K-SVD, components": (0.8, 1.8, 0.9, 2.0, 3.6, 9.1, 3.7, 9.5),
    "QSSD": (1.8, 3.1, 2.1, 4.2, 6.6, 13.3, 8.2, 14.9),
}


def simulated(rows: list[Row]) -> str:
    """Lay out the end of each curve of Fig. 1."""
    lines = []
    for row in rows:
        enough = next((i for i, part in enumerate(row["restored"], 1) if part >= 0.95), None)
        lines.append(
            [
                f"{row['model']}, {_data(row)}",
                f"{row['errors'][0]:.2f}",
                f"{min(row['errors']):.3f}",
                f"{100 * row['restored'][-1]:.0f} %",
                str(enough or "never"),
            ]
        )
    head = ["made-up data", "error after 1, degrees", "least error", "restored"]
    return markdown([*head, "95 % restored after"], lines)


def errors(name: str, rows: list[Row]) -> str:
    """Lay out Table 1: degrees of the whole turn, and Eq. 11, which is half of that, in radians."""
    published = _TABLE_1.get(name, {})
    lines = []
    for row in rows:
        told = published.get(row["model"])
        lines.append(
            [
                row["model"],
                f"{row['training']:.3f}",
                f"{row['test']:.3f} ± {row['spread of test']:.3f}",
                *(f"{row[key] / 2 * 0.0174532925:.4f}" for key in ("training", "test")),
                *(f"{value:.4f}" for value in told or ()),
                *([] if told else ["", ""]),
            ]
        )
    head = [name, "training, degrees", "test", "training, radians of half the angle", "test"]
    return markdown([*head, "training, published", "test, published"], lines)


def times(rows: list[Row]) -> str:
    """Lay out Table 2: seconds an iteration, elapsed; the processors' time in brackets."""
    grid = list(dict.fromkeys((row["frames"], row["atoms"], row["most"]) for row in rows))
    lines = []
    for name in dict.fromkeys(row["model"] for row in rows):
        own = [row for row in rows if row["model"] == name]
        cells = [f"{row['seconds']:.3f} ({row['of all processors']:.3f})" for row in own]
        lines.append([name, *cells])
    if [frames for frames, _, _ in grid] == 4 * [1000] + 4 * [5000]:
        for name, told in _TABLE_2.items():
            lines.append([f"{name}, published (2012, one core)", *map(str, told)])
    return markdown(["s an iteration", *(f"N={n} K={k} L={m}" for n, k, m in grid)], lines)


def draw(rows: list[Row], folder: Path) -> None:
    """Draw Fig. 1 for each size of the coefficients: errors above, parts restored below.

    Raises
    ------
    ImportError
        When matplotlib is not there.

    """
    matplotlib: Any = import_module("matplotlib")
    matplotlib.use("Agg")
    plt: Any = import_module("matplotlib.pyplot")
    folder.mkdir(parents=True, exist_ok=True)
    for reach in dict.fromkeys(row["coefficients"] for row in rows):
        figure, (above, below) = plt.subplots(2, 1, figsize=(7, 6), sharex=True)
        for row in rows:
            if row["coefficients"] == reach and row["model"] == "QSSD":
                above.plot(row["errors"], label=_noise(row))
                below.plot(row["restored"], label=_noise(row))
        above.set_ylabel("error, degrees a joint")
        below.set_ylabel("part of atoms restored")
        below.set_xlabel("iterations")
        above.legend()
        figure.tight_layout()
        figure.savefig(folder / f"qssd_fig1_{reach:g}.png", dpi=100)
        plt.close(figure)


def _data(row: Row) -> str:
    size = f"coefficients N(0, {row['coefficients']:g})" if row["coefficients"] else "as printed"
    return f"{size}, {_noise(row)}"


def _noise(row: Row) -> str:
    return f"{row['noise']:g} dB" if row["noise"] is not None else "no noise"
