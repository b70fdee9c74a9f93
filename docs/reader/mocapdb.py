"""Restore the original of a clip of a library (docs/format/library.md).

    python docs/reader/mocapdb.py LIBRARY.mocapdb CLIP [-o OUT]

Clips that need a model are not restored here.
"""

import argparse
import hashlib
import sqlite3
import sys
import zlib
from pathlib import Path

from container import (
    Chunk,
    File,
    Stream,
    packed,
    read_chunk,
    read_skeleton,
    read_stream,
    sections,
    unpacked,
    varint,
)
from records import CorruptError, Record
from restore import BROKEN, decoded_chunk, original_of

Rows = list[list[float]]


class Library:
    """A library, of which clips are read."""

    def __init__(self, path: Path) -> None:
        # What SQLite calls immutable needs no journal beside the file, and makes none.
        self.tables = sqlite3.connect(f"{path.resolve().as_uri()}?immutable=1", uri=True)
        (version,) = self.tables.execute("PRAGMA user_version").fetchone()
        (kind,) = self.tables.execute("PRAGMA application_id").fetchone()
        if kind != 0x4D435A4C or not 2 <= version <= 5:
            raise CorruptError("no library of version 2 to 5")
        self.version = version
        self.clips: dict[int, File] = {}

    def restored(self, name: str) -> bytes:
        """Give the original of a clip."""
        found = self.tables.execute("SELECT id FROM clips WHERE name = ?", [name]).fetchone()
        if found is None:
            raise CorruptError(f"no clip {name}")
        file = self.clip(found[0])
        return original_of(file, [self.rows(found[0], n) for n in range(len(file.streams))])

    def clip(self, clip: int) -> File:
        """Give the facts and the chunks of a clip."""
        if clip not in self.clips:
            self.clips[clip] = self.read(clip)
        return self.clips[clip]

    def read(self, clip: int) -> File:
        """Put a clip together from the tables."""
        row = self.tables.execute(
            "SELECT format, size, sha256, head, skeletons.record, texts.packed, sections "
            "FROM clips LEFT JOIN skeletons ON skeletons.id = skeleton "
            "LEFT JOIN texts ON texts.id = text LEFT JOIN chunks ON clip = clips.id "
            "WHERE clips.id = ?",
            [clip],
        ).fetchone()
        kind, size, digest, head, skeleton, text, chunks = row
        sample = layout = None
        if self.version > 4:
            sample, layout = self.tables.execute(
                "SELECT sample, layout FROM clips LEFT JOIN skeletons ON skeletons.id = skeleton "
                "WHERE clips.id = ?",
                [clip],
            ).fetchone()
        beside = unpacked(Record(sample[4:])) if sample else b""
        if sample and zlib.crc32(sample[4:]) != int.from_bytes(sample[:4], "little"):
            raise CorruptError("the sample of a skeleton is damaged")
        joints = read_skeleton(Record(unpacked(Record(skeleton)))) if skeleton else []
        told = Record(unpacked(Record(head), beside))
        streams = [read_stream(told, joints) for _ in range(told.integer())]
        told.end()
        text = unpacked(Record(text)) if layout is None else unpacked(Record(layout), beside)
        file = File(joints, streams, kind, size, digest, text)
        for _, _, content in sections(b"\x89MCZ\1" + (chunks or b""), b"\x89MCZ"):
            read_chunk(Record(content), file, needs=True)
        return file

    def rows(self, clip: int, stream: int) -> Rows:
        """Give all frames of a stream: those in chunks of the clip, and those of others."""
        own = self.clip(clip).streams[stream]
        found = self.own_rows(clip, stream, 0, sum(chunk.frames for chunk in own.chunks))
        for first, frames, source, source_first in self.tables.execute(
            "SELECT first, frames, source, source_first FROM runs "
            "WHERE clip = ? AND stream = ? ORDER BY first",
            [clip, stream],
        ).fetchall():
            found[first:first] = self.own_rows(source, stream, source_first, frames)
        return found

    def own_rows(self, clip: int, stream: int, first: int, frames: int) -> Rows:
        """Give frames of those that a clip has in chunks of its own."""
        found: Rows = []
        begin = 0
        own = self.clip(clip).streams[stream]
        for chunk in own.chunks:
            end = begin + chunk.frames
            if begin < first + frames and end > first:
                rows = self.chunk(clip, stream, own, chunk)
                found += rows[max(first - begin, 0) : first + frames - begin]
            begin = end
        return found

    def chunk(self, clip: int, index: int, own: Stream, chunk: Chunk) -> Rows:
        """Decode a chunk, and before it what it needs."""
        needed = [self.needed(clip, index, digest) for digest in chunk.needs]
        return decoded_chunk(own, chunk, None, needed)

    def needed(self, clip: int, stream: int, digest: bytes) -> Rows:
        """Give frames that a chunk needs."""
        source, first, frames = self.tables.execute(
            "SELECT source, source_first, frames FROM needs WHERE clip = ? AND digest = ?",
            [clip, digest],
        ).fetchone()
        rows = self.own_rows(source, stream, first, frames)
        named = varint(len(rows)) + varint(len(rows[0])) + b"".join(map(packed, rows))
        if hashlib.sha256(named).digest() != digest:
            raise CorruptError("other frames than a chunk needs")
        return rows


def main() -> None:
    """Restore a clip."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("library", type=Path)
    parser.add_argument("clip")
    parser.add_argument("-o", dest="output", type=Path, help="otherwise standard output")
    arguments = parser.parse_args()
    try:
        original = Library(arguments.library).restored(arguments.clip)
    except (*BROKEN, sqlite3.Error) as error:
        sys.exit(f"{arguments.library}: {error}")
    if arguments.output:
        with arguments.output.open("xb") as target:
            target.write(original)
    else:
        sys.stdout.buffer.write(original)


if __name__ == "__main__":
    main()
