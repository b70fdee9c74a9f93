"""General-purpose compression of bytes, for texts and for files that are not motion."""

import lzma
import zlib
from collections.abc import Iterator
from functools import cache
from importlib import resources

from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer

_STORED, _LZMA, _DEFLATE = range(3)
_LEAST_LZMA, _FITTING = 2**12, 8
_PART = 2**20


def pack(data: bytes, *, hard: bool = False, beside: bytes = b"") -> bytes:
    """Compress bytes by whichever method makes them smallest.

    Parameters
    ----------
    data
        The bytes.
    hard
        Whether all methods are tried on more.
    beside
        Bytes that they are probably like, which ``unpack`` is given, too.

    """
    candidates = [(_STORED, data)]
    if len(data) < 2**16:
        deflate = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zdict=_dictionary() + beside)
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


def unpack(
    data: bytes | memoryview, section: str, most_bytes: int = 2**62, *, beside: bytes = b""
) -> bytes:
    """Undo ``pack``.

    Raises
    ------
    CorruptError
        When the data is not what ``pack`` makes, or would give more than ``most_bytes``.

    """
    return b"".join(unpacked_parts(data, section, most_bytes, beside=beside))


def unpacked_parts(
    data: bytes | memoryview, section: str, most_bytes: int = 2**62, *, beside: bytes = b""
) -> Iterator[bytes]:
    """Undo ``pack``, part after part; see ``unpack``. What is wrong may show at the end only."""
    reader = Reader(data, section)
    method = reader.integer(_DEFLATE)
    size = reader.integer(most_bytes)
    packed = reader.raw(len(data) - reader.position)
    if method == _STORED:
        parts: Iterator[bytes | None] = iter((packed,))
    else:
        parts = _inflated(packed, beside) if method == _DEFLATE else _unlzma(packed, size)
    found, complete = 0, True
    try:
        for part in parts:
            if part is None:
                complete = False
                continue
            found += len(part)
            if found > size:
                break
            yield part
    except (lzma.LZMAError, zlib.error, EOFError) as error:
        raise CorruptError(f"{section}: cannot be unpacked ({error})") from error
    if found != size or not complete:
        raise CorruptError(
            f"{section}: unpacks to another size", expected=str(size), found=str(found)
        )


def _unlzma(packed: bytes, size: int) -> Iterator[bytes | None]:
    """Give what comes out, and None at the end where the data does not end with it."""
    decoder = lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=[_lzma_filter(size, text=True)])
    while not decoder.eof:
        part = decoder.decompress(packed, max_length=_PART)
        packed = b""
        if not part and decoder.needs_input:
            break
        yield part
    if not decoder.eof or decoder.unused_data:
        yield None


def _inflated(packed: bytes, beside: bytes) -> Iterator[bytes | None]:
    inflate = zlib.decompressobj(-15, zdict=_dictionary() + beside)
    while not inflate.eof:
        part = inflate.decompress(packed, _PART)
        packed = inflate.unconsumed_tail
        if not part and not packed:
            break
        yield part
    if not inflate.eof or inflate.unused_data:
        yield None


def _lzma_filter(size: int, *, text: bool) -> dict[str, int]:
    dictionary = min(max(1 << (size - 1).bit_length() if size else 0, 2**12), 2**26)
    chain = {"id": lzma.FILTER_LZMA2, "preset": 9 | lzma.PRESET_EXTREME, "dict_size": dictionary}
    return chain | {"lc": 4, "lp": 0, "pb": 0} if text else chain


@cache
def _dictionary() -> bytes:
    return resources.files(__package__).joinpath("dictionary1.bin").read_bytes()
