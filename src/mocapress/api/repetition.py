"""Whether a file repeats itself so much that a general-purpose compressor may make it smaller.

Codecs predict motion from what was just before; loops, held poses and rows that come again after
a long time are what others find, and digits that come again in the text of a number, such as those
of a decimal times a factor. To try them costs far more time than to look for such rows, and to
pack a small part quickly.
"""

import zlib

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs import DEFAULT_CODEC, Codec
from mocapress.source import Source

_TOGETHER = 6
"""Neighbouring numbers of a row that are looked for together."""
_MIXED = np.uint64(0x9E3779B97F4A7C15)
_POOR = 0.4
"""Above this share of the original, others are worth trying whatever the codec."""
_WINDOWS, _WINDOW = 4, 2**14
"""How many parts of a file are packed, and their bytes."""
_PACKED_BETTER = 0.5
"""xz packs motion files to 0.48 to 0.9 of what a quick way makes of such parts."""
_TELLING = 0.5
_OTHERS_RATIO = 3.5
"""To what part, about, a general-purpose compressor packs numbers that do not come again."""


class Repetition:
    """Counts what comes again, in rows that are shown some at a time."""

    def __init__(self) -> None:
        self._seen: list[NDArray[np.uint64]] = []

    def add(self, rows: NDArray[np.float64]) -> None:
        """Take rows, (n, C), that follow those before."""
        columns = rows.shape[1]
        if not rows.size:
            return
        bits = np.ascontiguousarray(rows).view(np.uint64)
        mixed = (bits ^ (bits >> np.uint64(29))) * (_MIXED * _odd(columns))
        mixed ^= mixed >> np.uint64(32)
        self._seen.append(np.add.reduceat(mixed, np.arange(0, columns, _TOGETHER), axis=1))

    def share(self) -> float:
        """Give which part of all numbers has been there before; of groups that never move, all."""
        if not self._seen:
            return 0.0
        groups = np.concatenate(self._seen)
        moving = groups[:, (groups != groups[:1]).any(axis=0)]
        if not moving.size:
            return 1.0
        moving.sort(axis=0)
        return float(np.count_nonzero(moving[1:] == moving[:-1])) / moving.size


def _odd(count: int) -> NDArray[np.uint64]:
    return 2 * np.arange(count, dtype=np.uint64) + np.uint64(1)


def may_be_smaller(repetition: Repetition, coded: int, source: Source, codec: Codec) -> bool:
    """Tell whether others may make less of a file of which a codec made ``coded`` bytes.

    Only the default codec promises to be no larger than xz. Where another is asked for, what it
    gives besides, such as columns and chunks, counts for more than a few bytes.
    """
    size = source.size
    if coded > _POOR * size:
        return True
    if codec.id == DEFAULT_CODEC and coded > _PACKED_BETTER * _packed_share(source) * size:
        return True
    share = repetition.share()
    return share > _TELLING and (1 - share) * size < _OTHERS_RATIO * coded


def _packed_share(source: Source) -> float:
    starts = [i * source.size // _WINDOWS for i in range(_WINDOWS)]
    sample = b"".join(source.read(start, start + _WINDOW) for start in starts)
    return len(zlib.compress(sample, 1)) / max(len(sample), 1)
