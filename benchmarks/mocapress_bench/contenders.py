"""The contenders: codecs code a clip, compressors of numbers its matrix, tools its file."""

import bz2
import gzip
import lzma
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from mocapress import codecs
from mocapress.codecs import Codec
from mocapress.errors import ParameterError
from mocapress_bench import rivals
from mocapress_bench.baselines import Parallelogram, PreviousFrame
from mocapress_bench.dct import Dct
from mocapress_bench.rivals import Rival

T = TypeVar("T")
_LEVELS = (1, 5, 9)
_COMMA = re.compile(r",(?!\s*(?:\w+=|limit ))")
"""Between names, not inside of ``app:t=10,table=k2-uniform`` and ``MPEG-4 LP, limit 53``."""
Transform = Callable[[bytes], bytes]


@dataclass(frozen=True, slots=True)
class Tool:
    """A general-purpose compressor at its strongest."""

    compress: Transform
    decompress: Transform


Contender = Codec | Rival | Tool


def contenders(only: str = "") -> tuple[dict[str, Contender], list[str]]:
    """Give the contenders asked for, and the names of those that are not installed.

    Parameters
    ----------
    only
        Names, or codecs as text (``app:t=10``), separated by commas; all if empty.

    Raises
    ------
    ParameterError
        When a name is unknown.

    """
    numeric, no_rivals = _installed(_RIVALS)
    tools, no_tools = _installed(_TOOLS)
    found: dict[str, Contender] = {**_codec_contenders(), **numeric, **tools}
    missing = [*no_rivals, *no_tools]
    if not only:
        return found, missing
    chosen: dict[str, Contender] = {}
    names = [name.strip() for name in _COMMA.split(only)]
    for name in names:
        if name in found:
            chosen[name] = found[name]
        elif name.partition(":")[0] in codecs.codec_ids():
            chosen[name] = codecs.codec(name)
        elif name not in missing:
            expected = f"codecs, or some of {'; '.join([*found, *missing])}"
            raise ParameterError("--only", expected=expected, found=repr(name))
    return chosen, [name for name in missing if name in names]


def _codec_contenders() -> dict[str, Codec]:
    """Give all lossless codecs, at each level that is compared, and the rivals of the APP paper."""
    found: dict[str, Codec] = {}
    for name in codecs.codec_ids():
        made = codecs.codec(name)
        if made.lossless and made.can.levels:
            found |= {f"{name}:level={n}": codecs.with_level(made, n) for n in _LEVELS}
        elif made.lossless:
            found[name] = made
    found["app:mantissa_limit=53"] = codecs.codec("app:mantissa_limit=53")
    found["non-alpha PP"] = Parallelogram()
    found["MPEG-4 LP"] = PreviousFrame()
    found["MPEG-4 DCT"] = Dct()
    found["non-alpha PP, limit 53"] = Parallelogram(mantissa_limit=53)
    found["MPEG-4 LP, limit 53"] = PreviousFrame(mantissa_limit=53)
    return found


def _installed(
    makers: dict[str, Callable[[], T]],
) -> tuple[dict[str, T], list[str]]:
    found: dict[str, T] = {}
    missing = []
    for name, make in makers.items():
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
    """Run PPMd in the command 7z at its strongest setting, where that is installed."""
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


def _zpaq() -> Tool:
    """Run the archiver zpaq at its strongest setting, where it is installed."""
    command = shutil.which("zpaq")
    if command is None:
        raise ImportError

    def compress(data: bytes) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "clip").write_bytes(data)
            _run([command, "add", "clip.zpaq", "clip", "-m5", "-t1"], folder)
            return (Path(folder) / "clip.zpaq").read_bytes()

    def decompress(data: bytes) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "clip.zpaq").write_bytes(data)
            _run([command, "extract", "clip.zpaq", "-to", "back", "-t1"], folder)
            return (Path(folder) / "back/clip").read_bytes()

    return Tool(compress, decompress)


def _run(command: list[str], folder: str) -> bytes:
    return subprocess.run(command, cwd=folder, capture_output=True, check=True).stdout  # noqa: S603


_TOOLS: dict[str, Callable[[], Tool]] = {
    "gzip -9": lambda: Tool(lambda data: gzip.compress(data, 9, mtime=0), gzip.decompress),
    "bzip2 -9": lambda: Tool(bz2.compress, bz2.decompress),
    "xz -9e": lambda: Tool(
        lambda data: lzma.compress(data, preset=9 | lzma.PRESET_EXTREME), lzma.decompress
    ),
    "zstd -22": _zstd,
    "brotli 11": _brotli,
    "7z PPMd": _ppmd,
    "zpaq -m5": _zpaq,
}
_RIVALS: dict[str, Callable[[], Rival]] = {
    "pcodec float64": partial(rivals.pcodec, grid=False),
    "pcodec grid": partial(rivals.pcodec, grid=True),
    "OpenZL float64": partial(rivals.openzl, grid=False),
    "OpenZL grid": partial(rivals.openzl, grid=True),
    "Parquet": rivals.parquet,
    "fpzip": rivals.fpzip,
    "zfp": rivals.zfp,
}
