"""Who is compared: codecs on the numbers of a clip, and general-purpose tools on its file."""

import bz2
import gzip
import lzma
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from mocapress import codecs
from mocapress.bench.baselines import Parallelogram, PreviousFrame
from mocapress.bench.dct import Dct
from mocapress.codecs import Codec

Transform = Callable[[bytes], bytes]


@dataclass(frozen=True, slots=True)
class Tool:
    """A general-purpose compressor at its strongest."""

    compress: Transform
    decompress: Transform


def codec_contenders() -> dict[str, Codec]:
    """Give all lossless codecs with their defaults, APP's other preset, and the paper's rivals."""
    found = {name: codecs.codec(name) for name in codecs.codec_ids()}
    found = {name: made for name, made in found.items() if made.lossless}
    found["app:mantissa_limit=53"] = codecs.codec("app:mantissa_limit=53")
    found["non-alpha PP"] = Parallelogram()
    found["MPEG-4 LP"] = PreviousFrame()
    found["MPEG-4 DCT"] = Dct()
    return found


def tool_contenders() -> tuple[dict[str, Tool], list[str]]:
    """Give the tools that are here, and the names of those that are not installed."""
    made: dict[str, Callable[[], Tool]] = {
        "gzip -9": lambda: Tool(lambda data: gzip.compress(data, 9, mtime=0), gzip.decompress),
        "bzip2 -9": lambda: Tool(bz2.compress, bz2.decompress),
        "xz -9e": lambda: Tool(
            lambda data: lzma.compress(data, preset=9 | lzma.PRESET_EXTREME), lzma.decompress
        ),
        "zstd -22": _zstd,
        "brotli 11": _brotli,
        "7z PPMd": _ppmd,
    }
    found: dict[str, Tool] = {}
    missing = []
    for name, make in made.items():
        try:
            found[name] = make()
        except ImportError:
            missing.append(name)
    return found, missing


def _zstd() -> Tool:
    zstandard: Any = import_module("zstandard")
    return Tool(
        zstandard.ZstdCompressor(level=22).compress,
        zstandard.ZstdDecompressor().decompress,
    )


def _brotli() -> Tool:
    brotli: Any = import_module("brotli")

    def compress(data: bytes) -> bytes:
        packed: bytes = brotli.compress(data, quality=11, lgwin=24)
        return packed

    return Tool(compress, brotli.decompress)


def _ppmd() -> Tool:
    """PPMd as 7-Zip's strongest setting has it: order 32, 192 MB; the size goes in front."""
    pyppmd: Any = import_module("pyppmd")

    def compress(data: bytes) -> bytes:
        encoder = pyppmd.Ppmd7Encoder(32, 192 << 20)
        packed: bytes = encoder.encode(data) + encoder.flush()
        return len(data).to_bytes(8, "little") + packed

    def decompress(data: bytes) -> bytes:
        size = int.from_bytes(data[:8], "little")
        restored: bytes = pyppmd.Ppmd7Decoder(32, 192 << 20).decode(data[8:], size)
        return restored

    return Tool(compress, decompress)
