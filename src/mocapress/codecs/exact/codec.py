"""The codec ``exact``."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.chunks import check_frames
from mocapress.codecs.contract import (
    NO_OTHERS,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
)
from mocapress.codecs.exact.columns import Told
from mocapress.codecs.exact.coupling_search import find_couplings
from mocapress.codecs.exact.header import USUAL_LEVEL, asked_level, pack_header
from mocapress.codecs.exact.roles import Roles, find_roles
from mocapress.codecs.exact.skeletons import NONE, OWN_COUPLINGS, assumed, skeleton_of
from mocapress.codecs.exact.start import Learned, Start, level_of, model_of, start_of
from mocapress.codecs.threads import each
from mocapress.errors import CorruptError, ParameterError
from mocapress.motion import Column, Skeleton, Stream

STRONGEST_LEVEL: Final = 9
_LEVELS_WITHOUT_MODELS = 5
_MOST_FRAMES = 1 << 20
_FAST_LEVELS = 2
"""Up to this level couplings are not looked for: they have no use for them."""
_TRIED = 256
"""Frames on which lower levels are tried, too."""
_OTHERS = (5, 4, 3, 2, 1)
"""Lower levels that are always tried."""
_SHORT = 128
"""Up to so many frames all lower levels are tried."""
_NEAR = 1.015
"""Other levels below are tried only where these come so near."""
_SURE = 0.997
"""How much smaller a lower level must be where there are more frames than are tried."""
_TELLING = 2
"""Laws of a skeleton that tell that columns without names are its channels."""


@dataclass(frozen=True, slots=True)
class Exact(Codec):
    """Prediction by several models that learn as they go, and coding on the decimal grid."""

    id: ClassVar[str] = "exact"
    can: ClassVar[Capabilities] = Capabilities(lossless=True, levels=True, trains=True)

    level: int = USUAL_LEVEL
    """1, the fastest, to 9, the strongest."""
    chunk: int = 512
    """Frames that are decoded together; every chunk learns anew."""

    def __post_init__(self) -> None:
        for name, most in (("level", 9), ("chunk", _MOST_FRAMES)):
            value = getattr(self, name)
            if not isinstance(value, int) or not 1 <= value <= most:
                raise ParameterError(f"exact:{name}", expected=f"1 to {most}", found=repr(value))

    def as_stored(self) -> "Exact":
        """Give the codec at the usual level: the header names another, in a byte."""
        return replace(self, level=USUAL_LEVEL)

    def as_told(self, header: bytes) -> "Exact":
        """Give the codec at the level that was asked for, if the header names one."""
        level = asked_level(header)
        return replace(self, level=level) if level else self

    def for_model(self, model: Model | None) -> "Exact":
        """Give the codec at the model's level; to learn one, at the strongest."""
        return replace(self, level=level_of(model) if model else STRONGEST_LEVEL)

    @property
    def learns(self) -> bool:
        """Whether models are of use at the level."""
        return self.level > _LEVELS_WITHOUT_MODELS

    def train(self, streams: Iterable[Stream]) -> Model:
        """Learn what to begin with: each stream is coded as if it went on from the last.

        A model is of use for streams of the same columns, coded at the same level.
        """
        start = Start()
        for stream in streams:
            if stream.frames == 0:
                continue
            _, numbers, _ = Told.find(stream.values)
            coder = _Coder(_roles(numbers, stream.columns, self.level), self.level, start)
            _, learned = coder.encode(numbers, learn=True)
            start.take(coder.columns, learned)
        return model_of(self.id, self.level, start)

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64 including NaN, infinities and -0.

        Raises
        ------
        CorruptError
            When the model's payload is not one that ``train`` makes.

        """
        if stream.frames == 0:
            return Encoded(b"", ())
        told, numbers, masks = Told.find(stream.values)
        roles, level = _roles(numbers, stream.columns, self.level), self.level
        if model is None:
            roles, level = _smallest(roles, level, numbers)
        coder = _Coder(roles, level, start_of(model))

        def coded(first: int) -> Chunk:
            rows = numbers[first : first + self.chunk]
            own = [mask[first : first + self.chunk] for mask in masks]
            return Chunk(first, len(rows), told.pack(coder.encode(rows)[0], own))

        chunks = each(coded, range(0, stream.frames, self.chunk))
        header = pack_header(
            roles, told, has_model=model is not None, level=level, asked=self.level
        )
        return Encoded(header, tuple(chunks))

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

        Of ``stop`` frames the rest of the last chunk that they need is not decoded.

        Raises
        ------
        CorruptError
            When header or payload are not what ``encode`` makes with these parameters.

        """
        if not chunks:
            return np.empty((0, len(columns)))
        try:
            coded, has_model = _core.exact_coded(header, len(columns))
        except ValueError as error:
            raise CorruptError(f"exact header: {error}") from error
        if has_model and model is None:
            raise CorruptError("exact header: the clip was coded with a model")
        start_of(model)
        learned = b"" if model is None else model.payload
        for chunk in chunks:
            self._check_size(chunk, coded)
        frames = sum(chunk.frames for chunk in chunks)
        values = np.empty((frames if stop is None else min(stop, frames), len(columns)))

        def fill(place: tuple[int, Chunk]) -> None:
            first, chunk = place
            rows = values[first : first + chunk.frames]
            try:
                _core.exact_decode_chunk(
                    header, bytes(chunk.payload), rows, chunk.frames, self.level, learned
                )
            except ValueError as error:
                raise CorruptError(f"exact chunk from frame {chunk.first}: {error}") from error

        firsts = accumulate((chunk.frames for chunk in chunks[:-1]), initial=0)
        places = zip(firsts, chunks, strict=True)
        each(fill, [place for place in places if place[0] < len(values)])
        return values

    def _check_size(self, chunk: Chunk, coded: int) -> None:
        """Refuse what cannot be, before memory is asked for it."""
        check_frames("exact chunk", chunk, self.chunk)
        # A number costs at least log2(65536 / 65512) bits.
        if coded * chunk.frames > 2**14 * (len(chunk.payload) + 64):
            raise CorruptError(f"exact chunk from frame {chunk.first} is cut off")


