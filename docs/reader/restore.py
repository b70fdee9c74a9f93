"""Restore the original of a ``.mcz`` file.

    python docs/reader/restore.py FILE.mcz [-o OUT] [--model MODEL.mcm]

Written from the specification, for a second opinion: nothing of mocapress is used, and it is slow.
Of a file without an original, what comes out are the numbers of all streams, one stream behind the
other and row by row, as little-endian doubles.
"""

import argparse
import hashlib
import importlib
import lzma
import struct
import sys
import zlib
from collections.abc import Sequence
from pathlib import Path

import arrays
import c3d
import table
from container import Chunk, File, Stream, packed, read_file, read_model
from layout import Layout
from records import CorruptError

Rows = list[list[float]]
CODECS = ("app", "diffma", "exact", "mrpa", "near", "patterns", "qssd")
LOSSY = ("diffma", "near", "patterns", "qssd")
# What a broken file may lead to.
BROKEN = (
    *(CorruptError, ValueError, LookupError, ArithmeticError),
    *(struct.error, lzma.LZMAError, zlib.error),
)


def restored(data: bytes, model: bytes | None = None) -> bytes:
    """Give the original of a file, of which ``model`` is the ``.mcm`` that it may name."""
    file = read_file(data)
    return original_of(file, [decoded(stream, model) for stream in file.streams])


def original_of(file: File, streams: Sequence[Rows]) -> bytes:
    """Print the rows of all streams as the original had them."""
    if file.format is None:
        return b"".join(packed(row) for rows in streams for row in rows)
    if file.format == "":
        original = file.layout
    else:
        rows, *others = streams
        if file.format in ("c3d", "npy", "npz"):
            layout = (c3d if file.format == "c3d" else arrays).Layout(file.layout)
            original = layout.printed([rows, *others])
            if file.format == "npz" and file.streams[0].codec in LOSSY:
                original = arrays.with_right_digests(original)
        elif file.format in ("csv", "trc"):
            original = table.Layout(file.layout).printed(rows)
        else:
            original = Layout(file, len(rows)).printed(rows)
    codecs = [stream.codec for stream in file.streams]
    if hashlib.sha256(original).digest() != file.digest and not set(codecs) & set(LOSSY):
        raise CorruptError("what was restored is not the original")
    return original


def decoded(stream: Stream, model: bytes | None) -> Rows:
    """Give the rows of a stream."""
    payload = None
    if stream.model:
        if model is None:
            raise CorruptError("decoding needs the model that the file names")
        payload = read_model(model, stream.model)
    return [row for chunk in stream.chunks for row in decoded_chunk(stream, chunk, payload)]


def decoded_chunk(
    stream: Stream, chunk: Chunk, model: bytes | None, needed: Sequence[Rows] = ()
) -> Rows:
    """Give the rows of a chunk, by a model or beside the frames that it needs."""
    if stream.codec not in CODECS:
        raise CorruptError(f"coded by {stream.codec}, which this reader does not know")
    formats = [(told[0], told[1]) if told else (4, 0) for told in stream.formats]
    decode = importlib.import_module(stream.codec).decode
    header = stream.header if chunk.header is None else chunk.header
    told = [(chunk.frames, chunk.payload)]
    more = {"model": model} if model else {"needed": needed} if needed else {}
    rows: Rows = decode(header, stream.parameters, told, formats, **more)
    if zlib.crc32(b"".join(map(packed, rows))) != chunk.digest:
        raise CorruptError("a chunk decodes to other numbers than were coded")
    return rows


def main() -> None:
    """Restore a file."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("-o", dest="output", type=Path, help="otherwise standard output")
    parser.add_argument("--model", type=Path, help="the .mcm that the file names")
    arguments = parser.parse_args()
    try:
        model = arguments.model.read_bytes() if arguments.model else None
        original = restored(arguments.file.read_bytes(), model)
    except BROKEN as error:
        sys.exit(f"{arguments.file}: {error}")
    if arguments.output:
        with arguments.output.open("xb") as target:
            target.write(original)
    else:
        sys.stdout.buffer.write(original)


if __name__ == "__main__":
    main()
