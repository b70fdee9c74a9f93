"""The codec ``mrpa`` (docs/format.md), of clips that need no frames of others."""

from app import ROUNDED, Floats
from lines import rounded
from records import CorruptError, Record
from streams import Coded, symbol, tree

ALPHAS = (0, 0.25, 0.5, 0.75, 0.875, 1, 1.25)
UNPREDICTED = 7
NONE_YET = 8


def decode(
    header: bytes,
    parameters: dict[str, str],
    chunks: list[tuple[int, bytes]],
    formats: list[tuple[int, int]],
) -> list[list[float]]:
    """Give the rows of chunks; ``formats`` are kind and digits of each column's number format."""
    record = Record(header)
    precisions = record.list_in_runs(len(formats))
    record.end()
    limit = int(parameters.get("mantissa_limit", "53"))
    rows = []
    for frames, payload in chunks:
        columns = chunk_columns(payload, frames, precisions, limit)
        for column, (kind, digits) in enumerate(formats):
            if precisions[column] == 2 and kind in ROUNDED:
                grid, more = ROUNDED[kind]
                columns[column] = [rounded(m, grid, digits + more) for m in columns[column]]
        rows += [list(row) for row in zip(*columns, strict=True)]
    return rows


def chunk_columns(
    payload: bytes, frames: int, precisions: list[int], limit: int
) -> list[list[float]]:
    """Decode a chunk, column by column."""
    record = Record(payload)
    pieces = []
    for _ in range(record.integer()):
        pieces.append(record.integer())
        if record.integer():
            raise CorruptError("needs frames of other clips, which a library has")
    if sum(pieces) != frames:
        raise CorruptError("the pieces are not the frames of the chunk")
    stream = Coded(record.raw(len(payload) - record.at))
    models = {single: Floats(single, limit) for single in (False, True)}
    alphas = [tree(3) for _ in range(NONE_YET + 1)]
    columns = []
    for precision in precisions:
        column: list[float] = []
        last = NONE_YET
        for piece in pieces:
            last = symbol(stream, alphas[last])
            for _ in range(piece):
                column.append(models[precision > 0].next(stream, prediction(column, last)))
        columns.append(column)
    stream.end()
    return columns


def prediction(column: list[float], alpha: int) -> float:
    """Predict the next value."""
    if alpha == UNPREDICTED or not column:
        return 0.0
    predicted = column[-1]
    if len(column) > 1:
        predicted += ALPHAS[alpha] * (column[-1] - column[-2])
    return predicted if predicted == predicted else 0.0
