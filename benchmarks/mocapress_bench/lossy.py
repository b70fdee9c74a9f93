"""Lossy codecs at several errors: bytes beside what the joints of a figure are off by.

Errors are those of ``near``: of a joint in a frame, how far it is off, or one of three points 3 cm
along its axes, in space. ACL states those of the points alone. Bytes are those of the motion alone,
without skeleton, names and layout: of codecs header and payloads, of gltfpack the buffers that its
animation reads.
"""

import json
import struct
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core, codecs
from mocapress.codecs.near.figure import RADIUS, figure_of
from mocapress.codecs.near.goal import Goal, Measure
from mocapress.motion import Clip
from mocapress.motion.figure import centimetres
from mocapress.motion.kinematics import positions, rotations
from mocapress.motion.units import figure_size

Array = NDArray[np.float64]
Errors = NDArray[np.floating[Any]]

_PLAYER = Path(__file__).with_name("lossy_gltfpack.mjs")
_BLOCK = 64
"""Frames of the plain DCT."""


class Point(NamedTuple):
    """A contender at a setting, on a clip."""

    contender: str
    setting: str
    clip: str
    samples: int
    """Frames times joints."""
    size: int
    mean: float
    """Errors, in cm."""
    most: float

    @property
    def bits(self) -> float:
        """Bits a joint sample."""
        return 8 * self.size / self.samples


class Task(NamedTuple):
    """A clip to be coded."""

    clip: Clip
    unit: float
    """Centimetres."""
    measure: Measure

    def errors(self, values: Array) -> Array:
        """Give the errors of decoded values, (F, J) in cm."""
        found: Array = _core.near_errors(self.measure.core, self.clip.values, values)
        return found * self.unit


Coded = Iterator[tuple[str, int, Errors]]
"""Of each setting: its name, bytes, and errors of all frames and joints."""


def task_of(clip: Clip) -> Task:
    """Prepare a clip with a skeleton of known units."""
    unit = centimetres(clip)
    if unit is None or clip.skeleton is None:
        raise mp.UnsupportedError("a clip whose units of length are not known")
    goal = Goal(True, inf, inf, RADIUS / unit, figure_size(clip.skeleton))
    figure = figure_of(clip.skeleton, clip.columns, clip.values)
    return Task(clip, unit, Measure(goal, figure, clip.columns))


def of_codec(*specs: str) -> Callable[[Task], Coded]:
    """Give a contender that is one of our codecs, with these parameters."""

    def run(task: Task) -> Coded:
        for spec in specs:
            codec = codecs.codec(spec)
            made = codec.encode(task.clip.main, skeleton=task.clip.skeleton)
            values = codec.decode(made.header, made.chunks, task.clip.columns)
            size = len(made.header) + sum(len(chunk.payload) for chunk in made.chunks)
            yield spec.partition(":")[2], size, task.errors(values)

    return run


def zfp(task: Task) -> Coded:
    """Code the matrix of channels by zfp, within a tolerance."""
    import zfpy

    for tolerance in (1.0, 0.25, 0.05, 0.01):
        packed = zfpy.compress_numpy(np.ascontiguousarray(task.clip.values), tolerance=tolerance)
        yield f"tolerance={tolerance:g}", len(packed), task.errors(zfpy.decompress_numpy(packed))


def dct(task: Task) -> Coded:
    """Code blocks of 64 frames of each channel by DCT, one step for all, differences by range."""
    from scipy.fft import dct as forward
    from scipy.fft import idct

    values = task.clip.values
    filled = np.pad(values, ((0, -len(values) % _BLOCK), (0, 0)), mode="edge")
    blocks = filled.reshape(-1, _BLOCK, values.shape[1])
    found = forward(blocks, axis=1, norm="ortho")
    for step in (4.0, 1.0, 0.3, 0.1, 0.03):
        levels = np.rint(found / step).astype(np.int64)
        # Of the first coefficient the difference to the block before.
        told = levels.copy()
        told[1:, 0] -= levels[:-1, 0]
        packed = sum(
            len(_core.encode_differences(np.ascontiguousarray(told[:, k]).ravel()))
            for k in range(_BLOCK)
        )
        decoded = idct(levels * step, axis=1, norm="ortho").reshape(filled.shape)[: len(values)]
        yield f"step={step:g}", packed, task.errors(decoded)


def gltfpack(tool: Path) -> Callable[[Task], Coded]:
    """Give gltfpack as a contender: the command of its package, beside which lies three.js."""

    def run(task: Task) -> Coded:
        # At its default of 30 Hz, at the highest rate that it takes, and with the keys as they are.
        settings: list[list[str]] = [[], ["-af", "100"]]
        settings += [["-af", "0", "-ar", bits] for bits in ("8", "12", "16")]
        with tempfile.TemporaryDirectory() as name:
            source, target = Path(name) / "in.glb", Path(name) / "out.glb"
            mp.write(task.clip, source, to=f"glb:unit={task.unit!r}cm")
            for more in settings:
                _run(["node", tool, "-i", source, "-o", target, "-cc", "-kn", *more])
                places, turns = _played(target, tool, task)
                size = _animation_bytes(target.read_bytes())
                yield " ".join(more) or "default", size, _apart(places, turns, task)

    return run


