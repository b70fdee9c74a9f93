"""The codec ``mrpa`` (docs/format.md)."""

import math
from collections.abc import Sequence

import app
from app import ROUNDED, Floats, difference
from lines import rounded
from records import CorruptError, Record
from streams import Coded, symbol, tree

Rows = list[list[float]]
ALPHAS = (0, 0.25, 0.5, 0.75, 0.875, 1, 1.25)
BETAS = (0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 1)
UNPREDICTED = 7
NONE_YET = 8


def decode(
    header: bytes,
    parameters: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
    needed: Sequence[Rows] = (),
) -> Rows:
    """Give the rows of chunks beside the frames that they need.

    ``formats`` are kind and digits of each column's number format.
    """
    record = Record(header)
    precisions = record.list_in_runs(len(formats))
    left = len(header) > record.at
    parents = app.parents_of(record.list_in_runs(len(formats))) if left else []
    record.end()
    limit = int(parameters.get("mantissa_limit", "53"))
    rows = []
    for frames, payload in chunks:
        columns = chunk_columns(payload, frames, parents, precisions, limit, needed)
        for column, (kind, digits) in enumerate(formats):
            if precisions[column] == 2 and kind in ROUNDED:
                grid, more = ROUNDED[kind]
                columns[column] = [rounded(m, grid, digits + more) for m in columns[column]]
        rows += [list(row) for row in zip(*columns, strict=True)]
    return rows


def chunk_columns(
    payload: bytes,
    frames: int,
    parents: list[int | None],
    precisions: list[int],
    limit: int,
    needed: Sequence[Rows],
) -> list[list[float]]:
    """Decode a chunk, column by column."""
    record = Record(payload)
    pieces = [read_piece(record, needed) for _ in range(record.integer())]
    if frames and not pieces:
        limit = record.integer()
        coded = record.raw(len(payload) - record.at)
        table = app.TABLES["k3-non-uniform"]
        found = app.chunk_columns(coded, frames, parents, precisions, table, 15, limit)
        return [found[c] for c in range(len(precisions))]
    if sum(count for count, _ in pieces) != frames:
        raise CorruptError("the pieces are not the frames of the chunk")
    stream = Coded(record.raw(len(payload) - record.at))
    models = {single: Floats(single, limit) for single in (False, True)}
    alphas = [tree(3) for _ in range(NONE_YET + 1)]
    betas = [tree(3) for _ in range(NONE_YET + 1)]
    columns = []
    for c, precision in enumerate(precisions):
        column: list[float] = []
        alpha = beta = NONE_YET
        for count, parent in pieces:
            alpha = symbol(stream, alphas[alpha])
            beside: list[float] = []
            share = 0.0
            if parent:
                beta = symbol(stream, betas[beta])
                share = BETAS[beta]
                beside = [row[c] if math.isfinite(row[c]) else 0.0 for row in parent]
            for i in range(count):
                guess = prediction(column, alpha, share, beside, i)
                column.append(models[precision > 0].next(stream, guess))
        columns.append(column)
    stream.end()
    return columns


def read_piece(record: Record, needed: Sequence[Rows]) -> tuple[int, Rows]:
    """Take a piece: how many frames it has, and the parent's frame beside each, if it has one."""
    count, need = record.integer(), record.integer()
    if need == 0:
        return count, []
    rows = needed[need - 1]
    at = [record.integer()]
    steps, lengths = Coded(record.bytes()), tree(7)
    for _ in range(count - 1):
        at.append(at[-1] + 1 + difference(steps, lengths))
    return count, [rows[row] for row in at]


def prediction(column: list[float], alpha: int, share: float, parent: list[float], i: int) -> float:
    """Predict the next value, frame ``i`` of its piece."""
    if alpha == UNPREDICTED:
        return 0.0
    if not column:
        return parent[0] if share else 0.0
    predicted = column[-1]
    if len(column) > 1:
        predicted += ALPHAS[alpha] * (column[-1] - column[-2])
    if share and i > 0:
        before = ALPHAS[alpha] * (parent[i - 1] - parent[i - 2]) if i > 1 else 0.0
        predicted += share * ((parent[i] - parent[i - 1]) - before)
    return predicted if predicted == predicted else 0.0
