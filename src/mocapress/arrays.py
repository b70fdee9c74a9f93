"""Arrays of frames x channels for Zarr: ``exact`` as a codec of numcodecs, by its entry point.

>>> import numcodecs
>>> codec = numcodecs.get_codec({"id": "mocapress_exact", "level": 5})
"""

from typing import Any

import numpy as np
from numcodecs.abc import Codec
from numcodecs.compat import ndarray_copy

from mocapress.api import compress_clip, load
from mocapress.codecs.exact import USUAL_LEVEL, Exact
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column


class ExactArrays(Codec):  # type: ignore[misc, unused-ignore]
    """Lossless compression of arrays of float64, (F, C): rows are frames, columns channels.

    An array of one dimension is one channel. Each chunk of a Zarr array becomes a ``.mcz``, so
    chunks should have all channels and some hundred frames or more.

    Parameters
    ----------
    level
        1, the fastest, to 9, the strongest.

    """

    codec_id = "mocapress_exact"

    def __init__(self, level: int = USUAL_LEVEL) -> None:
        Exact(level=level)  # raises where there is no such level
        self.level = level

    def encode(self, buf: Any) -> bytes:
        """Give an array as a ``.mcz``, which was decoded and compared.

        Raises
        ------
        ParameterError
            When it is no array of float64 of one or two dimensions.

        """
        array = np.asarray(buf)
        if array.dtype != np.float64 or array.ndim not in (1, 2) or not array.dtype.isnative:
            raise ParameterError(
                "an array for mocapress_exact",
                expected="float64, frames x channels",
                found=f"{array.dtype}, {' x '.join(map(str, array.shape))}",
            )
        values = array.reshape(len(array), -1) if array.size else array.reshape(len(array), 0)
        columns = tuple(Column(f"{i}", -1, "") for i in range(values.shape[1]))
        clip = Clip.of(np.ascontiguousarray(values), columns)
        return compress_clip(clip, Exact(level=self.level)).blob

    def decode(self, buf: Any, out: Any = None) -> Any:
        """Give the numbers of a ``.mcz``, (F, C) float64, or put them into ``out``.

        Raises
        ------
        CorruptError
            When it is damaged.

        """
        values = load(memoryview(buf).tobytes()).values
        return ndarray_copy(np.ascontiguousarray(values), out)
