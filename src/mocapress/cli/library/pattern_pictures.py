"""Pictures of what recurs in a library: the paths of the trellis, and the forest."""

from collections.abc import Sequence
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mocapress.errors import UnsupportedError
from mocapress.storage import write_whole

if TYPE_CHECKING:
    from mocapress.library.recurring import Recurring


def draw(found: "Sequence[Recurring]", folder: Path, *, force: bool) -> list[Path]:
    """Draw two pictures for each group of clips; give their files.

    Raises
    ------
    UnsupportedError
        When matplotlib is not there.
    ExistsError
        When there is a picture, and it is not to be overwritten.

    """
    try:
        matplotlib = import_module("matplotlib")
    except ImportError:
        raise UnsupportedError(
            "pictures need matplotlib", expected="pip install 'mocapress[mrpa]'"
        ) from None
    matplotlib.use("Agg")
    plt = import_module("matplotlib.pyplot")
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for number, group in enumerate(found, 1):
        for name, picture in (("paths", _paths), ("forest", _forest)):
            figure = picture(plt, group)
            data = BytesIO()
            figure.savefig(data, dpi=110, bbox_inches="tight", format="png")
            plt.close(figure)
            drawn.append(folder / f"{name}_{number}.png")
            write_whole(drawn[-1], data.getvalue(), force=force)
    return drawn


def _paths(plt: Any, group: "Recurring") -> Any:
    """Draw each path by its frames of the top row and their matches, as in the paper's Fig. 2."""
    figure, axes = plt.subplots(figsize=(8, 8))
    paths = group.found.paths
    for path in range(len(paths)):
        matches = paths.matches(path)
        axes.plot(paths.first[path] + range(len(matches)), matches, lw=0.8)
    for start in group.found.starts[1:-1].tolist():
        axes.axvline(start, color="0.85", lw=0.5, zorder=0)
        axes.axhline(start, color="0.85", lw=0.5, zorder=0)
    axes.set_xlim(0, len(group.found.clips))
    axes.set_ylim(0, len(group.found.clips))
    axes.set_aspect("equal")
    axes.set_xlabel("frame of the clips, one behind the other")
    axes.set_ylabel("frame that it resembles")
    return figure


def _forest(plt: Any, group: "Recurring") -> Any:
    """Draw the trees of more than a root, each segment below its parent."""
    lines = [(place, depth) for tree in group.trees() for place, depth in tree]
    figure, axes = plt.subplots(figsize=(8, max(1.5, 0.22 * len(lines))))
    axes.set_axis_off()
    axes.set_ylim(len(lines) + 1, -1)
    axes.set_xlim(0, 10)
    if not lines:
        axes.text(0, 0, "no segment resembles another")
    above: dict[int, int] = {}
    for row, (place, depth) in enumerate(lines):
        above[depth] = row
        axes.text(0.4 * depth + 0.1, row, str(place), va="center", fontsize=8)
        if depth:
            axes.plot([0.4 * depth - 0.3] * 2, [above[depth - 1] + 0.3, row], color="0.6", lw=0.8)
            axes.plot([0.4 * depth - 0.3, 0.4 * depth], [row, row], color="0.6", lw=0.8)
    return figure
