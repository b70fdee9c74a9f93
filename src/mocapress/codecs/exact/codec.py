"""The codec ``exact``."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.contract import Chunk, Codec, Encoded, Model
from mocapress.codecs.exact.coupling_search import find_couplings
from mocapress.codecs.exact.roles import Role, Roles, find_roles, read_roles, write_roles
from mocapress.codecs.exact.skeletons import is_known
from mocapress.codecs.exact.start import Learned, Start, model_of, start_of
from mocapress.errors import CorruptError, ParameterError
from mocapress.motion import Clip, Column
from mocapress.records import Reader, Writer

_MOST_FRAMES = 1 << 20
_NO_MODEL, _MODEL = 0, 1
_FAST_LEVELS = 2
"""Up to this level couplings are not looked for: core/exact_fast/codec.hpp has no use for them."""


@dataclass(frozen=True, slots=True)
class Exact(Codec):
    """Prediction by several models that learn as they go, and coding on the decimal grid."""

    id: ClassVar[str] = "exact"
    lossless: ClassVar[bool] = True

    level: int = 6
    """1, the fastest, to 9, the strongest."""
    chunk: int = 2048
    """Frames that are decoded together; every chunk learns anew."""

    def __post_init__(self) -> None:
        for name, most in (("level", 9), ("chunk", _MOST_FRAMES)):
            value = getattr(self, name)
            if not isinstance(value, int) or not 1 <= value <= most:
                raise ParameterError(f"exact:{name}", expected=f"1 to {most}", found=repr(value))

    def train(self, clips: Iterable[Clip]) -> Model:
        """Learn from clips what to begin with: each clip is coded as if it went on from the last.

        A model is of use for clips of the same columns, coded at the same level.
        """
        start = Start()
        for clip in clips:
            values = np.ascontiguousarray(clip.values, dtype=np.float64)
            if clip.frames == 0:
                continue
            roles = _roles(values, clip.columns, self.level)
            coded = roles.coded
            _, learned = _encode(values, roles, coded, self.level, start, learn=True)
            start.take(coded, learned)
        return model_of(self.id, start)

    def encode(self, clip: Clip, *, model: Model | None = None) -> Encoded:
        """Code a clip; ``(F, C)`` values, any float64 including NaN, infinities and -0.

        Raises
        ------
        CorruptError
            When the model's payload is not one that ``train`` makes.

        """
        values = np.ascontiguousarray(clip.values, dtype=np.float64)
        if clip.frames == 0:
            return Encoded(b"", ())
        start = start_of(model)
        roles = _roles(values, clip.columns, self.level)
        writer = Writer()
        writer.integer(_MODEL if model else _NO_MODEL)
        write_roles(writer, roles)
        constants = roles.of(Role.CONSTANT)
        writer.bytes(_encode(values[:1], roles, constants, self.level, Start())[0])
        chunks = []
        for first in range(0, clip.frames, self.chunk):
            rows = values[first : first + self.chunk]
            payload, _ = _encode(rows, roles, roles.coded, self.level, start)
            chunks.append(Chunk(first, len(rows), payload))
        return Encoded(bytes(writer.data), tuple(chunks))

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,
    ) -> NDArray[np.float64]:
        """Decode any chunks, one after the other: (sum of their frames, C) float64.

        Raises
        ------
        CorruptError
            When header or payload are not what ``encode`` makes with these parameters.

        """
        if not chunks:
            return np.empty((0, len(columns)))
        reader = Reader(header, "exact header")
        if reader.integer(_MODEL) == _MODEL and model is None:
            raise reader.fail("the clip was coded with a model")
        start = start_of(model)
        roles = read_roles(reader, len(columns))
        constants = roles.of(Role.CONSTANT)
        first_row = _decode(
            reader.bytes(), 1, roles, constants, self.level, Start(), reader.section
        )
        reader.end()
        for chunk in chunks:
            self._check_size(chunk, len(roles.coded))
        values = np.empty((sum(chunk.frames for chunk in chunks), len(columns)))
        values[:, constants] = first_row
        row = 0
        for chunk in chunks:
            where = f"exact chunk from frame {chunk.first}"
            rows = _decode(
                chunk.payload, chunk.frames, roles, roles.coded, self.level, start, where
            )
            values[row : row + chunk.frames, roles.coded] = rows
            row += chunk.frames
        copies = roles.of(Role.COPY)
        values[:, copies] = values[:, [roles.originals[column] for column in copies]]
        return values

    def _check_size(self, chunk: Chunk, coded: int) -> None:
        """Refuse what cannot be, before memory is asked for it."""
        if not 0 < chunk.frames <= self.chunk:
            raise CorruptError(
                f"exact chunk from frame {chunk.first} has an impossible number of frames",
                expected=f"1 to {self.chunk}",
                found=str(chunk.frames),
            )
        # A number costs at least log2(65536 / 65512) bits.
        if coded * chunk.frames > 2**14 * (len(chunk.payload) + 64):
            raise CorruptError(f"exact chunk from frame {chunk.first} is cut off")


def _roles(values: NDArray[np.float64], columns: Sequence[Column], level: int) -> Roles:
    if level <= _FAST_LEVELS:
        return find_roles(values, lambda _, __: [])
    return find_roles(
        values,
        lambda predicted, lines: find_couplings(values, columns, predicted, lines),
        places=is_known(columns),
    )


def _encode(
    values: NDArray[np.float64],
    roles: Roles,
    columns: Sequence[int],
    level: int,
    start: Start,
    *,
    learn: bool = False,
) -> tuple[bytes, Learned]:
    if not columns:
        return b"", ([], [])
    couplings = roles.coupled() if columns == roles.coded else []
    rows = np.ascontiguousarray(values[:, columns])
    return _core.exact_encode(rows, roles.plan(columns), couplings, level, start.of(columns), learn)


def _decode(
    payload: bytes,
    frames: int,
    roles: Roles,
    columns: Sequence[int],
    level: int,
    start: Start,
    where: str,
) -> NDArray[np.float64]:
    rows = np.empty((frames, len(columns)))
    if not columns and not payload:
        return rows
    couplings = roles.coupled() if columns == roles.coded else []
    try:
        _core.exact_decode(payload, rows, roles.plan(columns), couplings, level, start.of(columns))
    except ValueError as error:
        raise CorruptError(f"{where}: {error}") from error
    return rows
