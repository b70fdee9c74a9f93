"""From a stream to header and chunks."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.contract import Chunk, Encoded, Model
from mocapress.codecs.markers import Markers, markers_of
from mocapress.codecs.patterns.body import Body, body_of, copies_of, filled_of
from mocapress.codecs.patterns.database import Node, Rules, database_of, node_of, segments_of
from mocapress.codecs.patterns.hierarchy import head_diagonal, hierarchy_of
from mocapress.codecs.patterns.segmentation import RATIO
from mocapress.errors import CorruptError
from mocapress.motion import Skeleton, Stream
from mocapress.records import Reader, Writer

if TYPE_CHECKING:
    from mocapress.codecs.patterns.codec import Patterns

Array = NDArray[np.float64]
_PATCH = 1.9
"""Steps of corrections over the largest error: a little less than twice."""
_PROTECTED = 2.0
"""Steps of protected tracks over their largest error; what is beyond it is corrected."""
_USUAL_ARMS = 0.0325
"""About the ARMS over ADDH that the usual thresholds give."""
_TRIES = 6
_CLOSE, _AIM = 0.97, 0.985
"""Of a target ARMS: what is near enough, and what is tried next."""
_LEAST_SCALE = 1e-6
"""Of thresholds: what is not reached then is not reached."""


@dataclass(frozen=True, slots=True)
class _Cut:
    """A stream in segments, at some scale of the thresholds."""

    rules: Rules
    database: bytes
    """Of the stream's own patterns; nothing where a model has them."""
    projections: Array
    """Of all nodes, one behind the other."""
    segments: list[NDArray[np.int64]]
    """Of each chunk."""


