"""The plot of ratio against speed."""

from importlib import import_module
from pathlib import Path
from typing import Any

from mocapress.bench.tables import Row, grouped, sum_of


def draw(rows: list[Row], path: Path) -> Path:
    """Draw every contender's ratio and the speed at which it restores files, as PNG."""
    matplotlib: Any = import_module("matplotlib")
    matplotlib.use("Agg")
    plt: Any = import_module("matplotlib.pyplot")
    path.parent.mkdir(parents=True, exist_ok=True)
    plt.figure(figsize=(8, 4.5))
    placed: list[str] = []
    for codec, own in grouped(rows, "codec").items():
        ratio = sum_of(own, "raw_bytes") / sum_of(own, "compressed_bytes")
        speed = sum_of(own, "raw_bytes") / 1e6 / sum_of(own, "decompress_s")
        ours = own[0]["header_bytes"] > 0  # a tool has none
        plt.plot(speed, ratio, "o" if ours else "s", color="tab:blue" if ours else "tab:gray", ms=7)
        # Ours are close to each other: every other label below its point.
        above = not ours or len(placed) % 2 == 0
        placed += [codec] if ours else []
        plt.annotate(
            codec,
            (speed, ratio),
            xytext=(6, 4 if above else -11),
            textcoords="offset points",
            fontsize=8,
        )
    clips = len({row["clip"] for row in rows})
    plt.xscale("log")
    plt.xlabel("restoring the file, MB/s, one core")
    plt.ylabel(f"ratio, {clips} clips")
    plt.grid(alpha=0.3)
    plt.tight_layout()
    plt.savefig(path, dpi=110)
    plt.close()
    return path
