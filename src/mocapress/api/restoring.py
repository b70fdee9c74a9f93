"""From compressed files back to the original files."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mocapress import formats
from mocapress.api.opening import Opened, Rows
from mocapress.container import Companion, Damage, Original, StreamHead, diffma_json, limits
from mocapress.container.columns import bone_names
from mocapress.errors import CorruptError, UnsupportedError
from mocapress.formats.contract import StoredLayout
from mocapress.formats.layout import Layout
from mocapress.formats.layout_record import read_layout
from mocapress.formats.number_formats import SHORTEST
from mocapress.formats.patterns import References
from mocapress.formats.rows import RowsOf
from mocapress.models import Place
from mocapress.source import DIFFMA_JSON, LIMIT, Named, Source


@dataclass(frozen=True, slots=True)
class Restored:
    """What came out of a compressed file."""

    data: bytes
    """The original file."""
    format: str
    """Id of its format; empty where it is no motion file."""
    name: str = ""
    """Its name, without folders, as far as known."""
    companions: tuple[Companion, ...] = ()
    """Other files that belong to it, such as the ASF of an AMC."""
    damage: tuple[Damage, ...] = field(default=())
    """What is lost of it."""


def decompress(
    source: Named | Source,
    *,
    models: Sequence[Place] = (),
    salvage: bool = False,
    limit: int | None = LIMIT,
) -> bytes:
    """Give the original file's bytes (for a lossy codec: the decoded values in its layout).

    Parameters
    ----------
    source
        A ``.mcz`` or a DiffMA JSON, packed or not: a path, the contents or a binary stream.
    models
        Where to look for the model that the file may need: models, their files, or folders of
        them; then beside the file, then in the folders that ``MOCAPRESS_MODELS`` names.
    salvage
        Whether to give what is left of a damaged file: rows that cannot be decoded are left out,
        and a ``MotionWarning`` names each loss.
    limit
        Bytes that may be restored, of the file, and of its numbers, 8 each: 4 GiB by default; None
        for any number.

    Raises
    ------
    CorruptError
        When the file is damaged; also when what was decoded is not what its digest says.
    MissingModelError
        When the model that the file needs is nowhere.
    UnsupportedError
        When there is no original file: the ``.mcz`` was recorded, or made of a clip; or when more
        would be restored than ``limit`` allows.

    """
    opened = source if isinstance(source, Source) else Source(source, limit=limit)
    return restore(opened, models, salvage=salvage).data


def restore(source: Source, models: Sequence[Place] = (), *, salvage: bool = False) -> Restored:
    """Restore a file; see ``decompress``."""
    if source.kind == DIFFMA_JSON:
        kind, data = diffma_json.json_to_file(source)
        return Restored(data, kind)
    return restore_opened(Opened(source, models, salvage=salvage))


def restore_opened(opened: Opened) -> Restored:
    """Restore a file from one that is open; see ``decompress``."""
    source, original = opened.source, opened.mcz.original
    if original is None:
        if opened.damage:
            raise CorruptError("the section with the file's layout is damaged")
        raise UnsupportedError(
            "there is no original file: this one was recorded, or made of a clip",
            file=source.name or None,
            expected="mp.load or, if it has a skeleton, mocapress convert",
        )
    data = contents(opened, original)
    opened.warn_of_losses()
    return Restored(
        data, original.format, original.name, tuple(opened.mcz.companions), tuple(opened.damage)
    )


def contents(opened: Opened, original: Original) -> bytes:
    """Give the original file's bytes, and see that they are these."""
    return b"".join(pieces(opened, original))


def pieces(opened: Opened, original: Original) -> Iterator[bytes]:
    """Give the original file's bytes part after part, and see at the end that they are these."""
    opened.source.allow(original.size)
    lossless = True
    if not original.format:
        parts = original.contents()
    elif not opened.streams:
        raise CorruptError("the head of this file is damaged: no numbers can be decoded")
    else:
        lossless = opened.codec().lossless
        parts = _printed_parts(opened, original)
        completed = formats.by_id(original.format).completed
        if completed and not lossless:
            parts = iter((completed(b"".join(parts)),))
    made = hashlib.sha256()
    for part in parts:
        made.update(part)
        yield part
    found = made.digest()
    if lossless and not opened.damage and found != original.digest:
        raise CorruptError(
            "wrong digest of the contents", expected=original.digest.hex(), found=found.hex()
        )


