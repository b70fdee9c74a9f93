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
_STRONGEST_CODED = 10
"""What level 9 is coded at; the coder's 9 is that of older files."""
_FAST = 5
"""Levels up to this one take no models, and do not tell what the first frames take."""
_MOST_FRAMES = 1 << 20
_USUAL_CHUNK = 512
_UNCOUPLED = 2
"""Up to this level couplings are not looked for: they have no use for them."""
_TRIED = 256
"""Frames on which lower levels are tried, too; as in core/exact/codec.hpp."""
_OTHERS = {5, 4, 3, 2, 1}
"""Lower levels that are tried, beside the next one below."""
_SHORT = 128
"""Up to so many frames all lower levels are tried."""
_NEAR = 1.0025
"""Lower levels that come so near with these frames are tried with all frames; up to level 5, those
that are no larger."""
_MOST_NEAR = 2
"""So many of them, at most."""
_TELLING = 2
"""Laws of a skeleton that tell that columns without names are its channels."""


@dataclass(frozen=True, slots=True)
class Exact(Codec):
    """Prediction by several models that learn as they go, and coding on the decimal grid."""

    id: ClassVar[str] = "exact"
    can: ClassVar[Capabilities] = Capabilities(lossless=True, levels=True, trains=True)

    level: int = USUAL_LEVEL
    """1, the fastest, to 9, the strongest."""
    chunk: int = _USUAL_CHUNK
    """Frames that are decoded together; every chunk learns anew."""

    def __post_init__(self) -> None:
        for name, most in (("level", 9), ("chunk", _MOST_FRAMES)):
            value = getattr(self, name)
            if not isinstance(value, int) or not 1 <= value <= most:
                raise ParameterError(f"exact:{name}", expected=f"1 to {most}", found=repr(value))

    def left_out(self) -> set[str]:
        """Name the level, which the codec header names in a byte, and the usual chunk."""
        return {"level", "chunk"} if self.chunk == _USUAL_CHUNK else {"level"}

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
        return self.level > _FAST

    def train(self, streams: Iterable[Stream]) -> Model:
        """Learn what to begin with: each stream is coded as if it went on from the last.

        A model is of use for streams of the same columns, coded at the same level.
        """
        start = Start()
        for stream in streams:
            if stream.frames == 0:
                continue
            _, numbers, _ = Told.find(stream.values)
            coder = _Coder(_roles(numbers, stream.columns, self.level), self._coded, start)
            _, learned, _ = coder.encode(numbers, learn=True)
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
        roles = _roles(numbers, stream.columns, self.level)
        way = _Way.of(numbers, self, roles, self._coded, start_of(model))
        if model is None:
            way = _smallest(way, numbers, self)
        chunks = []
        for place, payload in enumerate(way.payloads):
            rows = slice(place * self.chunk, (place + 1) * self.chunk)
            own = [mask[rows] for mask in masks]
            chunks.append(Chunk(rows.start, len(numbers[rows]), told.pack(payload, own)))
        header = pack_header(
            way.roles, told, has_model=model is not None, level=way.level, asked=self.level
        )
        return Encoded(header, tuple(chunks))

    @property
    def _coded(self) -> int:
        """The coder's level."""
        return _STRONGEST_CODED if self.level == STRONGEST_LEVEL else self.level

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
    if level <= _UNCOUPLED:
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


@dataclass(frozen=True, slots=True)
class _Way:
    """A way to code a clip, and what comes of it."""

    roles: Roles
    level: int
    payloads: list[bytes]
    size: int
    """Bytes, with the header."""
    early: int
    """About how many of them the first frames take that are tried; up to level 5 all."""

    @classmethod
    def of(
        cls,
        numbers: NDArray[np.float64],
        codec: Exact,
        roles: Roles,
        level: int,
        start: Start,
        header: int | None = None,
    ) -> "_Way":
        """Code a clip as a codec asks for; ``header`` is the size of its header, if it is known."""
        coder, size = _Coder(roles, level, start), codec.chunk
        firsts = range(0, len(numbers), size)
        coded = each(lambda first: coder.encode(numbers[first : first + size]), firsts)
        payloads = [payload for payload, _, _ in coded]
        if header is None:
            told = pack_header(roles, Told(), has_model=False, level=level, asked=codec.level)
            header = len(told)
        payload = sum(map(len, payloads))
        return cls(roles, level, payloads, header + payload, header + (coded[0][2] or payload))


def _smallest(way: _Way, numbers: NDArray[np.float64], codec: Exact) -> _Way:
    """Give how a clip is coded in the fewest bytes: as it is, or at a lower level.

    More predictors are not better ones for every clip, least of all for short ones. Tried are, on
    the first frames, the fast levels and the next one below, of short clips all; then those that
    come near, on all frames.
    """
    rows, asked = numbers[: min(_TRIED, codec.chunk)], codec.level
    # Their sizes, by what they depend on.
    headers: dict[tuple[bool, bool], int] = {}

    def at(level: int, tried: NDArray[np.float64]) -> _Way:
        roles = replace(way.roles, couplings=()) if level <= _UNCOUPLED else way.roles
        kind = level <= _UNCOUPLED, level == USUAL_LEVEL
        one = _Way.of(tried, codec, roles, level, Start(), headers.get(kind))
        headers[kind] = one.size - sum(map(len, one.payloads))
        return one

    lower = range(1, asked) if len(numbers) <= _SHORT else _OTHERS | {asked - 1}
    tried = each(lambda level: at(level, rows), sorted(n for n in lower if 0 < n < asked))
    if tried and len(rows) < len(numbers):
        # What is known only about may be off a little; and the fast levels are to stay fast.
        first = at(way.level, rows).size if asked <= _FAST else _NEAR * way.early
        near = [one for one in tried if one.size <= first]
        near.sort(key=lambda one: one.size)
        tried = [at(one.level, numbers) for one in near[:_MOST_NEAR]]
    return min([way, *tried], key=lambda one: (one.size, -one.level))


class _Coder:
    """The compiled coder, told how a clip is coded."""

    def __init__(self, roles: Roles, level: int, start: Start) -> None:
        self.columns = roles.coded
        """The columns that it codes, in its order."""
        self._level = level
        self._plan = roles.plan(self.columns)
        self._couplings = roles.coupled(self.columns)
        self._start = start.of(self.columns)

    def encode(
        self, rows: NDArray[np.float64], *, learn: bool = False
    ) -> tuple[bytes, Learned, int]:
        """Code rows of all columns of the clip, (F, C): as ``_core.exact_encode`` gives it."""
        if not self.columns:
            return b"", ([], []), 0
        own = np.ascontiguousarray(rows[:, self.columns])
        return _core.exact_encode(own, self._plan, self._couplings, self._level, self._start, learn)
