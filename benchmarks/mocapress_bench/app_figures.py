"""The numbers behind the APP paper's Figs. 5 to 9, and their plots."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.app import ALPHA_TABLES, App, average_prediction_error, ideal_alphas
from mocapress.motion import Clip
from mocapress_bench.tables import markdown

CLUSTERS = (1, 3, 5, 10, 15, 18, 20, 30)
_EDGES = (0.5, 1.0, 2.0, 5.0)
_PAPER_FIG5 = (50, 21, 18, 7, 4)

Numbers = dict[str, Any]


def measure(
    clips: list[tuple[Clip, int]], progress: Callable[[str], None] = lambda _: None
) -> Numbers:
    """Measure clips, each with the bytes of its file, over all tables and cluster sizes.

    Returns
    -------
    dict
        ``alpha``: shares (%) of ideal alphas by magnitude, per t (Fig. 5); ``clip_alpha``: the
        ideal alphas of one clip at t = 10 (Fig. 6); ``sweep``: rows of table, t, MCR, TCR, APE over
        all clips (Figs. 7 to 9).

    """
    alphas: dict[int, list[float]] = {}
    for t in CLUSTERS[1:]:
        progress(f"ideal alphas, t = {t}")
        found = [_magnitudes(ideal_alphas(clip, t)) for clip, _ in clips]
        alphas[t] = _shares(np.concatenate(found)) if found else []
    sweep = []
    raw = sum(size for _, size in clips)
    sizes = [clip.values.size for clip, _ in clips]
    for table in ALPHA_TABLES:
        for t in CLUSTERS:
            progress(f"{table}, t = {t}")
            codec = App(t=t, table=table)
            encoded = [codec.encode(clip.main, skeleton=clip.skeleton) for clip, _ in clips]
            size = sum(len(chunk.payload) for one in encoded for chunk in one.chunks)
            indices = sum(one.index_bytes for one in encoded)
            error = [average_prediction_error(clip, codec) for clip, _ in clips]
            sweep.append(
                {
                    "table": table,
                    "t": t,
                    "MCR": raw / (size - indices),
                    "TCR": raw / size,
                    "APE": float(np.average(error, weights=sizes)),
                }
            )
    shown = min(clips, key=lambda item: abs(item[0].frames - 641))[0]
    return {
        "alpha": alphas,
        "clip": shown.name,
        "clip_frames": shown.frames,
        "clip_alpha": ideal_alphas(shown, 10),
        "sweep": sweep,
    }


def report(numbers: Numbers) -> str:
    """Give the numbers as Markdown."""
    shares = markdown(
        ["magnitude", "0-0.5", "0.5-1", "1-2", "2-5", "above 5"],
        [["paper, 1021 clips", *(f"{share} %" for share in _PAPER_FIG5)]]
        + [[f"t = {t}", *(f"{x:.1f} %" for x in row)] for t, row in numbers["alpha"].items()],
    )
    inside = float((_magnitudes(numbers["clip_alpha"]) <= 2).mean() * 100)
    tables = list(ALPHA_TABLES)
    parts = [
        "### Fig. 5: ideal α of all clips\n",
        shares,
        f"### Fig. 6: ideal α of {numbers['clip']}, {numbers['clip_frames']} frames, t = 10\n",
        f"{inside:.1f} % lie within [-2, 2]; the paper's 641-frame dancing clip: 91 %.\n",
    ]
    for figure, measure_name in (("7", "TCR"), ("8", "MCR"), ("9", "APE")):
        cells = {(row["table"], row["t"]): row[measure_name] for row in numbers["sweep"]}
        parts += [
            f"### Fig. {figure}: {measure_name} over t\n",
            markdown(
                ["t", *tables],
                [[str(t), *(f"{cells[table, t]:.4g}" for table in tables)] for t in CLUSTERS],
            ),
        ]
    return "\n".join(parts)


def draw(numbers: Numbers, folder: Path) -> list[Path]:
    """Draw Figs. 5 to 9 as PNG files."""
    matplotlib: Any = import_module("matplotlib")
    matplotlib.use("Agg")
    plt: Any = import_module("matplotlib.pyplot")
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []

    def save(name: str) -> None:
        plt.tight_layout()
        plt.savefig(folder / name, dpi=110)
        plt.close()
        drawn.append(folder / name)

    plt.figure(figsize=(7, 4))
    labels = ["≤ 0.5", "0.5-1", "1-2", "2-5", "> 5"]
    shown = {"paper": _PAPER_FIG5} | {f"t = {t}": numbers["alpha"][t] for t in (5, 10, 15, 30)}
    for i, (name, row) in enumerate(shown.items()):
        plt.bar(np.arange(5) + 0.16 * (i - 2), row, 0.16, label=name)
    plt.xticks(range(5), labels)
    plt.xlabel("magnitude of the ideal α")
    plt.ylabel("share, %")
    plt.legend()
    save("fig5_ideal_alpha.png")

    plt.figure(figsize=(7, 4))
    alpha = numbers["clip_alpha"]
    clusters = np.broadcast_to(np.arange(len(alpha))[:, None], alpha.shape)
    plt.plot(clusters.ravel(), alpha.ravel(), ".", ms=2)
    plt.ylim(-6, 6)
    plt.xlabel(f"cluster of 10 frames, {numbers['clip']}")
    plt.ylabel("ideal α")
    save("fig6_ideal_alpha_of_a_clip.png")

    for figure, name in (("fig7", "TCR"), ("fig8", "MCR")):
        plt.figure(figsize=(7, 4))
        for table in ALPHA_TABLES:
            own = [row for row in numbers["sweep"] if row["table"] == table]
            plt.plot([row["t"] for row in own], [row[name] for row in own], "o-", label=table)
        plt.xlabel("frames per cluster, t")
        plt.ylabel(name)
        plt.legend()
        save(f"{figure}_{name.lower()}.png")

    own = [row for row in numbers["sweep"] if row["table"] == App().table]
    _, left = plt.subplots(figsize=(7, 4))
    right = left.twinx()
    times = [row["t"] for row in own]
    left.plot(times, [row["MCR"] for row in own], "o-", label="MCR")
    left.plot(times, [row["TCR"] for row in own], "s-", label="TCR")
    right.plot(times, [row["APE"] for row in own], "^--", color="tab:red", label="APE (right)")
    left.set_xlabel("frames per cluster, t")
    left.set_ylabel("ratio")
    right.set_ylabel("average prediction error")
    lines = [*left.get_lines(), *right.get_lines()]
    left.legend(lines, [line.get_label() for line in lines], loc="lower right")
    save("fig9_ratio_and_error.png")
    return drawn


def _magnitudes(alphas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the magnitudes of the alphas that are defined and not 0 (parents that move)."""
    magnitudes: NDArray[np.float64] = np.abs(alphas[np.isfinite(alphas) & (alphas != 0)])
    return magnitudes


def _shares(magnitudes: NDArray[np.float64]) -> list[float]:
    counts = np.histogram(magnitudes, [0, *_EDGES, np.inf])[0]
    return [float(100 * count / max(len(magnitudes), 1)) for count in counts]
