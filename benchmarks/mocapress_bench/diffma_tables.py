"""The rows of ``mocapress bench diffma`` as the tables of the paper."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mocapress_bench.diffma import BOUNDS, TARGET_PSNR
from mocapress_bench.tables import grouped, markdown

Row = dict[str, Any]

# Published, per bound: mean, std, min, 1 %, 25 %, 50 %, 75 %, 99 %, max.
TABLE_2 = (
    (53.50, 17.56, 36.10, 39.96, 49.46, 52.86, 56.31, 66.83, 644.07),
    (46.48, 17.71, 28.72, 33.59, 42.59, 45.85, 49.19, 59.50, 644.07),
    (40.17, 17.85, 23.09, 27.81, 36.23, 39.50, 42.78, 52.92, 644.07),
    (34.09, 18.02, 16.33, 21.20, 30.18, 33.42, 36.72, 47.37, 644.07),
    (28.06, 18.18, 10.82, 15.62, 24.13, 27.43, 30.69, 41.31, 644.07),
    (22.07, 18.34, 4.96, 9.86, 18.13, 21.36, 24.67, 35.54, 644.07),
    (16.14, 18.47, -0.89, 5.05, 12.26, 15.37, 18.65, 29.11, 644.07),
)
TABLE_3 = (
    (37.82, 3.62, 24.42, 32.91, 36.96, 37.70, 38.47, 43.70, 146.13),
    (20.24, 3.93, 15.42, 17.44, 19.36, 19.91, 20.67, 24.85, 146.13),
    (12.15, 4.06, 9.65, 9.99, 11.32, 12.01, 12.62, 14.81, 146.13),
    (10.68, 4.07, 8.79, 8.93, 9.96, 10.60, 11.09, 12.71, 146.13),
    (10.52, 4.07, 8.77, 8.85, 9.85, 10.42, 10.91, 12.37, 146.19),
    (10.52, 4.06, 8.84, 8.93, 9.86, 10.41, 10.89, 12.35, 146.19),
    (10.59, 4.05, 9.04, 9.12, 9.94, 10.44, 10.92, 12.32, 146.19),
)
TABLE_4 = (
    (13.74, 1.76, 8.32, 11.28, 13.17, 13.65, 14.19, 16.57, 62.71),
    (9.16, 1.77, 5.66, 7.09, 8.73, 9.17, 9.56, 11.01, 62.71),
    (6.25, 1.83, 3.47, 4.19, 5.88, 6.34, 6.66, 7.65, 62.71),
    (4.98, 1.85, 2.63, 3.14, 4.61, 5.11, 5.36, 6.14, 62.71),
    (4.14, 1.85, 2.15, 2.55, 3.79, 4.24, 4.51, 5.19, 62.71),
    (3.41, 1.85, 1.79, 2.09, 3.08, 3.44, 3.72, 4.47, 62.97),
    (2.79, 1.83, 1.50, 1.72, 2.48, 2.76, 3.02, 3.80, 62.71),
)
# Bits per sample with LZMA, PSNR: section 3.4.
_PUBLISHED = {
    f"one β for {TARGET_PSNR:g} dB": ("6.94", "40.46"),
    "zfp 0.125": ("8.59", "39.72"),
    "the file": ("24.4", ""),
}
_STATISTICS = ["mean", "std", "min", "1 %", "25 %", "50 %", "75 %", "99 %", "max"]


def report(rows: list[Row]) -> str:
    """Give all tables."""
    clips = len({row["clip"] for row in rows})
    parts = [
        f"{clips} clips. In Tables 2 to 4, measured / published (2514 clips).\n",
        "**Table 2**, PSNR in dB\n",
        _statistics(rows, "psnr", TABLE_2),
        "**Table 3**, bits per sample of the JSON\n",
        _statistics(rows, "bits", TABLE_3),
        "**Table 4**, bits per sample of the JSON with LZMA\n",
        _statistics(rows, "packed_bits", TABLE_4),
        "**All contenders**, with LZMA\n",
        _contenders(rows),
    ]
    return "\n".join(parts)


def speeds(found: dict[str, float]) -> str:
    """Give million samples per second, one line for each kind of work."""
    lines = [[what, f"{rate:.1f}"] for what, rate in found.items()]
    return "**Speed**\n\n" + markdown(["", "million samples/s"], lines)


def _statistics(rows: list[Row], key: str, published: Sequence[Sequence[float]]) -> str:
    by_codec = grouped(rows, "codec")
    lines = []
    for bound, theirs in zip(BOUNDS, published, strict=True):
        values = np.array([row[key] for row in by_codec[f"β = {bound:g}"]])
        values = values[np.isfinite(values)]  # a clip without error has no PSNR
        if not len(values):
            lines.append([f"{bound:g}", *[""] * len(_STATISTICS)])
            continue
        ours = [values.mean(), values.std(), values.min()]
        ours += [np.percentile(values, part) for part in (1, 25, 50, 75, 99)]
        ours.append(values.max())
        pairs = zip(ours, theirs, strict=True)
        lines.append([f"{bound:g}", *(f"{one:.2f} / {other:.2f}" for one, other in pairs)])
    return markdown(["β", *_STATISTICS], lines)


def _contenders(rows: list[Row]) -> str:
    lines = []
    for codec, own in grouped(rows, "codec").items():
        bits, theirs = _PUBLISHED.get(codec, ("", ""))
        lines.append(
            [
                codec,
                f"{_over(own, 'packed_bits', np.mean):.2f}",
                bits,
                f"{_over(own, 'packed_bits', np.std):.2f}",
                f"{_over(own, 'packed_bits', np.median):.2f}",
                f"{_over_samples(own, 'packed_bits'):.2f}",
                f"{_over(own, 'psnr', np.mean):.2f}",
                theirs,
                f"{_over(own, 'psnr', np.median):.2f}",
                f"{_over(own, 'psnr', np.min):.2f}",
                f"{_over(own, 'largest_error', np.max):.3g}",
                f"{_over(own, 'bound', np.mean):.2f}",
                f"{100 * _over(own, 'predicted', np.mean):.0f}",
            ]
        )
        lines[-1] = ["" if cell == "nan" else cell for cell in lines[-1]]
    header = ["", "bits/sample", "published", "std", "median", "of all samples"]
    header += ["PSNR, dB", "published", "median"]
    return markdown([*header, "least", "largest error", "mean β", "% order > 0"], lines)


def _over_samples(rows: list[Row], key: str) -> float:
    """Give the mean over samples, in which a long clip counts for more than a short one."""
    samples = [row["frames"] * row["channels"] for row in rows]
    return float(np.average([row[key] for row in rows], weights=samples))


def _over(rows: list[Row], key: str, summary: Callable[[Any], Any]) -> float:
    """Summarize a field of those clips where it is finite."""
    values = np.array([row.get(key, np.nan) for row in rows], dtype=np.float64)
    finite = values[np.isfinite(values)]
    return float(summary(finite)) if len(finite) else float("nan")
