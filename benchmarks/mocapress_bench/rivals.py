"""Compressors of numbers, which see only the matrix and not the text around it.

pcodec, OpenZL and Parquet work on columns, fpzip and zfp (in its reversible mode) on the matrix of
float64.
"""

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
_MOST_DIGITS = 15
"""Decimal numbers with up to this many digits have different doubles."""
_EXACT_POWER = 22
"""10 to this power is the largest that is exact in a double."""


@dataclass(frozen=True, slots=True)
class Rival:
    """A compressor of matrices, (F, C) float64, restored bit for bit."""

    compress: Callable[[Values], bytes]
    decompress: Callable[[bytes, tuple[int, int]], Values]
    """From bytes and shape."""


def fpzip() -> Rival:
    """Give fpzip without loss; channels as rows, which compress slightly better."""
    module: Any = import_module("fpzip")

    def decompress(data: bytes, shape: tuple[int, int]) -> Values:
        restored: Values = module.decompress(data, order="C").reshape(shape[::-1])
        return np.ascontiguousarray(restored.T)

    return Rival(lambda v: module.compress(np.array(v.T, order="C"), precision=0), decompress)


def zfp() -> Rival:
    """Give zfp in its reversible mode."""
    module: Any = import_module("zfpy")

    def compress(values: Values) -> bytes:
        packed: bytes = module.compress_numpy(values)
        return packed

    def decompress(data: bytes, shape: tuple[int, int]) -> Values:
        restored: Values = module.decompress_numpy(data)
        return restored.reshape(shape)

    return Rival(compress, decompress)


def pcodec(*, grid: bool) -> Rival:
    """Give pcodec at its strongest, column by column.

    Parameters
    ----------
    grid
        Whether to try, besides the float64 values, their indices on the decimal grids that a
        column lies on (``_grids``), each with the delta encoding that pcodec finds and with its
        differences of orders 1 to 3. The smallest is kept.

    """
    module: Any = import_module("pcodec")
    standalone: Any = import_module("pcodec.standalone")
    delta = module.DeltaSpec
    deltas = [delta.auto(), *map(delta.try_consecutive, (1, 2, 3))] if grid else [delta.auto()]

    def pack(numbers: NDArray[Any]) -> bytes:
        packed: list[bytes] = [
            standalone.simple_compress(
                numbers, module.ChunkConfig(compression_level=12, delta_spec=spec)
            )
            for spec in deltas
        ]
        return min(packed, key=len)

    return _by_column(pack, standalone.simple_decompress, grid=grid)


def openzl(*, grid: bool) -> Rival:
    """Give OpenZL's graph for numbers at its strongest level, column by column.

    Parameters
    ----------
    grid
        Whether to try the indices on decimal grids, too, as for ``pcodec``; and of all numbers
        the differences of orders 1 to 3 (of floats, those of their bits).

    """
    module: Any = import_module("openzl.ext")
    compressor = module.Compressor()
    compressor.set_parameter(module.CParam.FormatVersion, module.MAX_FORMAT_VERSION)
    compressor.set_parameter(module.CParam.CompressionLevel, 9)
    compressor.select_starting_graph(module.graphs.Compress()(compressor))
    context = module.CCtx()

    def packed(bits: NDArray[Any], order: int, kind: str) -> bytes:
        for _ in range(order):
            bits = np.diff(bits, prepend=bits.dtype.type(0))
        context.ref_compressor(compressor)  # it is let go after each call
        data: bytes = context.compress([module.Input(module.Type.Numeric, bits)])
        return bytes([order, ord(kind)]) + data

    def pack(numbers: NDArray[Any]) -> bytes:
        orders = range(4 if grid else 1)
        bits = numbers.view(np.int64) if numbers.dtype == np.float64 else numbers
        return min((packed(bits, order, numbers.dtype.char) for order in orders), key=len)

    def unpack(data: bytes) -> NDArray[Any]:
        (output,) = module.DCtx().decompress(data[2:])
        bits = output.content.as_nparray().view(f"i{output.elt_width}")
        for _ in range(data[0]):
            bits = np.cumsum(bits, dtype=bits.dtype)
        return np.asarray(bits.view(chr(data[1])))

    return _by_column(pack, unpack, grid=grid)


def parquet() -> Rival:
    """Give Parquet as tables of floats are best stored in it: bytes split, zstd -22."""
    arrow: Any = import_module("pyarrow")
    module: Any = import_module("pyarrow.parquet")

    def compress(values: Values) -> bytes:
        names = [str(c) for c in range(values.shape[1])]
        table = arrow.table([arrow.array(column) for column in values.T.copy()], names=names)
        stream = arrow.BufferOutputStream()
        module.write_table(
            table,
            stream,
            compression="zstd",
            compression_level=22,
            use_dictionary=False,
            column_encoding=dict.fromkeys(names, "BYTE_STREAM_SPLIT"),
        )
        packed: bytes = stream.getvalue().to_pybytes()
        return packed

    def decompress(data: bytes, shape: tuple[int, int]) -> Values:
        table = module.read_table(arrow.BufferReader(data))
        return np.stack([column.to_numpy() for column in table.columns], axis=1).reshape(shape)

    return Rival(compress, decompress)


