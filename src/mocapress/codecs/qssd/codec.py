"""The codec ``qssd``."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.chunks import decoded_into
from mocapress.codecs.contract import (
    NO_OTHERS,
    Bound,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.codecs.qssd.body import Body, body_of
from mocapress.codecs.qssd.decomposition import MOST_ATOMS
from mocapress.codecs.qssd.feet import protected
from mocapress.codecs.qssd.training import Training
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.records import Writer

MOST_DICTIONARY = 4096
_MOST_LEVELS = 16
_MOST_FRAMES = 1 << 20
_ROUNDING = 0.4
"""What is added to a weight in steps before the fraction is cut off: less than 1/2, since 0 is
cheap."""
_REST_ROUNDING = 0.3
"""The same for what a dictionary's atoms leave."""
_PATCH = 1.9
"""Step of corrections, in ``max_error``; less than 2 leaves room for rounding."""


@dataclass(frozen=True, slots=True)
class QSSD(Codec):
    """QSSD, lossy: predictions from other frames, turned by products of a dictionary's atoms.

    The dictionary is a model; without one, joints are turned one by one.
    """

    id: ClassVar[str] = "qssd"
    can: ClassVar[Capabilities] = Capabilities(
        lossless=False, trains=True, bounds=frozenset({Bound.LARGEST})
    )

    step: float = 0.5
    """Of weights: about how far the body's joints may be moved by rounding one, cm, on a figure
    whose farthest joint is 100 cm from the root."""
    omit: int = 3
    """How many levels of detail are left out, the finest: of every 2^omit frames one is coded."""
    levels: int = 6
    """Levels in all: every 2^levels frames one is predicted from frames before it alone."""
    most: int = 15
    """L: atoms of a frame."""
    max_error: float = inf
    """Largest error of any value, in the unit of its column; kept by corrections."""
    protect: float = inf
    """Largest distance of a foot's joints from where they were while they stand on the floor, in
    the file's unit of lengths; kept by corrections of all channels above them."""
    chunk: int = 2048
    """Frames that are decoded together."""
    atoms: int = 0
    """K, for training; 0: one for each 40 frames that are coded, at most 400."""
    iterations: int = 20
    """Of training."""
    seed: int = 0
    """Of training: which frames the dictionary begins with."""

    def __post_init__(self) -> None:
        for name, least, most in (
            ("levels", 0, _MOST_LEVELS),
            ("omit", 0, self.levels),
            ("most", 1, MOST_ATOMS),
            ("chunk", 1, _MOST_FRAMES),
            ("atoms", 0, MOST_DICTIONARY),
            ("iterations", 1, 10_000),
            ("seed", 0, 2**31),
        ):
            value = getattr(self, name)
            if not isinstance(value, int) or not least <= value <= most:
                self._refuse(name, f"{least} to {most}")
        if not (isfinite(self.step) and 1e-6 <= self.step <= 1e6):
            self._refuse("step", "1e-6 to 1e6")
        if not self.max_error >= 0:
            self._refuse("max_error", "0 or more")
        if not self.protect > 0:
            self._refuse("protect", "above 0")

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64; NaN and infinities stay as they are."""
        body = body_of(stream.columns, skeleton)
        learned = Training.of(model, body)
        own = None if learned else self._own(body, stream)
        used = model if learned else None

        def code(limits: NDArray[np.float64], patch: float) -> Encoded:
            header = self.header(own, patch)
            payload = used.payload if used is not None else b""
            chunks = []
            for first in range(0, stream.frames, self.chunk):
                rows = np.ascontiguousarray(stream.values[first : first + self.chunk])
                most = np.ascontiguousarray(limits[first : first + self.chunk])
                coded = _core.qssd_encode(
                    rows, header, payload, self.most, _ROUNDING, _REST_ROUNDING, most
                )
                chunks.append(Chunk(first, len(rows), coded))
            return Encoded(header, tuple(chunks), uses_model=learned)

        limits = np.full(stream.values.shape, self.max_error)
        if not isfinite(self.protect):
            return code(limits, self.max_error)

        def decoded(
            limits: NDArray[np.float64], patch: float
        ) -> tuple[Encoded, NDArray[np.float64]]:
            made = code(limits, patch)
            return made, self.decode(made.header, made.chunks, stream.columns, model=used)

        return protected(stream, skeleton, self.protect, limits, decoded)

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,
        others: Others = NO_OTHERS,
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        """Decode any chunks, one after the other: (sum of their frames, C) float64.

        Raises
        ------
        CorruptError
            When header, payload or model are not what ``encode`` makes with these parameters.

        """
        learned = b"" if model is None else model.payload

        def decode(payload: bytes, rows: NDArray[np.float64]) -> None:
            _core.qssd_decode(payload, rows, header, learned)

        return decoded_into("QSSD chunk", chunks, len(columns), self.chunk, decode)[:stop]

    def largest_errors(self, columns: Sequence[Column]) -> list[float]:
        """Give the error up to which each column may come back; infinite where none was asked."""
        return [self.max_error] * len(columns)

    def train(self, streams: Iterable[Stream]) -> Model:
        """Learn a dictionary from streams without skeletons."""
        return self.learn(Clip({"motion": stream}) for stream in streams)

    def learn(self, clips: Iterable[Clip]) -> Model:
        """Learn a dictionary from clips with the columns of the first; others are left out."""
        training = Training(self.header, self.atoms, self.most, self.iterations, self.seed)
        for clip in clips:
            training.see(clip, self.chunk)
        return Model(self.id, training.model(_ROUNDING, _REST_ROUNDING))

    def header(self, body: Body | None, limit: float | None = None) -> bytes:
        """Give the codec's header; with the body where no model has it.

        ``limit`` is the finest to which errors are corrected, ``max_error`` by default.
        """
        limit = self.max_error if limit is None else limit
        writer = Writer()
        writer.integer(body is None)
        writer.integer(self.levels)
        writer.integer(self.omit)
        writer.double(self.step)
        writer.double(_PATCH * limit if 0 < limit < inf else 0.0)
        return bytes(writer.data) + (b"" if body is None else body.pack())

    def _own(self, body: Body, stream: Stream) -> Body:
        """Take the first frame as the reference."""
        turns = _core.qssd_turns(np.ascontiguousarray(stream.values[:1]), self.header(body))
        roles = np.array(body.roles, dtype=np.int64)
        numbers = stream.values[:1, roles == 0]
        return body.with_references(turns, np.where(np.abs(numbers) < 1e12, numbers, 0.0))

    def _refuse(self, name: str, expected: str) -> Any:
        raise ParameterError(f"qssd:{name}", expected=expected, found=repr(getattr(self, name)))
