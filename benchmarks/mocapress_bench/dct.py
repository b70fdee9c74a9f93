"""MPEG-4 FBA's DCT scheme without quantisation, made reversible.

Every 16 frames of a column become 16 coefficients, kept as float32. The first (DC) is predicted by
that of the block before and coded by Algorithm 1; the others (AC) are coded directly: exponents
adaptively, as differences from the same coefficient of the block before, sign and mantissa raw.
(Algorithm 1 with prediction 0 would leave the exponent raw as well, 33 bits a coefficient.)

The inverse transform of rounded coefficients only approximates the values. Encoder and decoder
compute it identically, with additions in a fixed order, and round it to the column's decimal grid.
Corrections, counted in floats, follow as a stream of their own, so the scheme is lossless.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import cache
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.app import App
from mocapress.codecs.app.coding import make_plan
from mocapress.codecs.contract import (
    NO_OTHERS,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.errors import CorruptError
from mocapress.motion import Column, Skeleton, Stream

_BLOCK = 16
_DC = np.zeros(1)
"""Lookup table of one alpha, 0: prediction from the row before."""
_SIZES = np.dtype("<u4")


@dataclass(frozen=True, slots=True)
class Dct(Codec):
    """The 16-frame DCT scheme, lossless; one chunk for the whole clip."""

    id: ClassVar[str] = "mpeg4-dct"
    can: ClassVar[Capabilities] = Capabilities(lossless=True)

    mantissa_limit: int = App().mantissa_limit

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,  # noqa: ARG002
        model: Model | None = None,  # noqa: ARG002
        others: Others = NO_OTHERS,  # noqa: ARG002
    ) -> Encoded:
        """Code a stream, (F, C) float64."""
        values = np.ascontiguousarray(stream.values, dtype=np.float64)
        plan = make_plan(stream.columns, [-1] * stream.channels, [0] * stream.channels)
        precisions = _core.app_precisions(values, plan)
        plan[:, 1] = precisions
        coefficients = _forward(values)
        parts = self._pack_coefficients(coefficients)
        nearly = _inverse(coefficients, stream.frames, plan)
        missing = _ordinals(values, plan) - _ordinals(nearly, plan)
        parts.append(_core.encode_differences(missing.T.ravel()))
        sizes = np.array([len(part) for part in parts], dtype=_SIZES)
        chunk = Chunk(0, stream.frames, b"".join((sizes.tobytes(), *parts)))
        return Encoded(bytes(precisions), (chunk,) if stream.frames else ())

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,  # noqa: ARG002
        others: Others = NO_OTHERS,  # noqa: ARG002
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        """Decode the chunk to (F, C) float64."""
        plan = make_plan(columns, [-1] * len(columns), list(header))
        if not chunks:
            return np.empty((0, len(columns)))
        (chunk,) = chunks
        try:
            return self._decode(chunk, plan)[:stop]
        except ValueError as error:
            raise CorruptError(f"DCT chunk: {error}") from error

    def _decode(self, chunk: Chunk, plan: NDArray[np.int32]) -> NDArray[np.float64]:
        sizes = np.frombuffer(chunk.payload, dtype=_SIZES, count=4)
        ends = np.cumsum([sizes.nbytes, *sizes])
        dc, exponents, rest, missing = (chunk.payload[start:end] for start, end in pairwise(ends))
        coefficients = self._unpack_coefficients(dc, exponents, rest, chunk.frames, len(plan))
        ordinals = _ordinals(_inverse(coefficients, chunk.frames, plan), plan)
        differences = np.empty(ordinals.size, dtype=np.int64)
        _core.decode_differences(missing, differences)
        return _from_ordinals(ordinals + differences.reshape(ordinals.T.shape).T, plan)

    def _pack_coefficients(self, coefficients: NDArray[np.float32]) -> list[bytes]:
        dc = np.ascontiguousarray(coefficients[0], dtype=np.float64)
        ac = np.ascontiguousarray(coefficients[1:]).view(np.uint32)
        exponents = (ac >> 23 & 0xFF).astype(np.int64)
        steps = np.diff(exponents, axis=1, prepend=np.zeros_like(exponents[:, :1]))
        sign_mantissa = (ac >> 31 << 23 | ac & 0x7FFFFF).astype("<u4")
        return [
            _core.app_encode(dc, _float_plan(dc.shape[1]), _DC, 1, self.mantissa_limit),
            _core.encode_differences(steps.transpose(2, 0, 1).ravel()),
            sign_mantissa.view(np.uint8).reshape(-1, 4)[:, :3].tobytes(),
        ]

    def _unpack_coefficients(
        self, dc: bytes, exponents: bytes, rest: bytes, frames: int, channels: int
    ) -> NDArray[np.float32]:
        blocks = -(-frames // _BLOCK)
        first = np.empty((blocks, channels))
        _core.app_decode(dc, first, _float_plan(channels), _DC, 1, self.mantissa_limit)
        shape = (_BLOCK - 1, blocks, channels)
        steps = np.empty((channels, _BLOCK - 1, blocks), dtype=np.int64)
        _core.decode_differences(exponents, steps.reshape(-1))
        exponent = np.cumsum(steps, axis=2).transpose(1, 2, 0).astype(np.uint32)
        sign_mantissa = np.zeros((steps.size, 4), dtype=np.uint8)
        sign_mantissa[:, :3] = np.frombuffer(rest, dtype=np.uint8).reshape(-1, 3)
        bits = sign_mantissa.view("<u4").reshape(shape)
        ac = (bits >> 23 << 31 | exponent << 23 | bits & 0x7FFFFF).astype(np.uint32)
        return np.concatenate((first[np.newaxis].astype(np.float32), ac.view(np.float32)))


def _float_plan(columns: int) -> NDArray[np.int32]:
    return np.tile(np.array([-1, 1, 0, 0], dtype=np.int32), (columns, 1))


@cache
def _basis() -> NDArray[np.float64]:
    """Give the orthonormal DCT-II, (16 coefficients, 16 frames), correctly rounded.

    The cosines come from half angles and the recurrence of Chebyshev, in decimal arithmetic: a
    mathematical library may round them differently on another machine.
    """
    with localcontext(prec=60):
        step = Decimal(0)  # cos(pi / 2), halved to cos(pi / 32)
        for _ in range(4):
            step = ((1 + step) / 2).sqrt()
        cosines = [Decimal(1), step]
        while len(cosines) < 4 * _BLOCK:
            cosines.append(2 * step * cosines[-1] - cosines[-2])
        scales = [(Decimal(1 if k == 0 else 2) / _BLOCK).sqrt() for k in range(_BLOCK)]
        return np.array(
            [
                [float(scales[k] * cosines[(2 * n + 1) * k % 64]) for n in range(_BLOCK)]
                for k in range(_BLOCK)
            ]
        )


def _forward(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """Give coefficients (16, blocks, C); the last block is padded with its last frame."""
    padding = (0, -len(values) % _BLOCK)
    filled = np.pad(values, (padding, (0, 0)), mode="edge" if len(values) else "constant")
    frames = filled.reshape(len(filled) // _BLOCK, _BLOCK, values.shape[1]).transpose(1, 0, 2)
    with np.errstate(all="ignore"):
        coefficients = _sum_in_order(_basis(), frames).astype(np.float32)
    coefficients[~np.isfinite(coefficients)] = 0
    return coefficients


def _inverse(
    coefficients: NDArray[np.float32], frames: int, plan: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Give the values that the coefficients approximate, (F, C), on the columns' grids."""
    with np.errstate(all="ignore"):
        blocks = _sum_in_order(_basis().T, coefficients.astype(np.float64))
    channels = coefficients.shape[2]
    values = np.ascontiguousarray(
        blocks.transpose(1, 0, 2).reshape(blocks.shape[1] * _BLOCK, channels)[:frames]
    )
    values[~np.isfinite(values)] = 0
    _core.snap(values, plan)
    return values


