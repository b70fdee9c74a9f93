"""Channels to opcodes and look-up tables, and back, in parallel."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.threads import processors

T = TypeVar("T")

MOST_BITS = 12
MOST_ORDER = 7
MOST_WINDOW = 1 << 20
# Fewer samples than this are coded before a thread has started.
_WORTH_THREADS = 1 << 17


@dataclass(frozen=True, slots=True)
class Plan:
    """Parameters that may differ from channel to channel."""

    bound: float
    """Beta: a step is at most this many times the mean of the last ones."""
    order: int = 0
    """Of the predictor; 0 is the published algorithm."""
    max_error: float = np.inf
    """Largest error of a sample; for the encoder only."""


@dataclass(frozen=True, slots=True)
class Record:
    """A coded channel."""

    opcodes: bytes
    """ASCII, b of the paper."""
    table: NDArray[np.float64]
    """(T,) float64, t of the paper."""
    squared_error: float = 0.0
    """Sum over all samples; the encoder knows it, a document does not."""


@dataclass(frozen=True, slots=True)
class Coding:
    """Parameters that all channels share: n and w; the others are for the encoder only."""

    bits: int = 6
    window: int = 64
    tolerance: float = 10.0
    round_offset: float = 0.5
    spare_signs: bool = False
    """Past the paper: no NEG where no sign is used, EQL for APX(0). Any decoder reads that."""

    def encode(self, channels: NDArray[np.float64], plans: Sequence[Plan]) -> list[Record]:
        """Code channels, (C, F) float64, by Algorithm 1."""

        def one(c: int) -> Record:
            plan = plans[c]
            return Record(
                *_core.diffma_encode(
                    channels[c],
                    self.bits,
                    self.window,
                    plan.bound,
                    plan.order,
                    self.tolerance,
                    self.round_offset,
                    plan.max_error,
                    self.spare_signs,
                )
            )

        return _each_channel(one, *channels.shape)

    def decode(
        self, records: Sequence[Record], plans: Sequence[Plan], frames: int
    ) -> NDArray[np.float64]:
        """Decode records of ``frames`` frames by Algorithm 2: (C, F) float64.

        Raises
        ------
        ValueError
            When a record's opcodes and table do not make that many frames.

        """
        channels = np.empty((len(records), frames))

        def one(c: int) -> None:
            record, plan = records[c], plans[c]
            _core.diffma_decode(
                record.opcodes,
                record.table,
                channels[c],
                self.bits,
                self.window,
                plan.bound,
                plan.order,
            )

        _each_channel(one, len(records), frames)
        return channels


def _each_channel(work: Callable[[int], T], channels: int, frames: int) -> list[T]:
    workers = min(processors(), channels)
    if workers < 2 or channels * frames < _WORTH_THREADS:
        return [work(c) for c in range(channels)]

    def some(start: int) -> list[T]:
        return [work(c) for c in range(start, channels, workers)]

    results: list[T | None] = [None] * channels
    with ThreadPoolExecutor(workers) as pool:
        for start, found in enumerate(pool.map(some, range(workers))):
            results[start::workers] = found
    return results  # type: ignore[return-value]  # every place is filled