def _by_column(
    pack: Callable[[NDArray[Any]], bytes],
    unpack: Callable[[bytes], NDArray[Any]],
    *,
    grid: bool,
) -> Rival:
    """Give a compressor of one column's numbers for a matrix; with ``grid``, also of indices."""

    def compress(values: Values) -> bytes:
        parts = []
        for column in np.ascontiguousarray(values.T):
            grids = [_Grid(_FLOATS, 0, 0, column), *(_grids(column) if grid else ())]
            packed = (_HEADER.pack(g.kind, g.digits, g.least) + pack(g.numbers) for g in grids)
            part = min(packed, key=len)
            parts.append(struct.pack("<I", len(part)) + part)
        return b"".join(parts)

    def decompress(data: bytes, shape: tuple[int, int]) -> Values:
        restored, place = np.empty(shape), 0
        for c in range(shape[1]):
            (size,) = struct.unpack_from("<I", data, place)
            part = data[place + 4 : place + 4 + size]
            numbers = unpack(part[_HEADER.size :])
            restored[:, c] = _from_grid(numbers, *_HEADER.unpack_from(part))
            place += 4 + size
        return restored

    return Rival(compress, decompress)


_HEADER = struct.Struct("<BBh")
"""Of a column: kind, digits and least exponent of its grid."""
_FLOATS, _DECIMALS, _SIGNIFICANT = range(3)


class _Grid(NamedTuple):
    kind: int
    digits: int
    least: int
    """Smallest exponent of ten, of ``_SIGNIFICANT``."""
    numbers: NDArray[Any]


def _grids(values: Values) -> Iterator[_Grid]:
    """Find the coarsest decimal grids that hold a column's values, (F,), all of them exactly.

    ``_DECIMALS``: multiples of a power of ten. ``_SIGNIFICANT``: ranks among all numbers with that
    many significant digits, as ``%g`` prints them.
    """
    largest = float(np.abs(values).max(initial=0))
    for kind, from_values in ((_DECIMALS, _multiples), (_SIGNIFICANT, _ranks)):
        for digits in range(_MOST_DIGITS + 1):
            if not largest * 10.0 ** (digits if kind == _DECIMALS else 0) < 2**53:
                break
            numbers, least = from_values(values, digits)
            if _from_grid(numbers, kind, digits, least).tobytes() == values.tobytes():
                small = np.abs(numbers).max(initial=0) < 2**31
                yield _Grid(kind, digits, least, numbers.astype(np.int32) if small else numbers)
                break


def _multiples(values: Values, decimals: int) -> tuple[NDArray[np.int64], int]:
    return np.rint(values * 10.0**decimals).astype(np.int64), 0


def _ranks(values: Values, digits: int) -> tuple[NDArray[np.int64], int]:
    if digits == 0:
        return np.zeros(len(values), np.int64), 0
    magnitude = np.abs(values)
    exponent = np.floor(np.log10(np.where(magnitude > 0, magnitude, 1))).astype(np.int64)
    # Powers out of the exact ones make numbers that do not come back, and another grid is taken.
    shift = np.clip(digits - 1 - exponent, -_EXACT_POWER, _EXACT_POWER)
    scaled = np.where(
        shift >= 0, magnitude * 10.0 ** np.abs(shift), magnitude / 10.0 ** np.abs(shift)
    )
    mantissa = np.rint(scaled).astype(np.int64)
    carried = mantissa >= 10**digits
    exponent, mantissa = exponent + carried, np.where(carried, 10 ** (digits - 1), mantissa)
    least = int(exponent[magnitude > 0].min(initial=0))
    per_exponent = 9 * 10 ** (digits - 1)
    rank = (exponent - least) * per_exponent + mantissa - 10 ** (digits - 1) + 1
    return np.where(magnitude > 0, np.sign(values).astype(np.int64) * rank, 0), least


def _from_grid(numbers: NDArray[Any], kind: int, digits: int, least: int) -> Values:
    """Give the values again, (F,) float64: one correct rounding each."""
    if kind == _FLOATS or digits == 0:
        return np.asarray(numbers, dtype=np.float64)
    if kind == _DECIMALS:
        return np.asarray(numbers / 10.0**digits)
    rank = np.abs(numbers.astype(np.int64)) - 1
    per_exponent = 9 * 10 ** (digits - 1)
    mantissa = rank % per_exponent + 10 ** (digits - 1)
    shift = np.clip(digits - 1 - least - rank // per_exponent, -_EXACT_POWER, _EXACT_POWER)
    power = 10.0 ** np.abs(shift)
    magnitude = np.where(shift >= 0, mantissa / power, mantissa * power)
    return np.asarray(np.where(rank < 0, 0.0, np.sign(numbers) * magnitude))
