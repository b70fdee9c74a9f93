"""Clips written as glTF 2.0 in one file: joints with a skin, a figure of bones, and keys."""

from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.formats.gltf_file import GlbWriter
from mocapress.formats.key_reduction import Keys, Motion, reduced
from mocapress.motion import Clip, Skeleton
from mocapress.motion.figure import centimetres
from mocapress.motion.kinematics import local_rotations, translations

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_VERTICES, _INDICES = 34962, 34963  # what a graphics card takes an array for
_RING, _THICKNESS = 0.15, 0.09
"""Of a bone's length: where it is thickest, and half of how thick it is there."""
_ALONE = 0.02
"""Metres that a joint without bones is drawn long."""


def write(clip: Clip, *, most: float | None = None, unit: float | None = None) -> dict[str, bytes]:
    """Give a clip as a GLB; lengths are metres then.

    Parameters
    ----------
    clip
        With a skeleton and a frame time.
    most
        Largest error in centimetres, of joints, of points 3 cm along their axes and of the ends of
        bones, for which keys are left out; None keeps them at all frames, as float32.
    unit
        Centimetres in a unit of the clip; None takes what its skeleton says or suggests.

    Raises
    ------
    ParameterError
        When the error cannot be kept by numbers of float32.
    UnsupportedError
        When the clip has no skeleton or frames, bones stretch, a number is missing, or nothing says
        how long its units are.

    """
    skeleton = clip.skeleton
    if skeleton is None or not skeleton.joints:
        raise UnsupportedError("a GLB needs a skeleton")
    if not clip.frames:
        raise UnsupportedError("no frames to be written")
    metres = _metres(clip, unit)
    exact = _motion(clip, skeleton, metres)
    stored = exact._replace(turns=_single(exact.turns), places=_single(exact.places))
    made = GlbWriter()
    rest = _rest(skeleton, stored.places, metres)
    ends = [_single(np.array(joint.ends).reshape(-1, 3) * metres) for joint in skeleton.joints]
    nodes, roots = _nodes(skeleton, rest, ends)
    standing = _standing(skeleton, rest)
    made.document = {
        "asset": {"version": "2.0", "generator": "mocapress"},
        "scene": 0,
        "scenes": [{"nodes": [*roots, len(nodes)]}],
        "nodes": [*nodes, {"name": "bones", "mesh": 0, "skin": 0}],
        "meshes": [_mesh(made, skeleton, rest, ends, standing)],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.1, "roughnessFactor": 0.6}}],
        "skins": [_skin(made, standing)],
        "animations": [_animation(made, clip, stored, _keys(exact, stored, ends, most))],
    }
    return {".glb": made.contents()}


def _single(values: Array) -> Array:
    """Round to float32."""
    return values.astype(np.float32).astype(np.float64)


def _metres(clip: Clip, unit: float | None) -> float:
    unit = unit or centimetres(clip)
    if unit is None:
        raise UnsupportedError(
            "glTF has metres, and nothing says how long the units of this clip are",
            expected="the unit, such as glb:unit=cm",
        )
    return unit / 100


def _motion(clip: Clip, skeleton: Skeleton, metres: float) -> Motion:
    turns = np.roll(local_rotations(clip), -1, axis=2)
    # A turn and its negative are one; what is between two keys has to be near both.
    flips = np.where((turns[1:] * turns[:-1]).sum(axis=2) < 0, -1.0, 1.0)
    turns[1:] *= np.cumprod(flips, axis=0)[..., None]
    places = translations(clip) * metres
    most = float(np.finfo(np.float32).max)
    for values in (turns, places):
        bad = np.argwhere(~(np.abs(values) <= most).all(axis=2))
        if len(bad):
            frame, joint = bad[0].tolist()
            name = skeleton.joints[joint].name
            raise UnsupportedError(
                "a GLB holds numbers of float32",
                expected="finite ones",
                found=f"others in frame {frame + 1} of {name}",
            )
    return Motion(skeleton.parents, turns, places)


def _keys(exact: Motion, stored: Motion, ends: list[Array], most: float | None) -> Keys:
    frames, joints = exact.turns.shape[:2]
    if most is None:
        return Keys(np.ones((frames, joints), bool), np.ones((frames, joints), bool))
    found = reduced(_with_ends(exact, ends), _with_ends(stored, ends), most / 100)
    if found is None:
        raise ParameterError(
            "glb: max is less than float32 keeps of this clip", found=f"{most:g} cm"
        )
    return Keys(found.turns[:, :joints], found.places[:, :joints])


def _with_ends(motion: Motion, ends: list[Array]) -> Motion:
    """Add the ends of bones as joints that never move."""
    owners = [j for j, own in enumerate(ends) for _ in own]
    frames = len(motion.turns)
    still = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (frames, len(owners), 4))
    placed = np.broadcast_to(np.concatenate(ends), (frames, len(owners), 3))
    return Motion(
        (*motion.parents, *owners),
        np.concatenate([motion.turns, still], axis=1),
        np.concatenate([motion.places, placed], axis=1),
    )


def _rest(skeleton: Skeleton, places: Array, metres: float) -> Array:
    """Give places of joints at rest relative to their parents, (J, 3): that of all frames.

    A root rests where it begins, so that what shows the figure at rest shows it there.
    """
    rest: Array = places[0].copy()
    for j, joint in enumerate(skeleton.joints):
        if joint.parent >= 0 and any(joint.offset) and _varies(places[:, j]):
            rest[j] = _single(np.array(joint.offset) * metres)
    return rest