def _run(command: list[object], given: bytes = b"") -> bytes:
    words = [str(word) for word in command]
    return subprocess.run(words, input=given, check=True, capture_output=True).stdout  # noqa: S603


def _played(glb: Path, tool: Path, task: Task) -> tuple[Array, Array]:
    """Give positions and rotations as three.js plays them: (F, J, 3) in m, (F, J, 4)."""
    assert task.clip.skeleton is not None
    modules = tool.parents[1]
    asked = {"frames": task.clip.frames, "step": float(task.clip.frame_time or 0)}
    request = json.dumps({**asked, "names": task.clip.skeleton.names})
    told = _run(["node", _PLAYER, glb, modules], request.encode())
    numbers = np.frombuffer(told, "<f8").reshape(task.clip.frames, -1, 7)
    return numbers[..., :3], numbers[..., 3:]


def _apart(places: Array, turns: Array, task: Task) -> Array:
    """Give the errors of poses, as ``Task.errors`` does."""
    from scipy.spatial.transform import Rotation

    ours = rotations(task.clip, form="matrix")
    theirs = Rotation.from_quat(turns.reshape(-1, 4)).as_matrix().reshape(ours.shape)
    moved = places * 100 - positions(task.clip) * task.unit
    points = (theirs - ours) * RADIUS + moved[..., None]
    lengths = np.linalg.norm(np.concatenate([points, moved[..., None]], axis=3), axis=2)
    found: Array = lengths.max(axis=2)
    return found


def _animation_bytes(glb: bytes) -> int:
    """Count the bytes of the buffers that the animation reads."""
    length = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20 : 20 + length])
    samplers = [sampler for made in document["animations"] for sampler in made["samplers"]]
    accessors = {sampler[key] for sampler in samplers for key in ("input", "output")}
    views = {document["accessors"][accessor]["bufferView"] for accessor in accessors}
    size = 0
    for view in (document["bufferViews"][index] for index in views):
        packed = view.get("extensions", {}).get("EXT_meshopt_compression", view)
        size += packed["byteLength"]
    return size


def contenders(tool: Path | None) -> dict[str, Callable[[Task], Coded]]:
    """Give all of them by name; gltfpack only where it is there."""
    found: dict[str, Callable[[Task], Coded]] = {
        "near": of_codec(*(f"near:p={p}cm" for p in ("1", "0.3", "0.1", "0.05", "0.01"))),
        "diffma": of_codec(*(f"diffma:max_error={e},per=channel" for e in (4.0, 1.0, 0.25, 0.05))),
        "qssd": of_codec("qssd:omit=3", "qssd:omit=2,step=0.2", "qssd:omit=0,step=0.1"),
        "patterns": of_codec(*(f"patterns:cluster={e}" for e in (3.0, 0.6, 0.15, 0.03))),
        "zfp": zfp,
        "DCT": dct,
    }
    return found if tool is None else {**found, "gltfpack": gltfpack(tool)}


def measured(clip: Clip, name: str, chosen: dict[str, Callable[[Task], Coded]]) -> Iterator[Point]:
    """Measure a clip."""
    assert clip.skeleton is not None
    task = task_of(clip)
    samples = clip.frames * len(clip.skeleton.joints)
    for contender, run in chosen.items():
        for setting, size, errors in run(task):
            mean, most = float(errors.mean()), float(errors.max())
            yield Point(contender, setting, name, samples, size, mean, most)


def together(points: list[Point]) -> list[Point]:
    """Give each contender at each setting over all clips, in the order of the points."""
    grouped: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        grouped.setdefault((point.contender, point.setting), []).append(point)
    found = []
    for (contender, setting), own in grouped.items():
        samples = sum(point.samples for point in own)
        mean = sum(point.mean * point.samples for point in own) / samples
        size, most = sum(point.size for point in own), max(point.most for point in own)
        found.append(Point(contender, setting, "all", samples, size, mean, most))
    return found


def acl(table: Path, clips: set[str]) -> list[Point]:
    """Give what ACL made of clips, of a table of its measurements (``near_acl.tsv``)."""
    found = []
    for line in table.read_text().splitlines():
        cells = line.split("\t")
        if cells[0] in clips:
            samples = int(cells[1]) * int(cells[2])
            setting, size = f"p={cells[3]}cm", int(cells[4])
            errors = float(cells[6]), float(cells[7])
            found.append(Point("ACL", setting, cells[0], samples, size, *errors))
    return found


CURVECODEC = {0.01: 0.37, 0.05: 0.27, 0.1: 0.22, 0.3: 0.14, 1.0: 0.07}
"""Bytes of CurveCodec 2 (2026) in those of ACL at ACL's mean error, as its authors state for their
own clips, by ACL's precision. Its largest error is not bounded and not stated."""


def curvecodec(of_acl: list[Point]) -> list[Point]:
    """Give points of CurveCodec beside those of ACL, as its authors state the share."""
    return [
        Point("CurveCodec 2, as stated", point.setting, point.clip, point.samples,
              round(point.size * share), point.mean, float("nan"))
        for point in of_acl
        for precision, share in CURVECODEC.items()
        if point.setting == f"p={precision:g}cm"
    ]  # fmt: skip
