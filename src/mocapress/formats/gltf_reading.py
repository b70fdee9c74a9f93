"""Motion out of glTF 2.0: joints of the first skin, or what moves, at the frames of its keys."""

import re
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats.contract import Split
from mocapress.formats.gltf_file import Gltf, Node, walk
from mocapress.formats.key_reduction import slerp
from mocapress.formats.layout import NO_ROWS
from mocapress.formats.problems import Problem
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.convert import zyx_degrees
from mocapress.motion.frame_time import FrameTime
from mocapress.motion.skeleton import Vec3
from mocapress.motion.units import CENTIMETRES_PER_INCH

Array = NDArray[np.float64]

_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
_RATES = (24, 25, 30, 48, 50, 60, 90, 100, 120, 240)
_NEAR = 0.02
"""Of a frame: how far keys may lie beside it."""
_LEAST_LIMIT, _LIMIT_OF_BYTES = 2**20, 2**12
"""How many numbers a clip may have: what is allocated is bounded by the file, not by its times."""
_SAID = re.compile(r"(\d{1,20})(\.\d{1,30}|/[1-9]\d{0,19})?")
_METRE = CENTIMETRES_PER_INCH / 100


class Track(NamedTuple):
    """How a node moves in one way."""

    times: Array
    """Seconds."""
    values: Array
    """(K, width), or (3 K, width) with the tangents of a cubic spline."""
    way: str

    def at(self, times: Array) -> Array:
        """Give the values at times."""
        count = len(self.times)
        behind = np.clip(np.searchsorted(self.times, times, side="right"), 1, max(count - 1, 1))
        before = behind - 1
        behind = np.minimum(behind, count - 1)
        gap = self.times[behind] - self.times[before]
        part = np.clip((times - self.times[before]) / np.where(gap > 0, gap, 1.0), 0.0, 1.0)
        part = part[:, None]
        if self.way == "STEP":
            return self.values[np.where(part[:, 0] < 1, before, behind)]
        if self.way == "CUBICSPLINE":
            first, middle, last = (self.values[i::3] for i in range(3))
            wide = gap[:, None]
            square, cube = part**2, part**3
            spline: Array = (
                (2 * cube - 3 * square + 1) * middle[before]
                + (cube - 2 * square + part) * last[before] * wide
                + (3 * square - 2 * cube) * middle[behind]
                + (cube - square) * first[behind] * wide
            )
            return spline
        a, b = self.values[before], self.values[behind]
        if a.shape[1] == _WIDTHS["rotation"]:
            return slerp(a, b, part)
        mixed: Array = a + (b - a) * part
        return mixed


Tracks = dict[tuple[int, str], Track]


def read(data: bytes, _skeleton: Skeleton | None = None, file: str | None = None) -> Split:
    """Read the first animation of a file; a model without one is a clip of one frame at rest.

    Raises
    ------
    FormatError
        When the file does not follow the format, or keeps its numbers in other files.
    UnsupportedError
        When bones change their size, or it would have too many frames.

    """
    problems: list[Problem] = []
    try:
        most = _LEAST_LIMIT + _LIMIT_OF_BYTES * len(data)
        clip = _clip(Gltf(data), Path(file).stem if file else "", problems, most)
    except (FormatError, UnsupportedError) as error:
        error.file = error.file or file
        raise
    return Split(clip, NO_ROWS, tuple(problems))


