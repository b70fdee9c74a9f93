"""Tables of numbers in several dialects, put together as text."""

import numpy as np
from numpy.typing import NDArray

RANDOM = np.random.default_rng(7)


def markers(frames: int = 150) -> NDArray[np.float64]:
    """Give the coordinates of four markers, (F, 12); the second is missing for a while."""
    time = np.arange(frames)[:, None]
    noise = np.random.default_rng(frames).normal(size=(frames, 12))
    places: NDArray[np.float64] = 900 * np.sin(0.05 * time + np.arange(12)) + noise
    places[20:40, 3:6] = np.nan
    return places


def trc(
    places: NDArray[np.float64],
    *,
    delimiter: str = "\t",
    line_break: str = "\r\n",
    missing: str = "",
    number: str = "{:.5f}",
    declared: int | None = None,
    rate: str = "120.00",
) -> bytes:
    """Give a TRC of markers, (F, 3P)."""
    count = places.shape[1] // 3
    labels = [cell for i in range(count) for cell in (f"M{i}", "", "")]
    axes = [f"{axis}{i + 1}" for i in range(count) for axis in "XYZ"]
    frames = str(len(places) if declared is None else declared)
    lines = [
        ["PathFileType", "4", "(X/Y/Z)", "walk.trc"],
        ["DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units"],
        [rate, rate, frames.rjust(10), str(count), "mm"],
        ["Frame#", "Time", *labels],
        ["", "", *axes],
        [""],
    ]
    for frame, row in enumerate(places):
        cells = [missing if np.isnan(x) else number.format(float(x)) for x in row]
        lines.append([str(frame + 1), f"{frame / 120:.3f}", *cells])
    return line_break.join(delimiter.join(cells) for cells in lines).encode() + line_break.encode()


def odd_table() -> bytes:
    """Give a table with texts, padded numbers, a broken row, and cells unlike the others."""
    places = markers()
    lines = ["# recorded", '"time","left, x",left y,state,note,none']
    for row, (x, y) in enumerate(places[:, :2]):
        state = "stance" if row % 9 < 5 else "swing"
        cells = [f"{row / 50:.2f}", f"{x:12.4f}", f"{y:.6g}", state, "same", "NaN"]
        if row == 31:
            cells[2] = "1.50"
        if row == 50:
            cells[2] = "n/a"
        lines.append(",".join(cells))
        if row == 60:
            lines.append("broken,row")
    lines[0] += ",,,,"
    return "\n".join(lines).encode()


def commas() -> bytes:
    """Give a table in UTF-16 whose numbers have decimal commas."""
    rows = ["\t".join(f"{x:.4f}" for x in row) for row in markers()]
    text = "\r\n".join(["\t".join(f"Kanal {i}" for i in range(12)), *rows])
    return b"\xff\xfe" + text.replace("nan", "n/a").replace(".", ",").encode("utf-16-le")


def cells() -> bytes:
    """Give a table of quaternions, each in one cell."""
    rows = []
    for frame, row in enumerate(markers()[:, :8]):
        several = (",".join(f"{x:.5f}" for x in part) for part in (row[:4], row[4:]))
        rows.append("\t".join([f"{frame / 60:.4f}", *several]))
    return "\n".join(["DataType=Quaternion", "time\tpelvis\ttorso", *rows]).encode()
