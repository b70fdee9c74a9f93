"""The plot of ratio against speed."""

from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from mocapress_bench.tables import Row, grouped, marked, stored, sum_of

_COLORS = {"codec": "tab:blue", "values": "tab:orange", "tool": "tab:gray"}
_MARKERS = {"codec": "o", "values": "D", "tool": "s"}
_LEGEND = {
    "codec": "codecs of motion",
    "values": "† numbers alone, without the text around them",
    "tool": "general-purpose tools",
}


class Point(NamedTuple):
    """A contender in the plot."""

    name: str
    speed: float
    """Of restoring files, MB/s."""
    ratio: float
    kind: str


def points(rows: list[Row]) -> list[Point]:
    """Sum up the contenders that restored everything; models count."""
    found = []
    for codec, own in grouped(rows, "codec").items():
        raw = sum_of(own, "raw_bytes")
        speed = raw / 1e6 / sum_of(own, "decompress_s")
        kind = "codec" if own[0]["header_bytes"] > 0 else "tool"  # a tool has none
        kind = kind if own[0]["counts"] == "file" else "values"
        if all(row["exact"] for row in own):
            found.append(Point(marked(codec, own), speed, raw / stored(own), kind))
    return found


def front(found: list[Point]) -> list[Point]:
    """Give the Pareto front: points that no other beats in both ratio and speed, slowest first.

    Contenders that leave out a part of the file are ignored.
    """
    best: list[Point] = []
    whole = [point for point in found if point.kind != "values"]
    for point in sorted(whole, key=lambda point: (-point.speed, -point.ratio)):
        if not best or point.ratio > best[-1].ratio:
            best.append(point)
    return best[::-1]


def draw(rows: list[Row], path: Path) -> Path:
    """Draw every contender's ratio and the speed at which it restores files, as PNG."""
    matplotlib: Any = import_module("matplotlib")
    matplotlib.use("Agg")
    plt: Any = import_module("matplotlib.pyplot")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure, axes = plt.subplots(figsize=(9, 6))
    found = points(rows)
    for kind, color in _COLORS.items():
        own = [point for point in found if point.kind == kind]
        axes.plot(
            [point.speed for point in own],
            [point.ratio for point in own],
            _MARKERS[kind],
            color=color,
            ms=6,
            label=_LEGEND[kind] if own else None,
        )
    best = front(found)
    axes.plot(
        [point.speed for point in best],
        [point.ratio for point in best],
        "-",
        color="tab:green",
        alpha=0.6,
        zorder=1,
        label="Pareto front",
    )
    axes.set_xscale("log")
    axes.margins(x=0.12, y=0.08)
    axes.set_xlabel("restoring the file, MB/s, one core")
    axes.set_ylabel(f"ratio, {len({row['clip'] for row in rows})} clips")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.tight_layout()
    _label(figure, axes, found)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path


Offset = tuple[float, float]


class Box(NamedTuple):
    """A rectangle in the plot, in points from its lower left corner."""

    left: float
    low: float
    right: float
    high: float

    def shared(self, other: "Box") -> float:
        """Give the area that both cover."""
        width = min(self.right, other.right) - max(self.left, other.left)
        height = min(self.high, other.high) - max(self.low, other.low)
        return max(width, 0) * max(height, 0)


def _label(figure: Any, axes: Any, found: list[Point]) -> None:
    """Write the names, the highest first."""
    renderer = figure.canvas.get_renderer()

    def box_of(artist: Any) -> Box:
        return Box(*(x * 72 / figure.dpi for x in artist.get_window_extent(renderer).extents))

    found = sorted(found, key=lambda point: -point.ratio)
    middles = [
        tuple(axes.transData.transform((point.speed, point.ratio)) * 72 / figure.dpi)
        for point in found
    ]
    sizes = []
    for point in found:
        text = axes.text(0, 0, point.name, fontsize=8)
        box = box_of(text)
        sizes.append((box.right - box.left, box.high - box.low))
        text.remove()
    places = place_names(middles, sizes, box_of(axes), [box_of(axes.get_legend())])
    for point, place in zip(found, places, strict=True):
        axes.annotate(
            point.name,
            (point.speed, point.ratio),
            xytext=place,
            textcoords="offset points",
            fontsize=8,
            color=_COLORS[point.kind],
            verticalalignment="bottom",
            arrowprops={"arrowstyle": "-", "color": "0.7", "lw": 0.6, "shrinkA": 0, "shrinkB": 3},
        )


def place_names(
    middles: list[Offset], sizes: list[Offset], frame: Box, taken: list[Box]
) -> list[Offset]:
    """Place names as near to their points as possible without covering points or other names.

    Parameters
    ----------
    middles, sizes
        Of the points, and of the names.
    frame
        What names should stay within.
    taken
        What they should not cover.

    Returns
    -------
    list
        Offsets of the names' lower left corners from their points.

    """
    taken = taken + [Box(x - 4, y - 4, x + 4, y + 4) for x, y in middles]
    places = []
    for (x, y), size in zip(middles, sizes, strict=True):

        def hidden(place: Offset, x: float = x, y: float = y, size: Offset = size) -> float:
            box = _box(x + place[0], y + place[1], size)
            outside = size[0] * size[1] - box.shared(frame)
            return round(outside + sum(map(box.shared, taken)))

        # Of equals, min takes the first, which is the nearest.
        place = min(_places(*size), key=hidden)
        taken.append(_box(x + place[0], y + place[1], size))
        places.append(place)
    return places


def _box(left: float, low: float, size: Offset) -> Box:
    return Box(left, low, left + size[0], low + size[1])


def _places(width: float, height: float) -> list[Offset]:
    """List where a name may stand beside its point: its lower left corner, nearest first."""
    found = []
    for distance in (5, 9, 15, 22, 30, 40, 52, 66, 82):
        for up in (0, distance, -distance, distance / 2, -distance / 2):
            found += [(distance, up - height / 2), (-distance - width, up - height / 2)]
        found += [(-width / 2, distance), (-width / 2, -distance - height)]
    return found
