"""Who is compared: codecs on the numbers of a clip, and general-purpose tools on its file."""

import bz2
import gzip
import lzma
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
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
    found["non-alpha PP, limit 53"] = Parallelogram(mantissa_limit=53)
    found["MPEG-4 LP, limit 53"] = PreviousFrame(mantissa_limit=53)
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
    """PPMd as the command 7z has it at its strongest; only where that is installed."""
    command = shutil.which("7z") or shutil.which("7za")
    if command is None:
        raise ImportError

    def compress(data: bytes) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "clip").write_bytes(data)
            _run([command, "a", "-m0=PPMd", "-mx=9", "clip.7z", "clip"], folder)
            return (Path(folder) / "clip.7z").read_bytes()

    def decompress(data: bytes) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "clip.7z").write_bytes(data)
            return _run([command, "e", "-so", "clip.7z"], folder)

    return Tool(compress, decompress)


def _run(command: list[str], folder: str) -> bytes:
    return subprocess.run(command, cwd=folder, capture_output=True, check=True).stdout  # noqa: S603
