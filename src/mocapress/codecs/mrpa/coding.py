"""Chunks of pieces, each beside its parent's frames or without any, and back."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.app.coding import make_plan
from mocapress.codecs.app.header import PRECISIONS, read_parents, write_parents
from mocapress.codecs.app.parents import parent_columns
from mocapress.codecs.app.tables import ALPHA_TABLES
from mocapress.codecs.contract import Chunk, Others, digest_of
from mocapress.errors import CorruptError
from mocapress.motion import Column, Skeleton
from mocapress.records import Reader, Writer

Values = NDArray[np.float64]
Plan = NDArray[np.int32]

PUBLISHED, PREVIOUS, BEST = range(3)
"""How predictions are chosen: ``Choice`` of core/mrpa/codec.hpp."""
_APP_TABLE = np.array(ALPHA_TABLES["k3-non-uniform"], np.float64)
_APP_CLUSTER = 15
_APP_LIMIT = 12
_MOST_LIMIT = 53


@dataclass(frozen=True, slots=True, eq=False)
class Parent:
    """What a piece is coded beside."""

    rows: Values
    """(n, C) successive frames."""
    at: NDArray[np.int64]
    """For each frame of the piece, the row that predicts it."""


class Piece(NamedTuple):
    """Successive frames of a chunk."""

    frames: int
    parent: Parent | None = None


def plan_for(values: Values, columns: Sequence[Column], skeleton: Skeleton | None) -> Plan:
    """Give the plan of the compiled coder, in which parents of columns are those of APP."""
    plan = make_plan(columns, parent_columns(columns, skeleton), [0] * len(columns))
    plan[:, 1] = _core.app_precisions(values, plan)
    return plan


def pack_header(plan: Plan, chunks: Sequence[Chunk]) -> bytes:
    """Give the codec's header: the precisions, and the parents of columns where chunks use them."""
    writer = Writer()
    writer.runs(plan[:, 1].tolist())
    if any(chunk.payload[:1] == b"\0" for chunk in chunks):
        write_parents(writer, plan[:, 0].tolist())
    return bytes(writer.data)


def unpack_header(header: bytes, columns: Sequence[Column]) -> Plan:
    """Give the plan.

    Raises
    ------
    CorruptError
        When the header is not one of as many columns.

    """
    reader = Reader(header, "MRPA header")
    precisions = reader.runs(len(columns), PRECISIONS - 1).tolist()
    parents = read_parents(reader, len(columns)) if reader.left else [-1] * len(columns)
    reader.end()
    return make_plan(columns, parents, precisions)


def beside(values: Values, pieces: Sequence[Piece]) -> Values:
    """Give the parent's frame for each frame of a chunk, zeros where there is none."""
    parents = np.zeros_like(values)
    first = 0
    for piece in pieces:
        if piece.parent is not None:
            parents[first : first + piece.frames] = piece.parent.rows[piece.parent.at]
        first += piece.frames
    return parents


def table_of(pieces: Sequence[Piece], *, fresh: bool = False) -> NDArray[np.int64]:
    """Give pieces as the core takes them, (P, 3): frames, whether with a parent, whether fresh."""
    rows = [(piece.frames, piece.parent is not None, fresh) for piece in pieces]
    return np.array(rows, np.int64).reshape(-1, 3)


def encode_chunk(
    first: int, values: Values, pieces: Sequence[Piece], plan: Plan, limit: int, choice: int
) -> Chunk:
    """Code a chunk of (F, C) values; its parents become its needs.

    The best of one that has none may be as APP codes it.
    """
    writer = Writer()
    writer.integer(len(pieces))
    needs: dict[bytes, int] = {}
    for piece in pieces:
        writer.integer(piece.frames)
        if piece.parent is None:
            writer.integer(0)
            continue
        digest = digest_of(piece.parent.rows)
        writer.integer(1 + needs.setdefault(digest, len(needs)))
        writer.integer(int(piece.parent.at[0]))
        writer.bytes(_core.encode_differences(np.diff(piece.parent.at) - 1))
    coded = _core.mrpa_encode(values, beside(values, pieces), table_of(pieces), plan, limit, choice)
    payload = bytes(writer.data) + coded
    if choice == BEST and not needs:
        payload = min([payload, *_as_app(values, plan, limit)], key=len)
    return Chunk(first, len(values), payload, needs=tuple(needs))


def _as_app(values: Values, plan: Plan, limit: int) -> list[bytes]:
    """Code a chunk as APP does, in context and as published; nothing where it has no frames."""
    if not len(values):
        return []
    return [
        bytes([0, each]) + _core.app_encode(values, plan, _APP_TABLE, _APP_CLUSTER, each)
        for each in {limit, _APP_LIMIT}
    ]


def decode_chunk(chunk: Chunk, plan: Plan, limit: int, others: Others) -> Values:
    """Decode a chunk, (F, C).

    Raises
    ------
    CorruptError
        When it is not one that ``encode_chunk`` makes, or what it needs is not there.

    """
    reader = Reader(chunk.payload, f"MRPA chunk from frame {chunk.first}")
    pieces = read_pieces(reader, chunk, len(plan), others)
    values = np.empty((chunk.frames, len(plan)))
    as_app = chunk.frames and not pieces
    if as_app:
        limit = reader.integer(_MOST_LIMIT)
        if not limit:
            raise reader.fail("no limit of mantissas")
    rest = reader.raw(reader.left)
    try:
        if as_app:
            _core.app_decode(rest, values, plan, _APP_TABLE, _APP_CLUSTER, limit)
        else:
            parents = beside(values, pieces)
            _core.mrpa_decode(rest, values, parents, table_of(pieces), plan, limit)
    except ValueError as error:
        raise reader.fail(str(error)) from error
    return values


def read_pieces(reader: Reader, chunk: Chunk, channels: int, others: Others) -> list[Piece]:
    """Read what stands before the values of a chunk; no pieces where it is as of APP.

    Raises
    ------
    CorruptError
        When it is not what ``encode_chunk`` makes, or what it needs is not there.

    """
    pieces = []
    left = chunk.frames
    for _ in range(reader.count(2)):
        frames = reader.integer(left)
        left -= frames
        parent = _read_parent(reader, chunk, frames, channels, others)
        pieces.append(Piece(frames, parent))
    if left and pieces:
        raise reader.fail(f"{left} frames are in no piece")
    return pieces


def _read_parent(
    reader: Reader, chunk: Chunk, frames: int, channels: int, others: Others
) -> Parent | None:
    need = reader.integer(len(chunk.needs))
    if not need:
        return None
    rows = others.get(chunk.needs[need - 1])
    if rows is None or rows.ndim != 2 or rows.shape[1] != channels or not frames:
        raise CorruptError(
            f"MRPA chunk from frame {chunk.first}: frames of other chunks are missing",
            expected=chunk.needs[need - 1].hex(),
        )
    at = np.empty(frames, np.int64)
    at[0] = reader.integer(2**31)
    try:
        _core.decode_differences(reader.bytes(), at[1:])
    except ValueError as error:
        raise reader.fail(str(error)) from error
    if (np.abs(at[1:]) > 2**31).any():
        raise reader.fail("a step to nowhere")
    at[1:] += 1
    np.cumsum(at, out=at)
    if at.min() < 0 or at.max() >= len(rows):
        raise reader.fail("a parent's frame that is not there")
    return Parent(rows, at)
