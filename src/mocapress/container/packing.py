"""General-purpose compression of bytes, for texts and for files that are not motion."""

import lzma
import zlib
from functools import cache
from importlib import resources

from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer

_STORED, _LZMA, _DEFLATE = range(3)
_LEAST_LZMA, _FITTING = 2**12, 8


def pack(data: bytes, *, hard: bool = False) -> bytes:
    """Compress bytes by whichever method makes them smallest; ``hard`` tries all on more."""
    candidates = [(_STORED, data)]
    if len(data) < 2**16:
        deflate = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zdict=_dictionary())
        candidates.append((_DEFLATE, deflate.compress(data) + deflate.flush()))
    # Where the dictionary fits, or for little data, LZMA never wins. Literal context 4 and no
    # position bits suit text, the default suits binary data.
    if hard or (len(data) >= _LEAST_LZMA and len(candidates[-1][1]) * _FITTING > len(data)):
        for text in (True, False) if len(data) < (2**23 if hard else 2**16) else (True,):
            chain = _lzma_filter(len(data), text=text)
            candidates.append((_LZMA, lzma.compress(data, lzma.FORMAT_RAW, filters=[chain])))
    method, packed = min(candidates, key=lambda candidate: len(candidate[1]))
    return _record(method, len(data), packed)


def stored(data: bytes) -> bytes:
    """Give what ``unpack`` takes without compressing anything."""
    return _record(_STORED, len(data), data)


def _record(method: int, size: int, packed: bytes) -> bytes:
    writer = Writer()
    writer.integer(method)
    writer.integer(size)
    return bytes(writer.data) + packed


def unpack(data: bytes | memoryview, section: str, most_bytes: int = 2**62) -> bytes:
    """Undo ``pack``.

    Raises
    ------
    CorruptError
        When the data is not what ``pack`` makes, or would give more than ``most_bytes``.

    """
    reader = Reader(data, section)
    method = reader.integer(_DEFLATE)
    size = reader.integer(most_bytes)
    packed = reader.raw(len(data) - reader.position)
    try:
        if method == _STORED:
            unpacked, complete = packed, True
        elif method == _LZMA:
            decoder = lzma.LZMADecompressor(
                lzma.FORMAT_RAW, filters=[_lzma_filter(size, text=True)]
            )
            unpacked = decoder.decompress(packed, max_length=size + 1)
            if not decoder.eof and len(unpacked) == size:
                unpacked += decoder.decompress(b"", max_length=1)
            complete = decoder.eof and not decoder.unused_data
        else:
            inflate = zlib.decompressobj(-15, zdict=_dictionary())
            unpacked = inflate.decompress(packed, size + 1)
            complete = inflate.eof and not inflate.unused_data
    except (lzma.LZMAError, zlib.error, EOFError) as error:
        raise CorruptError(f"{section}: cannot be unpacked ({error})") from error
    if len(unpacked) != size or not complete:
        raise CorruptError(
            f"{section}: unpacks to another size", expected=str(size), found=str(len(unpacked))
        )
    return unpacked


def _lzma_filter(size: int, *, text: bool) -> dict[str, int]:
    dictionary = min(max(1 << (size - 1).bit_length() if size else 0, 2**12), 2**26)
    chain = {"id": lzma.FILTER_LZMA2, "preset": 9 | lzma.PRESET_EXTREME, "dict_size": dictionary}
    return chain | {"lc": 4, "lp": 0, "pb": 0} if text else chain


@cache
def _dictionary() -> bytes:
    return resources.files(__package__).joinpath("dictionary1.bin").read_bytes()