def _clip(gltf: Gltf, name: str, problems: list[Problem], most: int) -> Clip:
    nodes = gltf.document.items("nodes")
    animations = gltf.document.items("animations")
    tracks = _tracks(gltf, animations[0], len(nodes)) if animations else {}
    if len(animations) > 1:
        problems.append(
            Problem.of(
                "more-animations",
                "several animations; the first is read",
                expected="1",
                found=str(len(animations)),
            )
        )
    order = _joints(gltf, nodes, {node for node, _ in tracks})
    animation = animations[0] if animations else None
    frame_time, times = _frames(tracks, animation, problems, most // (6 * len(order)))
    values, joints = _sampled(nodes, order, tracks, times)
    skeleton = Skeleton(joints, "moving", "deg", _METRE)
    columns = skeleton_columns(skeleton)
    matrix = np.concatenate(values, axis=1)
    return Clip.of(matrix, columns, frame_time, skeleton, name)


def _tracks(gltf: Gltf, animation: Node, nodes: int) -> Tracks:
    samplers = animation.items("samplers")
    found: Tracks = {}
    for channel in animation.items("channels"):
        target = channel.item("target")
        path = target.text("path")
        if "node" not in target.facts or path not in _WIDTHS:
            continue  # weights of shapes, and what extensions move
        sampler = samplers[channel.whole("sampler", len(samplers))]
        times = gltf.array(sampler, "input", 1)[:, 0]
        values = gltf.array(sampler, "output", _WIDTHS[path])
        way = sampler.text("interpolation", "LINEAR")
        if way not in ("LINEAR", "STEP", "CUBICSPLINE"):
            raise sampler.fault("interpolation", "LINEAR, STEP or CUBICSPLINE", way)
        each = 3 if way == "CUBICSPLINE" else 1
        if len(values) != each * len(times) or times[0] < 0 or (np.diff(times) <= 0).any():
            raise sampler.fault("input", "rising times, one for each value", f"{len(times)} times")
        if path == "rotation":
            keys = values[1::3] if each == 3 else values
            if (np.linalg.norm(keys, axis=1) < 0.5).any():
                raise sampler.fault("output", "unit quaternions", "others")
        found[target.whole("node", nodes), path] = Track(times, values, way)
    return found


def _joints(gltf: Gltf, nodes: list[Node], moved: set[int]) -> list[tuple[int, int]]:
    """Give nodes that are joints and the place of each one's parent among them, -1 for roots."""
    children = [node.wholes("children", len(nodes)) for node in nodes]
    below = {child for own in children for child in own}
    ordered = [*walk(children, [node for node in range(len(nodes)) if node not in below])]
    skins = gltf.document.items("skins")
    joints = set(skins[0].wholes("joints", len(nodes))) if skins else set()
    wanted = joints | moved
    parents = dict(ordered)
    for node, _ in reversed(ordered):
        # What only leads to joints counts where it turns or moves them.
        leads = any(child in wanted for child in children[node])
        if leads and node not in wanted and (parents[node] in wanted or not _is_plain(nodes[node])):
            wanted.add(node)
    if not wanted:
        raise FormatError("no joints in the file", expected="a skin or an animation of nodes")
    places: dict[int, int] = {}
    found: list[tuple[int, int]] = []
    for node, parent in ordered:
        if node in wanted:
            above = parent
            while above >= 0 and above not in places:
                above = parents[above]
            places[node] = len(found)
            found.append((node, places.get(above, -1)))
    return found


def _is_plain(node: Node) -> bool:
    return not {"matrix", "translation", "rotation", "scale"} & set(node.facts)


def _frames(
    tracks: Tracks, animation: Node | None, problems: list[Problem], most: int
) -> tuple[FrameTime, Array]:
    """Give the frame time, and the times of the frames."""
    if not tracks or animation is None:
        return None, np.zeros(1)
    keys = np.unique(np.concatenate([track.times for track in tracks.values()]))
    end = float(keys[-1])
    said = animation.item("extras").facts.get("frame_time")
    step = _said(said) if isinstance(said, str) else None
    if step is None:
        step = next((Fraction(1, rate) for rate in _RATES if _fits(keys, rate)), None)
    if step is None:
        gap = end / (len(keys) - 1) if len(keys) > 1 else 1.0
        if np.abs(keys - np.arange(len(keys)) * gap).max() <= _NEAR * gap:
            step = 1 / Fraction(str(round(1 / gap, 3) or 1.0))
        else:
            step = Fraction(1, _RATES[-1])
            what = f"keys at no usual rate; sampled {_RATES[-1]} times a second"
            problems.append(Problem.of("resampled", what))
    count = end / float(step) + 1
    if count > most:
        raise UnsupportedError(
            "an animation of so many frames", expected=f"at most {most}", found=f"{count:.6g}"
        )
    frames = round(count)
    return step, np.arange(frames) * np.float64(step)


def _said(text: str) -> FrameTime:
    if not _SAID.fullmatch(text):
        return None
    time = Fraction(text) if "/" in text else Decimal(text)
    return time if time > 0 else None


def _fits(keys: Array, rate: int) -> bool:
    frames = keys * rate
    return bool(np.abs(frames - np.rint(frames)).max() <= _NEAR)


def _sampled(
    nodes: list[Node], order: list[tuple[int, int]], tracks: Tracks, times: Array
) -> tuple[list[Array], tuple[Joint, ...]]:
    """Give the channels of all joints, and the joints."""
    scales: list[float] = []
    values: list[Array] = []
    joints: list[Joint] = []
    for node, parent in order:
        place, turn, scale = _rest(nodes[node])
        above = scales[parent] if parent >= 0 else 1.0
        moving = tracks.get((node, "scale"))
        if moving is not None:
            scale = _one_scale(nodes[node], moving.values)
        scales.append(above * scale)
        turning, placing = tracks.get((node, "rotation")), tracks.get((node, "translation"))
        turns = turning.at(times) if turning else np.tile(turn, (len(times), 1))
        placed = (placing.at(times) if placing else np.tile(place, (len(times), 1))) * above
        turns = turns / np.linalg.norm(turns, axis=1, keepdims=True)
        angles = zyx_degrees(np.roll(turns, 1, axis=1))
        moves = parent < 0 or bool(np.ptp(placed, axis=0).any())
        if placing and not moves:
            place = placed[0] / above
        values.append(np.hstack([placed, angles]) if moves else angles)
        joints.append(
            Joint(
                nodes[node].text("name") or f"node{node}",
                parent,
                _vector(place * above) if parent >= 0 else (0.0, 0.0, 0.0),
                (("tx", "ty", "tz") if moves else ()) + ("rz", "ry", "rx"),
                ends=_ends(nodes[node], scales[-1]),
            )
        )
    return values, tuple(joints)


def _vector(numbers: Array) -> Vec3:
    x, y, z = numbers.tolist()
    return x, y, z


def _ends(node: Node, scale: float) -> tuple[Vec3, ...]:
    """Give the ends of bones without further joints, as ``mocapress`` adds them."""
    found = node.facts.get("extras")
    listed = found.get("ends") if isinstance(found, dict) else None
    if not isinstance(listed, list):
        return ()
    own = Node(f"{node.place}.extras.ends", {str(i): end for i, end in enumerate(listed)})
    return tuple(_vector(own.numbers(i, (0.0, 0.0, 0.0)) * scale) for i in own.facts)


def _rest(node: Node) -> tuple[Array, Array, float]:
    """Give translation, rotation as a unit quaternion with the scalar last, and scale."""
    if "matrix" in node.facts:
        matrix = node.numbers("matrix", tuple(np.eye(4).ravel().tolist())).reshape(4, 4).T
        sizes = np.linalg.norm(matrix[:3, :3], axis=0)
        scale = _one_scale(node, sizes[None])
        from scipy.spatial.transform import Rotation

        turned = matrix[:3, :3] / scale
        if np.linalg.det(turned) < 0.5:
            raise node.fault("matrix", "a rotation with one scale above 0", "another")
        return matrix[:3, 3], Rotation.from_matrix(turned).as_quat(), scale
    turn = node.numbers("rotation", (0.0, 0.0, 0.0, 1.0))
    if np.linalg.norm(turn) < 0.5:
        raise node.fault("rotation", "a unit quaternion", turn.tolist())
    scale = _one_scale(node, node.numbers("scale", (1.0, 1.0, 1.0))[None])
    return node.numbers("translation", (0.0, 0.0, 0.0)), turn / np.linalg.norm(turn), scale


def _one_scale(node: Node, scales: Array) -> float:
    """Give the one scale of a node at all times and along all axes."""
    low, high = float(scales.min()), float(scales.max())
    if not 0 < low <= high <= low * 1.001:
        raise UnsupportedError(
            f"{node.place} changes its size or shape",
            expected="one scale above 0",
            found=f"{low:.6g} to {high:.6g}",
        )
    return (low + high) / 2
