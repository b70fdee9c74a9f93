"""Finding the grid on which numbers lie that were whole numbers once."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
Places = NDArray[np.int64]
Grid = tuple[float, float, Places, Places]
"""Origin, step, and where numbers are some floats away from origin + step * place."""

_FEWEST = 3
_WIDEST = 2**23
"""Steps from one end of a grid to the other."""
_NEAR = 0.2
"""In steps: how far from its place on the grid a number may lie while the grid is being found."""
_ON_GRID = 0.97
"""The least share of numbers that have to be on a grid; the others are told one by one."""


def find_grid(distinct: Values) -> Grid | None:
    """Find the grid of float32 numbers in ascending order, (N,); None where there is none."""
    if len(distinct) < _FEWEST:
        return None
    ulp = np.maximum(np.abs(distinct[1:]), np.abs(distinct[:-1])) * 2.0**-23
    gaps = np.diff(distinct)
    wide = np.sort(gaps[gaps > 4 * ulp])
    if len(wide) < _FEWEST - 1 or len(wide) < 0.9 * len(gaps):
        return None
    for share in (0.0, 0.02, 0.1, 0.3):
        on_grid = _places(distinct, gaps, wide, float(wide[int(share * (len(wide) - 1))]))
        if on_grid is not None:
            found = _fitted(*on_grid)
            if found is not None:
                return found
    return None


def _places(
    distinct: Values, gaps: Values, wide: Values, step: float
) -> tuple[Values, Places] | None:
    """Give numbers on a grid of about this step, all but a few, and their places from the first."""
    for _ in range(3):
        steps = np.rint(wide / step)
        near = (steps >= 1) & (steps <= 16)
        if not near.any():
            return None
        step = float(wide[near].sum() / steps[near].sum())
    steps = gaps / step
    near = steps < 64
    if not near.any() or (np.abs(steps - np.rint(steps))[near] > _NEAR).mean() > 0.02:
        return None
    # From the middle of the densest numbers outwards, the step becomes known ever better.
    count = min(len(distinct), 16)
    widths = distinct[count - 1 :] - distinct[: len(distinct) - count + 1]
    middle = int(np.argmin(widths)) + count // 2
    origin = float(distinct[middle])
    order = np.argsort(np.abs(distinct - origin), kind="stable")
    while True:
        inner = distinct[order[:count]]
        places = np.rint((inner - origin) / step)
        if places.max() - places.min() < 1:
            return None
        step, origin = _line(places, inner)
        if not step > 0:
            return None
        if count == len(distinct):
            break
        count = min(2 * count, len(distinct))
    places = np.rint((distinct - origin) / step)
    places -= places[0]
    origin = float(np.median(distinct - step * places))
    on_grid = np.abs((distinct - origin) / step - places) <= 2 * _NEAR
    # Of numbers that share a place, such as 0 and what rounding made of it, the first is on it.
    on_grid[1:] &= np.diff(places) > 0
    kept = places[on_grid] - places[on_grid][0] if on_grid.any() else places
    if on_grid.mean() < _ON_GRID or kept[-1] >= _WIDEST or kept[-1] < 1:
        return None
    return distinct[on_grid], kept.astype(np.int64)


def _line(places: Values, numbers: Values) -> tuple[float, float]:
    """Give step and origin of the line through numbers, by least squares."""
    middle, mean = places.mean(), numbers.mean()
    away = places - middle
    step = float((away * (numbers - mean)).sum() / (away * away).sum())
    return step, float(mean - step * middle)


def _fitted(distinct: Values, places: Places) -> Grid | None:
    """Find the origin and step, plain numbers if possible, that miss the fewest floats."""
    step, origin = _line(places.astype(np.float64), distinct)
    half = np.maximum(np.abs(distinct), 2.0**-126) * 2.0**-24
    room = 4 * float(half.max()) / float(places[-1] - places[0])
    shift = round(origin / step)
    best: tuple[int, float, float, Places] | None = None
    floats = distinct.astype(np.float32)
    for counted in (places + shift, places):
        whole = counted.astype(np.float64)
        for own in _plain(step, room):
            rest = distinct - own * whole
            low, high = float((rest - half).max()), float((rest + half).min())
            for start in _origins(low, high, float(np.median(rest))):
                missed = int(((start + own * whole).astype(np.float32) != floats).sum())
                if best is None or missed < best[0]:
                    best = missed, start, own, counted
                if missed == 0:
                    return start, own, np.empty(0, np.int64), np.empty(0, np.int64)
    if best is None:
        return None
    _, start, own, counted = best
    given = (start + own * counted.astype(np.float64)).astype(np.float32)
    away = _ordered(floats) - _ordered(given)
    moved = away != 0
    return start, own, counted[moved], away[moved]


def _plain(step: float, room: float) -> Iterator[float]:
    """Give steps within some room of one: few decimals, few binary digits, a float, itself."""
    for digits in range(1, 10):
        plain = float(f"{step:.{digits - 1}e}")
        if abs(plain - step) <= room:
            yield plain
            break
    for digits in range(1, 40):
        mantissa, exponent = np.frexp(step)
        plain = float(np.ldexp(np.rint(np.ldexp(mantissa, digits)), exponent - digits))
        if abs(plain - step) <= room:
            yield plain
            break
    yield float(np.float32(step))
    yield step


def _origins(low: float, high: float, middle: float) -> Iterator[float]:
    """Give origins between two numbers, the plainest first; if there are none, a likely one."""
    if low > high:
        if low * high <= 0 or abs(middle) < 0.5 * (low - high):
            yield 0.0
        yield middle
        return
    if low <= 0 <= high:
        yield 0.0
    inner = (low + high) / 2
    for digits in range(1, 12):
        plain = float(f"{inner:.{digits - 1}e}")
        if low <= plain <= high:
            yield plain
            break
    yield inner


def _ordered(floats: NDArray[np.float32]) -> Places:
    bits = floats.view(np.int32).astype(np.int64)
    return np.where(bits >= 0, bits, -1 - (bits + 2**31))
