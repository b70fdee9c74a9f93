"""The codec ``patterns``: its parameters, and the coding of streams."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import ClassVar, NoReturn

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
from mocapress.codecs.markers import markers_of
from mocapress.codecs.patterns.clustering import LARGEST, MEAN
from mocapress.codecs.patterns.encoding import Job, unpack_facts
from mocapress.codecs.patterns.hierarchy import AUTOMATIC
from mocapress.codecs.patterns.segmentation import DISTANCE, PCA, RATIO
from mocapress.errors import ParameterError, UnsupportedError
from mocapress.motion import Clip, Column, Skeleton, Stream
from mocapress.motion.lengths import bones
from mocapress.motion.markers import POINTS, joints_as_points
from mocapress.motion.units import LENGTHS, centimetres_in, centimetres_per_unit

_MOST_FRAMES = 2**20
_AMOUNT = re.compile(r"(?=.*[1-9])(\d{1,9}(?:\.\d*)?|\.\d+)(mm|cm|m)?")


@dataclass(frozen=True, slots=True)
class Patterns(Codec):
    """Body parts as segments that follow patterns of a database.

    For markers (C3D, TRC) and joint positions; other columns are coded as they are. With the usual
    values errors are about 3 % of the head's diagonal (ADDH), 6 to 7 mm.
    """

    id: ClassVar[str] = "patterns"
    can: ClassVar[Capabilities] = Capabilities(
        lossless=False, trains=True, names=True, bounds=frozenset({Bound.LARGEST}), measured=True
    )

    arms: str = ""
    """Target of ARMS (Eq. 3), ``6.5mm`` or, in the unit of the file, ``6.5``: thresholds are scaled
    for it."""
    theta: float = 0.15
    """Threshold of segments, over ADDH; of ``rule=ratio`` a number."""
    cluster: float = 0.03
    """Threshold of clusters, over ADDH."""
    size: float = 0.0
    """What stands for ADDH; 1 makes thresholds lengths in the unit of the file. 0: measured."""
    rule: str = DISTANCE
    """Of segments: ``distance`` (section 5), ``ratio`` (Algorithm 1) or ``pca``."""
    metric: str = LARGEST
    """Of clusters: ``max`` (Eq. 2) or ``mean`` (Eq. 1)."""
    clusters: int = 10
    """Of a body part, at first."""
    steps: int = 1
    """Of clustering many clips: all segments at once, or (2) those of each clip and then the
    clusters."""
    mode: str = "extended"
    """``published``: as printed; ``extended``: segments' means apart, and axes of body parts."""
    hierarchy: str = AUTOMATIC
    """``auto``, ``vicon``, ``joints``, ``rigid``, or a file; see docs/guide/patterns.md."""
    weights: str = ""
    """Of markers, ``LTOE:10+RTOE:10``; those of more weight have smaller errors."""
    protect: str = ""
    """Markers that are coded apart, ``LTOE+RTOE``."""
    protect_error: float = 0.5
    """Largest error of their coordinates."""
    max_error: float = inf
    """Largest error of any value, in the unit of its column; kept by corrections."""
    smooth: int = 2
    """Frames on either side of a segment's beginning that the spline filter takes, up to 8, where
    that makes ARMS smaller."""
    chunk: int = 2048
    """Frames that are decoded together."""

    def __post_init__(self) -> None:
        self._as_text()
        if self.arms and not _AMOUNT.fullmatch(self.arms):
            self._refuse("arms", "a length above 0, such as 6.5mm")
        for name, known in (
            ("rule", (DISTANCE, RATIO, PCA)),
            ("metric", (LARGEST, MEAN)),
            ("mode", ("extended", "published")),
        ):
            if getattr(self, name) not in known:
                self._refuse(name, " or ".join(known))
        for name, low, high in (
            ("theta", 1e-6, 1e6),
            ("cluster", 1e-6, 1e6),
            ("size", 0.0, 1e9),
            ("protect_error", 1e-6, 1e9),
        ):
            value = getattr(self, name)
            if not (isfinite(value) and low <= value <= high):
                self._refuse(name, f"{low:g} to {high:g}")
        for name, least, most in (
            ("clusters", 1, 4096),
            ("steps", 1, 2),
            ("smooth", 0, 8),
            ("chunk", 1, _MOST_FRAMES),
        ):
            number = getattr(self, name)
            if not isinstance(number, int) or not least <= number <= most:
                self._refuse(name, f"{least} to {most}")
        if not self.max_error >= 0:
            self._refuse("max_error", "0 or more")
        self.marker_weights()

    def _as_text(self) -> None:
        """Turn numbers, lists and mappings into the text that a file keeps."""
        if isinstance(self.arms, int | float):
            object.__setattr__(self, "arms", f"{self.arms:g}")
        for name in ("weights", "protect"):
            given = getattr(self, name)
            if isinstance(given, dict):
                object.__setattr__(self, name, "+".join(f"{k}:{v:g}" for k, v in given.items()))
            elif not isinstance(given, str):
                object.__setattr__(self, name, "+".join(given))

    def target(self, unit: str) -> float:
        """Give the target of ARMS in a unit; 0 where there is none.

        Raises
        ------
        ParameterError
            When the target has a unit, and the one of the file is not known.

        """
        found = _AMOUNT.fullmatch(self.arms)
        if found is None:
            return 0.0
        number, own = float(found[1]), found[2]
        if not own:
            return number
        centimetres = centimetres_in(unit)
        if centimetres is None:
            self._refuse("arms", "a number without a unit, as the file does not say its own")
        return number * LENGTHS[own] / centimetres

    def marker_weights(self) -> dict[str, float]:
        """Give the weights that are not 1, by the names of markers."""
        found = {}
        for item in filter(None, self.weights.split("+")):
            name, _, weight = item.rpartition(":")
            try:
                found[name] = float(weight)
            except ValueError:
                self._refuse("weights", "NAME:NUMBER+NAME:NUMBER")
            if not (name and 1e-3 <= found[name] <= 1e3):
                self._refuse("weights", "names, and numbers from 0.001 to 1000")
        return found

    def prepared(self, clip: Clip) -> Clip:
        """Give the positions of a skeleton's joints as markers, in mm where its unit is known.

        Clips of markers, and such whose joints have no positions, stay as they are.
        """
        if POINTS in clip.streams or clip.skeleton is None or not clip.frames:
            return clip
        unit = centimetres_per_unit(clip.skeleton)
        told = ("mm", 10 * unit) if unit else ("", 1.0)
        try:
            points = joints_as_points(clip, told[1], told[0])
        except UnsupportedError:
            return clip
        return replace(clip, streams={POINTS: points}, skeleton=None)

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        """Code a stream; ``(F, C)`` values, any float64; NaN and infinities stay as they are."""
        job = Job.of(self, stream, skeleton)
        return job.encoded(model.payload if model is not None and job.fits(model) else b"")

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
            _core.patterns_decode(payload, rows, header, learned)

        return decoded_into("patterns chunk", chunks, len(columns), self.chunk, decode)[:stop]

    def largest_errors(self, columns: Sequence[Column]) -> list[float]:
        """Give the error up to which each column may come back; infinite where none was asked."""
        markers, protected = markers_of(columns), self.protect.split("+")
        found = [self.max_error] * len(columns)
        for name, first in zip(markers.names, markers.first, strict=True):
            if name in protected:
                found[first : first + 3] = [min(self.max_error, self.protect_error)] * 3
        return found

    def measure(self, clip: Clip, encoded: Encoded, raw_bytes: int) -> dict[str, float]:
        """Give the ARMS that the encoder found, where the bytes are, and how far bones move.

        Bytes are those of the pattern database, of root and protected markers, of segments'
        lengths, patterns (``index``) and places, and of corrections; they are not told of a file
        with a model. ``bone_spread`` is the mean of the standard
        deviations of lengths that should be constant (``mp.bones``), in the unit of the markers.
        """
        facts, learned = unpack_facts(encoded.header)
        if not learned:
            bits = np.zeros(5)
            for chunk in encoded.chunks:
                bits += _core.patterns_bits(
                    chunk.payload, chunk.frames, clip.channels, encoded.header, b""
                )
            names = ("root", "length", "index", "place", "correction")
            facts |= {f"{name}_bytes": float(b) / 8 for name, b in zip(names, bits, strict=True)}
        tied = bones(clip) if POINTS in clip.streams and clip.frames else ()
        if tied:
            facts["bone_spread"] = float(np.mean([bone.spread for bone in tied]))
        return facts

    def train(self, streams: Iterable[Stream]) -> Model:
        """Learn a database of patterns from streams without skeletons."""
        return self.learn(Clip({"motion": stream}) for stream in streams)

    def learn(self, clips: Iterable[Clip]) -> Model:
        """Learn a database from clips with the markers of the first; others are left out."""
        job: Job | None = None
        seen: list[list[NDArray[np.float64]]] = []
        for clip in map(self.prepared, clips):
            own = Job.of(self, clip.main, clip.skeleton, alone=True)
            job = job or own
            if own.tag == job.tag:
                seen.append(own.chunks)
        if job is None:
            raise ParameterError("nothing to learn from", expected="at least one clip")
        return Model(self.id, job.model(seen))

    def _refuse(self, name: str, expected: str) -> NoReturn:
        found = repr(getattr(self, name))
        raise ParameterError(f"patterns:{name}", expected=expected, found=found)
