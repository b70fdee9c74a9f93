"""What ``mocapress bench lossy`` has measured, as a table and as a plot."""

import io
from importlib import import_module
from math import isnan
from typing import Any

from mocapress_bench.lossy import Point
from mocapress_bench.tables import markdown

_MARKED = {"ACL": "s", "CurveCodec 2, as stated": "*"}


def report(points: list[Point], clips: list[str]) -> str:
    """Give the table of points over all clips."""
    rows = [
        [
            point.contender,
            point.setting,
            f"{point.bits:.2f}",
            f"{point.mean:.4f}",
            "not stated" if isnan(point.most) else f"{point.most:.3f}",
        ]
        for point in sorted(points, key=lambda point: (point.contender, point.mean))
    ]
    header = ["contender", "setting", "bits a joint sample", "mean error, cm", "largest, cm"]
    said = f"Clips {', '.join(clips)} together.\n\n"
    return said + markdown(header, rows)


def draw(points: list[Point]) -> bytes:
    """Draw bits a joint sample against mean and largest errors, as PNG."""
    matplotlib: Any = import_module("matplotlib")
    matplotlib.use("Agg")
    plt: Any = import_module("matplotlib.pyplot")
    figure, both = plt.subplots(1, 2, figsize=(12, 5.5), sharey=True)
    names = list(dict.fromkeys(point.contender for point in points))
    for axes, of, label in zip(both, ("mean", "most"), ("mean", "largest"), strict=True):
        for name in names:
            own = sorted((getattr(point, of), point.bits) for point in points
                         if point.contender == name and not isnan(getattr(point, of)))  # fmt: skip
            if not own:
                continue
            marked = _MARKED.get(name)
            # Settings of gltfpack differ in two ways, and lie on no curve.
            style = f"{marked}:" if marked else "o" if name == "gltfpack" else "o-"
            errors, bits = zip(*own, strict=True)
            axes.plot(errors, bits, style, ms=9 if marked else 5, label=name)
        axes.set(xscale="log", yscale="log", xlabel=f"{label} error of joints, cm")
        axes.grid(visible=True, which="both", alpha=0.25)
    both[0].set_ylabel("bits a joint sample")
    both[0].legend(fontsize=9)
    figure.tight_layout()
    contents = io.BytesIO()
    figure.savefig(contents, format="png", dpi=110)
    plt.close(figure)
    return contents.getvalue()