def _varies(values: Array) -> bool:
    return bool(np.ptp(values, axis=0).any())


def _standing(skeleton: Skeleton, rest: Array) -> Array:
    """Give the places of resting joints in space: no joint is turned then."""
    standing = rest.copy()
    for j, parent in enumerate(skeleton.parents):
        if parent >= 0:
            standing[j] += standing[parent]
    return standing


def _nodes(
    skeleton: Skeleton, rest: Array, ends: list[Array]
) -> tuple[list[dict[str, Any]], list[int]]:
    """Give a node for each joint, and the roots. Several roots get a node above them."""
    nodes: list[dict[str, Any]] = []
    for joint, place, own in zip(skeleton.joints, rest, ends, strict=True):
        node: dict[str, Any] = {"name": joint.name, "translation": place.tolist()}
        if len(own):
            node["extras"] = {"ends": own.tolist()}
        nodes.append(node)
    roots: list[int] = []
    for j, parent in enumerate(skeleton.parents):
        (nodes[parent].setdefault("children", []) if parent >= 0 else roots).append(j)
    if len(roots) > 1:
        nodes.append({"name": "roots", "children": roots})
        roots = [len(nodes) - 1]
    return nodes, roots


def _skin(made: GlbWriter, standing: Array) -> dict[str, Any]:
    inverse = np.tile(np.eye(4, dtype=np.float32), (len(standing), 1, 1))
    inverse[:, 3, :3] = -standing  # by columns
    matrices = made.array(inverse.reshape(-1, 16))
    return {"joints": [*range(len(standing))], "inverseBindMatrices": matrices}


def _mesh(
    made: GlbWriter, skeleton: Skeleton, rest: Array, ends: list[Array], standing: Array
) -> dict[str, Any]:
    """Give the figure: each bone a double pyramid that moves with the joint it begins at."""
    bones = [(parent, rest[j]) for j, parent in enumerate(skeleton.parents) if parent >= 0]
    bones += [(j, end) for j, own in enumerate(ends) for end in own]
    bones = [(j, bone) for j, bone in bones if bone.any()] or [(0, np.array([0.0, _ALONE, 0.0]))]
    owners = np.repeat([j for j, _ in bones], 6)
    points = np.concatenate([standing[j] + _pyramids(bone) for j, bone in bones])
    corners = np.array([[side, (side + 1) % 4] for side in range(4)]) + 1
    tips, tails = np.full((4, 1), 5), np.zeros((4, 1), int)
    one = np.concatenate([np.hstack([tips, corners]), np.hstack([tails, corners[:, ::-1]])])
    faces = (one.reshape(1, -1) + 6 * np.arange(len(bones))[:, None]).ravel()
    joints = np.zeros((len(points), 4), np.uint8 if len(rest) <= 256 else np.uint16)
    joints[:, 0] = owners
    weights = np.zeros((len(points), 4), np.uint8)
    weights[:, 0] = 255
    weighed = made.array(weights, target=_VERTICES)
    made.accessors[weighed]["normalized"] = True
    attributes = {
        "POSITION": made.array(points.astype(np.float32), target=_VERTICES, bounded=True),
        "JOINTS_0": made.array(joints, target=_VERTICES),
        "WEIGHTS_0": weighed,
    }
    small = np.uint16 if len(points) < 2**16 else np.uint32
    indices = made.array(faces.astype(small), target=_INDICES)
    return {"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}


def _pyramids(bone: Array) -> Array:
    """Give the corners of a bone: its start, a ring of four, its end."""
    length = np.linalg.norm(bone)
    across = np.cross(bone, np.eye(3)[np.abs(bone).argmin()])
    across *= _THICKNESS * length / np.linalg.norm(across)
    other = np.cross(bone, across) / length
    ring = bone * _RING + np.array([across, other, -across, -other])
    return np.concatenate([[np.zeros(3)], ring, [bone]])


def _animation(made: GlbWriter, clip: Clip, stored: Motion, keys: Keys) -> dict[str, Any]:
    """Give samplers and channels; what rests for the whole clip has one key."""
    assert clip.frame_time is not None
    times = np.arange(clip.frames) * np.float64(clip.frame_time)
    inputs: dict[bytes, int] = {}
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []

    def add(joint: int, path: str, values: Array, mask: Mask) -> None:
        own = mask.tobytes()
        if own not in inputs:
            inputs[own] = made.array(times[mask].astype(np.float32), bounded=True)
        output = made.array(values[mask].astype(np.float32))
        samplers.append({"input": inputs[own], "output": output})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": joint, "path": path}})

    first = np.arange(clip.frames) == 0
    for j, parent in enumerate(stored.parents):
        turns, places = stored.turns[:, j], stored.places[:, j]
        # A root has its keys also where it rests: they say how long the clip is.
        add(j, "rotation", turns, keys.turns[:, j] if parent < 0 or _varies(turns) else first)
        if parent < 0 or _varies(places):
            add(j, "translation", places, keys.places[:, j])
    time = clip.frame_time
    said = format(time, "f") if isinstance(time, Decimal) else str(time)
    return {
        "name": clip.name or "motion",
        "samplers": samplers,
        "channels": channels,
        "extras": {"frame_time": said},
    }
