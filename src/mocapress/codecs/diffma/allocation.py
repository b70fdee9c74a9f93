"""Choosing bounds and orders: one bound for a file, or each channel's own at the least rate."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.diffma.coding import Coding, Plan, Record

# Bits that a number of the look-up table costs in the packed JSON: six digits and what parts them.
_TABLE_BITS = 24.0
# A quarter of an octave apart, in three digits, which is what the JSON has to hold; and one so
# small that all goes to the table, so that every target can be met.
CHANNEL_BOUNDS = (1e-9, *(float(f"{2 ** (k / 4):.3g}") for k in range(-8, 37)))
# Of the paper, section 3.4.
FILE_BOUNDS = tuple(2.0**k for k in range(7))
# Higher ones amplify the errors of what they continue even more.
AUTO_ORDERS = (0, 1, 2)


@dataclass(frozen=True, slots=True)
class Trial:
    """What a plan for every channel gives."""

    plans: tuple[Plan, ...]
    errors: NDArray[np.float64]
    """(C,) sum of squared errors."""
    rates: NDArray[np.float64]
    """(C,) estimated bits."""


def attempt(coding: Coding, channels: NDArray[np.float64], plans: Sequence[Plan]) -> Trial:
    """Code channels, (C, F), and measure what comes of it."""
    records = coding.encode(channels, plans)
    # Squares of huge errors are infinite; a finite number can be subtracted from itself.
    errors = np.minimum([record.squared_error for record in records], 1e300)
    return Trial(tuple(plans), errors, np.array([_rate(record) for record in records]))


def psnr(squared_errors: float, samples: int) -> float:
    """Give -10 log10 of the mean squared error (section 3.4), dB; infinite without error."""
    if squared_errors == 0 or samples == 0:
        return float("inf")
    return float(-10 * np.log10(squared_errors / samples))


def with_orders(
    coding: Coding, channels: NDArray[np.float64], plans: Sequence[Plan]
) -> tuple[Plan, ...]:
    """Give each channel the order of least rate among those that lose no more than order 0."""
    trials = [
        attempt(coding, channels, [replace(plan, order=order) for plan in plans])
        for order in AUTO_ORDERS
    ]
    rates = np.array([trial.rates for trial in trials])
    rates[np.array([trial.errors for trial in trials]) > trials[0].errors] = np.inf
    return tuple(trials[best].plans[c] for c, best in enumerate(rates.argmin(axis=0)))


def one_bound(
    coding: Coding, channels: NDArray[np.float64], plans: Sequence[Plan], target_psnr: float
) -> tuple[Plan, ...]:
    """Give all channels the power of two that comes nearest to a PSNR, as the paper does."""
    trials = [
        attempt(coding, channels, [replace(plan, bound=bound) for plan in plans])
        for bound in FILE_BOUNDS
    ]
    distances = [
        abs(psnr(float(trial.errors.sum()), channels.size) - target_psnr) for trial in trials
    ]
    # Where nothing is lost by any bound, all are equally far: the first is as good as any.
    return trials[int(np.argmin(np.nan_to_num(distances, posinf=1e9)))].plans


def own_bounds(
    coding: Coding,
    channels: NDArray[np.float64],
    plans: Sequence[Plan],
    target_psnr: float | None,
    orders: Sequence[int],
) -> tuple[Plan, ...]:
    """Give each channel the bound, and the order, that make the whole smallest.

    With a target, the sum of rates is least among those whose PSNR reaches it, up to the grid
    of bounds: rate + lambda x squared error is least in each channel on its own, for the one lambda
    that meets the target. Without, the rate alone is; the largest errors are the plans'.
    """
    trials = [
        attempt(coding, channels, [replace(plan, bound=bound, order=order) for plan in plans])
        for order in orders
        for bound in CHANNEL_BOUNDS
    ]
    rates = np.array([trial.rates for trial in trials])
    errors = np.array([trial.errors for trial in trials])
    if target_psnr is None:
        chosen: NDArray[np.intp] = rates.argmin(axis=0)
    else:
        budget = 10 ** (-target_psnr / 10) * channels.size
        chosen = _spend(rates, errors, budget, _lagrangian(rates, errors, budget))
    return tuple(trials[best].plans[c] for c, best in enumerate(chosen))


def _rate(record: Record) -> float:
    counts = np.bincount(np.frombuffer(record.opcodes, np.uint8), minlength=1)
    counts = counts[counts > 0]
    entropy = -(counts * np.log2(counts / counts.sum())).sum()
    return float(entropy) + _TABLE_BITS * len(record.table)


def _lagrangian(
    rates: NDArray[np.float64], errors: NDArray[np.float64], budget: float
) -> NDArray[np.intp]:
    """Find the smallest weight of errors that stays within the budget, by bisection."""
    columns = np.arange(rates.shape[1])
    # Where even the least errors are too much, they are the best there is.
    chosen: NDArray[np.intp] = errors.argmin(axis=0)
    low, high = 1e-15, 1e15
    for _ in range(100):
        weight = np.sqrt(low * high)
        found = (rates + weight * errors).argmin(axis=0)
        if errors[found, columns].sum() <= budget:
            high, chosen = weight, found
        else:
            low = weight
    return chosen


def _spend(
    rates: NDArray[np.float64],
    errors: NDArray[np.float64],
    budget: float,
    chosen: NDArray[np.intp],
) -> NDArray[np.intp]:
    """Spend the rest of the error budget, each time where it saves most bits per error."""
    columns = np.arange(rates.shape[1])
    chosen = chosen.copy()
    while True:
        now = errors[chosen, columns]
        more = errors - now
        saved = rates[chosen, columns] - rates
        fits = (saved > 0) & (now.sum() + more <= budget)
        if not fits.any():
            return chosen
        gain = np.where(fits, saved / np.maximum(more, 1e-300), -1.0)
        best, column = np.unravel_index(gain.argmax(), gain.shape)
        chosen[column] = best
