"""Learning the model of ``qssd`` from clips."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.contract import Model
from mocapress.codecs.qssd.body import Body, body_of
from mocapress.codecs.qssd.decomposition import Products, learn
from mocapress.errors import CorruptError, ParameterError
from mocapress.motion import Clip
from mocapress.records import Reader, Writer

_ATOM_STEPS = 128
_FRAMES_PER_ATOM = 40
_MOST_ATOMS = 400
_MOST_WHILE_LEARNING = 8
"""Atoms of a frame; more cost time, and shape the dictionary little."""
_KINDS = 8
"""Kinds of stages of which the model has chances of zeros."""

HeaderOf = Callable[[Body | None], bytes]


@dataclass(slots=True)
class Training:
    """Clips of equal columns, and the model that is learned from them."""

    header: HeaderOf
    atoms: int
    most: int
    iterations: int
    seed: int
    body: Body | None = None
    chunks: list[NDArray[np.float64]] = field(default_factory=list)

    def see(self, clip: Clip, chunk: int) -> None:
        """Take a clip's frames, unless its columns are others than those of the first."""
        body = body_of(clip.columns, clip.skeleton)
        if self.body is None:
            self.body = body
        if _same(body, self.body):
            self.chunks += [
                np.ascontiguousarray(clip.values[first : first + chunk])
                for first in range(0, clip.frames, chunk)
            ]

    def model(self, rounding: float, rest_rounding: float) -> bytes:
        """Learn, and give the model's payload."""
        if self.body is None:
            raise ParameterError("nothing to learn from", expected="at least one clip")
        body = self._with_means(self.body)
        header = self.header(body)
        turns = np.concatenate(
            [
                np.empty((0, len(body.importance), 4)),
                *(_core.qssd_displacements(rows, header) for rows in self.chunks),
            ]
        )
        dictionary = self._dictionary(body, turns)
        without = _pack(body, dictionary, b"")
        return _pack(body, dictionary, self._chances(body, without, rounding, rest_rounding))

    @classmethod
    def of(cls, model: Model | None, body: Body) -> bool:
        """Say whether a model was learned from such columns.

        Raises
        ------
        CorruptError
            When the model's payload is not what ``model`` makes.

        """
        if model is None:
            return False
        reader = Reader(model.payload, "qssd model")
        columns = reader.integer(2**18)
        roles = tuple(reader.runs(columns, 6).tolist())
        flags = reader.integer(3)
        try:
            _core.qssd_kinds(0, b"\x01\x00\x00" + _STEPS, columns, model.payload)
        except ValueError as error:
            raise CorruptError(f"qssd model: {error}") from error
        return roles == body.roles and flags == body.reversed | body.radians << 1

    def _with_means(self, body: Body) -> Body:
        header = self.header(body)
        turns = [_core.qssd_turns(rows, header) for rows in self.chunks]
        numbers = [rows[:, np.array(body.roles) == 0] for rows in self.chunks]
        if not turns:
            return body
        everything = np.concatenate(numbers)
        return body.with_references(
            np.concatenate(turns), np.where(np.abs(everything) < 1e12, everything, 0.0)
        )

    def _dictionary(self, body: Body, turns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Learn the atoms, (K, J, 3), rounded as the model has them."""
        covered = ~np.array(body.apart, dtype=bool)
        importance = np.array(body.importance) / 16
        atoms = self.atoms or min(_MOST_ATOMS, len(turns) // _FRAMES_PER_ATOM)
        whole = np.zeros((atoms, len(importance), 3))
        if atoms and covered.any() and len(turns):
            learned = learn(
                Products(importance[covered], sort=True),
                np.ascontiguousarray(turns[:, covered]),
                atoms,
                min(self.most, _MOST_WHILE_LEARNING),
                iterations=self.iterations,
                seed=self.seed,
                settled=1e-3,
            )
            whole[:, covered] = learned.dictionary
        steps = np.rint(whole * importance[:, None] * _ATOM_STEPS)
        used = (steps != 0).any(axis=(1, 2))
        limited: NDArray[np.float64] = np.clip(steps, -256, 256)[used]
        return limited

    def _chances(self, body: Body, model: bytes, rounding: float, rest_rounding: float) -> bytes:
        """Count how often each number is 0 in each kind of stage, as chances in 1/256."""
        header = self.header(None)
        columns = len(body.roles)
        counts: NDArray[np.float64] | None = None
        for rows in self.chunks:
            symbols = _core.qssd_symbols(rows, header, model, self.most, rounding, rest_rounding)
            kinds = _core.qssd_kinds(len(rows), header, columns, model)
            if counts is None:
                counts = np.zeros((_KINDS, symbols.shape[1], 2))
            for kind in range(_KINDS):
                own = symbols[np.minimum(kinds, _KINDS - 1) == kind]
                counts[kind, :, 0] += (own == 0).sum(axis=0)
                counts[kind, :, 1] += len(own)
        if counts is None:
            return b""
        chances = 256 * (counts[..., 0] + 0.4) / (counts[..., 1] + 0.8)
        return np.clip(np.floor(chances), 0, 255).astype(np.uint8).tobytes()


_STEPS = np.array([1.0, 0.0]).tobytes()


def _same(body: Body, other: Body) -> bool:
    return (body.roles, body.reversed, body.radians) == (
        other.roles,
        other.reversed,
        other.radians,
    )


def _pack(body: Body, dictionary: NDArray[np.float64], chances: bytes) -> bytes:
    writer = Writer()
    writer.data += body.pack()
    writer.integer(len(dictionary))
    for part in dictionary.astype(int).ravel().tolist():
        writer.signed(part)
    writer.bytes(chances)
    return bytes(writer.data)