def _sum_in_order(matrix: NDArray[np.float64], terms: NDArray[np.float64]) -> NDArray[np.float64]:
    """Multiply (K, N) by (N, ...), adding from the first term to the last on every machine."""
    total = np.zeros((len(matrix), *terms.shape[1:]))
    for column, term in zip(matrix.T, terms, strict=True):
        total += np.multiply.outer(column, term)
    return total


def _ordinals(values: NDArray[np.float64], plan: NDArray[np.int32]) -> NDArray[np.int64]:
    """Give the ranks of the floats among all floats, each column in its precision; modulo 2^64."""
    with np.errstate(over="ignore"):
        single = values.astype(np.float32).view(np.int32)
    single = single ^ (single >> 31 & 0x7FFFFFFF)
    double = values.view(np.int64)
    double = double ^ (double >> 63 & 0x7FFFFFFFFFFFFFFF)
    return np.where(plan[:, 1] == 0, double, single)


def _from_ordinals(ordinals: NDArray[np.int64], plan: NDArray[np.int32]) -> NDArray[np.float64]:
    single = ordinals.astype(np.int32)
    single = single ^ (single >> 31 & 0x7FFFFFFF)
    double = ordinals ^ (ordinals >> 63 & 0x7FFFFFFFFFFFFFFF)
    with np.errstate(invalid="ignore"):  # meaningless for float64 columns
        snapped = single.view(np.float32).astype(np.float64)
    _core.snap(snapped, np.where(plan[:, 1:2] == 2, plan, 0).astype(np.int32))
    return np.where(plan[:, 1] == 0, double.view(np.float64), snapped)