def _printed_parts(opened: Opened, original: Original) -> Iterator[bytes]:
    """Decode and print, a run of rows after the other."""
    size, source = original.size, opened.source
    source.allow(sum(opened.bytes_of(i, opened.frames(i)) for i in range(len(opened.streams))))
    own = own_layout(original)
    if own is None and opened.salvage:
        # Which rows are lost must be known before the first is printed.
        yield printed(opened, original, opened.rows())
        return
    most = size
    layout: StoredLayout | Layout
    if own is None:
        frames, columns = opened.frames(), len(opened.streams[0].columns)
        sizes = [(frames, columns)]
        if not opened.codec().lossless:
            most = limits.most_printed(size, frames * columns)
        layout = layout_of(opened, original, frames)
    else:
        sizes, layout = own.sizes, own
        numbers = 0 if opened.codec().lossless else sum(rows * width for rows, width in sizes)
        most = limits.most_printed(size, numbers)
    found = [
        (opened.frames(index), len(opened.streams[index].columns)) for index in range(len(sizes))
    ]
    if len(opened.streams) < len(sizes) or found != sizes:
        raise CorruptError("the streams do not fit the layout")
    count = 0
    for part in layout.pieces(in_order(opened), most):
        count += len(part)
        source.allow(count)
        yield part


def in_order(opened: Opened) -> RowsOf:
    """Give rows of streams that are asked for in their order: no chunk is decoded twice."""
    held: dict[int, tuple[int, NDArray[np.float64]]] = {}

    def rows(stream: int, first: int, last: int) -> NDArray[np.float64]:
        parts: list[NDArray[np.float64]] = []
        while first < last or not parts:
            begin, values = held.get(stream, (0, np.empty((0, 0))))
            if not begin <= first < begin + len(values) and first < last:
                held[stream] = (0, np.empty((0, 0)))
                del values
                begin, end = opened.run_at(stream, first)
                values = opened.rows(stream, begin, end).filled()
                held[stream] = begin, values
            stop = min(last, begin + len(values))
            parts.append(values[first - begin : stop - begin])
            first = stop
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    return rows


def printed(opened: Opened, original: Original, rows: Rows) -> bytes:
    """Print decoded rows in the original's layout; lost rows are left out."""
    size, source = original.size, opened.source
    source.allow(sum(opened.bytes_of(i, opened.frames(i)) for i in range(len(opened.streams))))
    most = size
    if not opened.codec().lossless:
        most = limits.most_printed(size, rows.values.size)
    keep = None if rows.kept.all() else rows.kept
    layout = layout_of(opened, original, len(rows.values) if keep is None else int(keep.sum()))
    values = rows.values
    if keep is not None:
        layout, values = layout.rows(keep), values[keep]
    return source.printed(lambda allowed: layout.join(values, allowed), most)


def own_layout(original: Original) -> StoredLayout | None:
    """Read the layout of a format that has its own kind of layout; None for rows of text."""
    of = formats.by_id(original.format)
    return None if of.read_layout is None else of.read_layout(original.layout())


def layout_of(opened: Opened, original: Original, rows: int) -> Layout:
    """Read the layout, its header for so many rows."""
    stream = opened.streams[0]
    return read_layout(
        original.layout(),
        original.format,
        opened.frames(),
        tuple(column.decimal or SHORTEST for column in stream.columns),
        references(opened, stream),
        limits.most_layout(original.size, len(original.packed)),
        rows,
    )


def references(opened: Opened, stream: StreamHead) -> References:
    """Give what a layout may refer to."""
    skeleton = opened.mcz.head.skeleton if opened.mcz.head else None
    return References.of(skeleton, bone_names(stream.bones), stream.frame_time)