@dataclass(slots=True)
class Job:
    """A stream, and how it is to be coded."""

    codec: "Patterns"
    values: Array
    filled: Array
    kept: NDArray[np.uint8]
    markers: Markers
    body: Body
    size: float
    """ADDH, or what stands for it."""
    target: float
    """Of ARMS; 0: none."""
    smooth: int = 0
    """Frames around boundaries that are smoothed."""

    @classmethod
    def of(
        cls, codec: "Patterns", stream: Stream, skeleton: Skeleton | None, *, alone: bool = False
    ) -> Self:
        """Find hierarchy and size of a stream; ``alone`` is without copies, for other clips."""
        markers = markers_of(stream.columns)
        filled, kept = filled_of(markers, stream.values)
        places = markers.places(filled)
        hierarchy = hierarchy_of(markers, places, codec.hierarchy, skeleton)
        copies = {} if alone else copies_of(markers, stream.values, hierarchy.root)
        body = body_of(
            markers,
            hierarchy,
            stream.channels,
            protect=list(filter(None, codec.protect.split("+"))),
            weights=codec.marker_weights(),
            copies=copies,
        )
        size = codec.size or head_diagonal(markers, places, hierarchy)
        units = {stream.columns[c].unit for c in markers.columns}
        target = codec.target(units.pop() if len(units) == 1 else "")
        return cls(codec, stream.values, filled, kept, markers, body, size, target)

    @property
    def chunks(self) -> list[Array]:
        """The rows of each chunk, finite."""
        step = self.codec.chunk
        return [self.filled[first : first + step] for first in range(0, len(self.filled), step)]

    @property
    def tag(self) -> bytes:
        """What models are known by: a digest of the names of markers, and how many columns."""
        told = f"{self.columns} {self.codec.mode} {self.codec.protect} " + "\n".join(
            self.markers.names
        )
        return hashlib.sha256(told.encode()).digest()[:8]

    def rules(self, scale: float = 1.0) -> Rules:
        """Give the thresholds, in the unit of the columns."""
        codec, size = self.codec, self.size
        by_ratio = codec.rule == RATIO
        return Rules(
            theta=codec.theta if by_ratio else codec.theta * size * scale,
            cluster=codec.cluster * size * scale,
            rule=codec.rule,
            metric=codec.metric,
            clusters=codec.clusters,
            steps=codec.steps,
            apart=codec.mode != "published",
            published=codec.mode == "published",
        )

    def model(self, clips: Sequence[Sequence[Array]]) -> bytes:
        """Learn a model's payload from chunks of this stream and of others like it."""
        scale = self.target / (_USUAL_ARMS * self.size) if self.target else 1.0
        writer = Writer()
        writer.bytes(self.tag)
        return bytes(writer.data) + database_of(self.body, clips, self.rules(scale))

    def fits(self, model: Model) -> bool:
        """Say whether a model was learned from such markers; the body is then the model's.

        Raises
        ------
        CorruptError
            When the model's payload is not what ``model`` makes.

        """
        reader = Reader(model.payload, "patterns model")
        if reader.bytes() != self.tag:
            return False
        self.body = Body.unpack(reader, self.markers)
        try:
            _core.patterns_nodes(self._header(self.rules(), True, 0.0), model.payload, self.columns)
        except ValueError as error:
            raise CorruptError(f"patterns model: {error}") from error
        return True

    def encoded(self, model: bytes = b"") -> Encoded:
        """Code the stream; with thresholds for the target ARMS, where there is one."""
        target = self.target
        scale = target / (_USUAL_ARMS * self.size) if target else 1.0
        cut = self._cut(scale, model)
        made, arms = self._coded(cut, model)
        if self.codec.smooth:
            # Of fast motion in short segments, the filter takes more than it mends.
            self.smooth = self.codec.smooth
            smoothed = self._coded(cut, model)
            if smoothed[1] < arms:
                made, arms = smoothed
            else:
                self.smooth = 0
        return self._reached(target, scale, made, arms, model) if target else made

    def _reached(
        self, target: float, scale: float, made: Encoded, arms: float, model: bytes
    ) -> Encoded:
        """Go on from thresholds and the ARMS that they give to those that give the target."""
        low, high = 0.0, inf
        best: Encoded | None = None
        for _ in range(_TRIES):
            if arms <= target:
                low, best = scale, made
                if arms >= _CLOSE * target:
                    break
            else:
                high = scale
            guess = scale * min(max(_AIM * target / max(arms, 1e-9), 0.25), 4.0)
            if not low < guess < high:
                guess = (low + high) / 2 if high < inf else 2 * low
            scale = guess
            made, arms = self._coded(self._cut(scale, model), model)
        if best is None and arms <= target:
            best = made
        while best is None:
            scale = min(scale, high) / 2
            made, arms = self._coded(self._cut(scale, model), model)
            if arms <= target or scale < _LEAST_SCALE:
                best = made
        return best

    @property
    def columns(self) -> int:
        """How many there are."""
        return int(self.values.shape[1])

    def _cut(self, scale: float, model: bytes) -> "_Cut":
        """Learn the stream's own patterns where no model has them, and cut it into segments."""
        rules = self.rules(scale)
        own = b"" if model else database_of(self.body, [self.chunks], rules)
        nodes = self._nodes(self._header(rules, bool(model), 0.0) + own, model, rules)
        projections = np.concatenate([np.empty(0), *(n.projection.ravel() for n, _ in nodes)])
        segments = [segments_of(nodes, rows, rules) for rows in self.chunks]
        return _Cut(rules, own, projections, segments)

    def _coded(self, cut: "_Cut", model: bytes) -> tuple[Encoded, float]:
        """Code segments; and give ARMS."""
        header = self._header(cut.rules, bool(model), 0.0) + cut.database
        codec = self.codec
        chunks, total, first = [], 0.0, 0
        for rows, segments in zip(self.chunks, cut.segments, strict=True):
            part = slice(first, first + len(rows))
            coded = _core.patterns_encode(
                np.ascontiguousarray(self.values[part]),
                np.ascontiguousarray(rows),
                np.ascontiguousarray(self.kept[part]),
                header,
                model,
                segments,
                cut.projections,
                codec.max_error,
                min(codec.protect_error, codec.max_error),
            )
            chunks.append(Chunk(first, len(rows), coded))
            decoded = np.empty(rows.shape)
            _core.patterns_decode(coded, decoded, header, model)
            total += float(self._errors(part, decoded).sum())
            first += len(rows)
        arms = total / max(len(self.values), 1)
        named = self._header(cut.rules, bool(model), arms) + cut.database
        return Encoded(named, tuple(chunks)), arms

    def _nodes(self, header: bytes, model: bytes, rules: Rules) -> list[tuple[Node, Array]]:
        told = _core.patterns_nodes(header, model, self.columns)
        return [
            (
                node_of(
                    group,
                    frames,
                    basis.reshape(count, -1) if count else np.empty((0, len(group.columns))),
                    centre,
                    importance,
                    published=rules.published,
                ),
                _core.patterns_shapes(header, model, self.columns, n),
            )
            for n, (group, (frames, count, importance, basis, centre)) in enumerate(
                zip(self.body.groups, told, strict=True)
            )
        ]

    def _errors(self, part: slice, decoded: Array) -> Array:
        """Give Eq. 3's term of each frame: of markers that are there, or else of all columns."""
        if not self.markers.first:
            moved = np.where(self.kept[part], 0.0, decoded - self.filled[part])
            found: Array = (
                np.sqrt((moved * moved).mean(axis=1)) if moved.size else np.zeros(len(moved))
            )
            return found
        columns = np.array(self.markers.columns, dtype=np.intp)
        away = np.where(self.kept[part][:, columns], 0.0, (decoded - self.filled[part])[:, columns])
        squares = (away * away).reshape(len(away), -1, 3).sum(axis=2)
        in_space: Array = np.sqrt(squares.mean(axis=1))
        return in_space

    def _header(self, rules: Rules, learned: bool, arms: float) -> bytes:
        codec = self.codec
        most = codec.max_error
        protected = min(codec.protect_error, most)
        writer = Writer()
        writer.integer(learned)
        writer.double(arms)
        writer.double(rules.place_step)
        writer.double(rules.track_step)
        writer.double(max(_PROTECTED * codec.protect_error, 1e-9))
        writer.double(_PATCH * most if 0 < most < 1e11 else 0.0)
        writer.double(_PATCH * protected if protected > 0 else 0.0)
        writer.integer(self.smooth)
        return bytes(writer.data)


def unpack_facts(header: bytes) -> tuple[dict[str, float], bool]:
    """Give ARMS and the bytes of the pattern database, and whether a model has that."""
    reader = Reader(header, "patterns header")
    learned = bool(reader.integer(1))
    return {"arms": reader.double(), "database_bytes": float(reader.left)}, learned