def _roles(values: NDArray[np.float64], columns: Sequence[Column], level: int) -> Roles:
    if level <= _FAST_LEVELS:
        return find_roles(values, lambda _, __: [])
    joints = assumed(columns)
    found = find_roles(
        values,
        lambda predicted, lines: find_couplings(values, joints, predicted, lines),
        skeleton=skeleton_of(joints),
    )
    # A skeleton that no name speaks for must show by its laws.
    if joints is columns or len(set(found.couplings) & set(OWN_COUPLINGS)) >= _TELLING:
        return found
    return replace(found, skeleton=NONE)


def _smallest(roles: Roles, level: int, values: NDArray[np.float64]) -> tuple[Roles, int]:
    """Give how a clip is coded in the fewest bytes, as far as its first frames tell.

    More predictors are not better ones for every clip, least of all for short ones. Tried are the
    level, the fast ones, and the next one below; of short clips all.
    """
    rows = values[:_TRIED]

    def at(own: int) -> Roles:
        return replace(roles, couplings=()) if own <= _FAST_LEVELS else roles

    def size(own: int) -> float:
        header = pack_header(at(own), Told(), has_model=False, level=own, asked=level)
        found = len(header) + len(_Coder(at(own), own, Start()).encode(rows)[0])
        return found / _SURE if own < level and len(rows) < len(values) else found

    lower = range(level - 1, 0, -1) if len(values) <= _SHORT else _OTHERS
    tried = [level, *(other for other in lower if other < level)]
    sizes = dict(zip(tried, each(size, tried), strict=True))
    # Where the skeleton is not known, the two strongest code alike.
    below = level - 2 if level == STRONGEST_LEVEL and roles.skeleton == NONE else level - 1
    others = min((sizes[other] for other in tried[1:]), default=0.0)
    if below > _OTHERS[0] and below not in sizes and others < _NEAR * sizes[level]:
        sizes[below] = size(below)
    best = min(sizes, key=lambda own: (sizes[own], -own))
    return at(best), best


class _Coder:
    """The compiled coder, told how a clip is coded."""

    def __init__(self, roles: Roles, level: int, start: Start) -> None:
        self.columns = roles.coded
        """The columns that it codes, in its order."""
        self._level = level
        self._plan = roles.plan(self.columns)
        self._couplings = roles.coupled(self.columns)
        self._start = start.of(self.columns)

    def encode(self, rows: NDArray[np.float64], *, learn: bool = False) -> tuple[bytes, Learned]:
        """Code rows of all columns of the clip, (F, C)."""
        if not self.columns:
            return b"", ([], [])
        own = np.ascontiguousarray(rows[:, self.columns])
        return _core.exact_encode(own, self._plan, self._couplings, self._level, self._start, learn)
