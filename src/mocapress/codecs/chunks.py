"""What decoding chunks has in common, whatever the codec."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.contract import Chunk
from mocapress.errors import CorruptError


def check_frames(what: str, chunk: Chunk, most: int) -> None:
    """Refuse a chunk of no frames or of more than a codec makes, before memory is asked for it.

    Parameters
    ----------
    what
        The chunk in messages, e.g. ``QSSD chunk``.
    chunk, most
        And how many frames it may have.

    Raises
    ------
    CorruptError
        When it cannot be.

    """
    if not 0 < chunk.frames <= most:
        raise CorruptError(
            f"{what} from frame {chunk.first} has an impossible number of frames",
            expected=f"1 to {most}",
            found=str(chunk.frames),
        )


def decoded_into(
    what: str,
    chunks: Sequence[Chunk],
    columns: int,
    most: int,
    decode: Callable[[bytes, NDArray[np.float64]], None],
) -> NDArray[np.float64]:
    """Decode chunks, one after the other: (sum of their frames, C) float64.

    Parameters
    ----------
    what, most
        As ``check_frames`` has them.
    chunks, columns
        Of how many columns.
    decode
        Writes the numbers of a payload into rows, (F, C); raises ``ValueError`` where it is none.

    Raises
    ------
    CorruptError
        When a chunk is none of the codec's.

    """
    for chunk in chunks:
        check_frames(what, chunk, most)
    values = np.empty((sum(chunk.frames for chunk in chunks), columns))
    row = 0
    for chunk in chunks:
        try:
            decode(chunk.payload, values[row : row + chunk.frames])
        except ValueError as error:
            raise CorruptError(f"{what} from frame {chunk.first}: {error}") from error
        row += chunk.frames
    return values
