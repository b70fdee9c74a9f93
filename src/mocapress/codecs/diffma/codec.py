"""The codec ``diffma``."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from math import inf, isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.chunks import check_frames
from mocapress.codecs.contract import (
    NO_OTHERS,
    Bound,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.codecs.diffma import allocation
from mocapress.codecs.diffma.coding import MOST_BITS, MOST_ORDER, MOST_WINDOW, Coding, Plan
from mocapress.codecs.diffma.payload import (
    pack_header,
    pack_payload,
    unpack_header,
    unpack_payload,
)
from mocapress.errors import CorruptError, ParameterError, VerificationError
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.frame_time import decimal_seconds

_MOST_FRAMES = 1 << 20


@dataclass(frozen=True, slots=True)
class DiffMA(Codec):
    """DiffMA, lossy: as published unless ``max_error``, ``order`` or ``per`` say otherwise."""

    id: ClassVar[str] = "diffma"
    can: ClassVar[Capabilities] = Capabilities(
        lossless=False, bounds=frozenset({Bound.MEAN, Bound.LARGEST}), document=True
    )

    bits: int = 6
    """n: a step is coded as one of 2^n sizes."""
    window: int = 64
    """w: over how many samples the mean is taken."""
    bound: float = 4.0
    """beta: the larger, the coarser."""
    tolerance: float = 10.0
    """tau: errors of quantized samples stay below."""
    round_offset: float = 0.5
    """1/2 in Eq. 2.2; 0 in Listing 2, which costs about 6 dB."""
    max_error: float = inf
    """Largest error of any sample."""
    max_errors: str = ""
    """Largest errors of some channels: ``root.t?:0.01/*.rx:0.5``; the first that fits a name."""
    target_psnr: float = 0.0
    """dB over all samples of a clip; chooses the bound. 0: no target."""
    per: str = "file"
    """``file``: one bound, of a target the nearest power of two. ``channel``: each its own."""
    order: str = "0"
    """Of the predictor, 0 to 7, or ``auto``: chosen for each channel. 0: as published."""
    levels: str = ""
    """Bounds of levels of detail in JSON: ``16/64``."""
    chunk: int = 2048
    """Frames that are decoded together in a ``.mcz``."""

    def __post_init__(self) -> None:
        for name, most in (("bits", MOST_BITS), ("window", MOST_WINDOW), ("chunk", _MOST_FRAMES)):
            self._check(name, range(1, most + 1).__contains__, f"1 to {most}")
        self._check("bound", lambda v: 0 < v < inf, "a number above 0")
        self._check("tolerance", lambda v: v > 0, "a number above 0")
        self._check("round_offset", lambda v: 0 <= v <= 1, "0 to 1")
        self._check("max_error", lambda v: v >= 0, "0 or more")
        self._check("target_psnr", isfinite, "a finite number")
        self._check("per", lambda v: v in ("file", "channel"), "file or channel")
        orders = {"auto", *map(str, range(MOST_ORDER + 1))}
        self._check("order", lambda v: v in orders, f"0 to {MOST_ORDER}, or auto")
        _ = self.level_bounds, self._named_errors
        if self.per == "channel" and not self.target_psnr and not self._limits_errors:
            raise ParameterError(
                "diffma:per=channel chooses bounds", expected="target_psnr or max_error, to meet"
            )

    @property
    def level_bounds(self) -> tuple[float, ...]:
        """Bounds of the levels of detail."""
        bounds = tuple(_float(text) for text in self.levels.split("/") if text)
        if not all(0 < bound < inf for bound in bounds):
            raise ParameterError("diffma:levels", expected="16/64", found=repr(self.levels))
        return bounds

    @property
    def coding(self) -> Coding:
        """What all channels share."""
        spare = self.per == "channel"
        return Coding(self.bits, self.window, self.tolerance, self.round_offset, spare)

    def plan(self, stream: Stream) -> tuple[Plan, ...]:
        """Choose bound and order of each channel of a stream, (F, C)."""
        order = 0 if self.order == "auto" else int(self.order)
        plans = tuple(
            Plan(self.bound, order, self._error_of(column.name)) for column in stream.columns
        )
        channels, coding = by_channel(stream.values), self.coding
        if not channels.size:
            return plans
        if self.per == "channel":
            orders = allocation.AUTO_ORDERS if self.order == "auto" else (order,)
            target = self.target_psnr or None
            return allocation.own_bounds(coding, channels, plans, target, orders)
        if self.target_psnr:
            plans = allocation.one_bound(coding, channels, plans, self.target_psnr)
        if self.order == "auto":
            plans = allocation.with_orders(coding, channels, plans)
        return plans

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64; NaN and infinities stay as they are."""
        if self.levels:
            raise ParameterError("diffma:levels are for JSON", expected="a .diffma.json as output")
        plans = self.plan(stream)
        chunks = []
        for first in range(0, stream.frames, self.chunk):
            rows = stream.values[first : first + self.chunk]
            records = self.coding.encode(by_channel(rows), plans)
            chunks.append(Chunk(first, len(rows), pack_payload(records)))
        return Encoded(pack_header(plans), tuple(chunks))

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,
        others: Others = NO_OTHERS,
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        """Decode any chunks, one after the other: (sum of their frames, C) float64.

        Raises
        ------
        CorruptError
            When header or payload are not what ``encode`` makes with these parameters.

        """
        plans = unpack_header(header, len(columns))
        values = []
        for chunk in chunks:
            check_frames("DiffMA chunk", chunk, self.chunk)
            records = unpack_payload(chunk.payload, len(columns), chunk.frames)
            try:
                values.append(self.coding.decode(records, plans, chunk.frames).T)
            except ValueError as error:
                raise CorruptError(f"DiffMA chunk from frame {chunk.first}: {error}") from error
        return np.ascontiguousarray(np.concatenate([np.empty((0, len(columns))), *values])[:stop])

    def largest_errors(self, columns: Sequence[Column]) -> list[float]:
        """Give the error up to which each column may come back; infinite where none was asked."""
        return [self._error_of(column.name) for column in columns]

    def document(self, clip: Clip, layout: bytes = b"") -> bytes:
        """Code a clip as DiffMA JSON, which was read and decoded again.

        Raises
        ------
        VerificationError
            When what was decoded is not what was encoded, or breaks a bound.

        """
        # The reader of documents is not needed to make or read a .mcz.
        from mocapress.codecs.diffma.document import Document, Level, read_document

        plans, channels = self.plan(clip.main), by_channel(clip.values)
        levels = []
        for bound in self.level_bounds:
            level = self.level(bound)
            records = level.coding.encode(channels, level.plan(clip.main))
            levels.append(Level(bound, tuple(records)))
        document = Document(
            tuple(column.name for column in clip.columns),
            self.coding,
            plans,
            tuple(self.coding.encode(channels, plans)),
            clip.frames,
            tuple(levels),
            clip.skeleton,
            tuple((column.joint, column.kind) for column in clip.columns),
            None if clip.frame_time is None else decimal_seconds(clip.frame_time),
            layout,
        )
        text = document.to_json()
        decoded = read_document(text).decode()
        limits = np.array([plan.max_error for plan in plans])
        same = (
            by_channel(decoded).tobytes()
            == self.coding.decode(document.records, plans, clip.frames).tobytes()
        )
        if not same or (np.abs(decoded - clip.values) > limits).any():
            raise VerificationError("DiffMA JSON does not give back what was encoded")
        return text

    def level(self, bound: float) -> "DiffMA":
        """Give the codec of a level of detail: one bound, and nothing to choose."""
        return replace(self, bound=bound, target_psnr=0.0, per="file", order="0", levels="")

    @property
    def _limits_errors(self) -> bool:
        return self.max_error < inf or bool(self.max_errors)

    @property
    def _named_errors(self) -> tuple[tuple[str, float], ...]:
        """Patterns of names, and the largest error of channels that fit."""
        named = []
        for item in filter(None, self.max_errors.split("/")):
            pattern, colon, error = item.rpartition(":")
            if not colon or not _float(error) >= 0:
                raise ParameterError(
                    "diffma:max_errors", expected="root.t?:0.01/*.rx:0.5", found=repr(item)
                )
            named.append((pattern, _float(error)))
        return tuple(named)

    def _error_of(self, name: str) -> float:
        for pattern, error in self._named_errors:
            if fnmatchcase(name, pattern):
                return error
        return self.max_error

    def _check(self, name: str, fits: Callable[[Any], bool], expected: str) -> None:
        value = getattr(self, name)
        if not fits(value):
            raise ParameterError(f"diffma:{name}", expected=expected, found=repr(value))


def by_channel(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn (F, C) values to (C, F), each channel in one piece."""
    return np.ascontiguousarray(values.T, dtype=np.float64)


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
