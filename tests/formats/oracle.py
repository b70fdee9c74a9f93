"""Positions of joints by another way: rotation matrices, and a reader that goes by tokens.

Shares no code with mocapress, so that the two can be compared.
"""

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
AXES = {"x": 0, "y": 1, "z": 2}


def turn(axis: str, angle: Any) -> Array:
    """Give rotation matrices about x, y or z: (F, 3, 3)."""
    angle = np.asarray(angle, float)
    with np.errstate(invalid="ignore"):  # of infinite angles
        c, s = np.cos(angle), np.sin(angle)
    o, z = np.ones_like(angle), np.zeros_like(angle)
    matrix = {
        "x": [[o, z, z], [z, c, -s], [z, s, c]],
        "y": [[c, z, s], [z, o, z], [-s, z, c]],
        "z": [[c, -s, z], [s, c, z], [z, z, o]],
    }[axis]
    return np.moveaxis(np.array(matrix), [0, 1], [-2, -1])


def text_of(data: bytes) -> str:
    for mark, encoding in ((b"\xff\xfe", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig")):
        if data.startswith(mark):
            return data.decode(encoding, "replace")
    return data.decode("latin-1")


def number(word: str) -> float:
    indefinite = re.match(r"([+-]?)(1\.#|nan|inf)", word.lower())
    if indefinite:
        infinite = "inf" in word.lower()
        return (-np.inf if indefinite[1] == "-" else np.inf) if infinite else np.nan
    return float(word)


def bvh(data: bytes) -> tuple[list[dict[str, Any]], Array]:
    """Give the joints, end sites among them, and the values, (F, C)."""
    text = text_of(data).replace("\0", " ")
    motion = re.search(r"[\r\n]\s*MOTION\b", text, re.IGNORECASE)
    assert motion is not None
    head, rest = text[: motion.start()], text[motion.end() :]
    lines = [line.strip() for line in re.split(r"[\r\n]+", re.sub(r"([{}])", r"\n\1\n", head))]
    lines = [line for line in lines if line and not line.startswith(("#", "//"))]
    joints: list[dict[str, Any]] = []
    stack: list[int] = []
    at = 0

    def words(needed: int) -> list[str]:
        nonlocal at
        found = lines[at].split()[1:]
        while len(found) < needed:
            at += 1
            found += lines[at].split()
        return found[:needed]

    pending: dict[str, Any] = {}
    while at < len(lines):
        key = lines[at].split()[0].upper()
        if key in ("ROOT", "JOINT", "END"):
            pending = {"channels": [], "offset": [0, 0, 0], "end": key == "END"}
        elif key == "{":
            joints.append(pending | {"parent": stack[-1] if stack else -1})
            stack.append(len(joints) - 1)
        elif key == "}":
            stack.pop()
        elif key == "OFFSET":
            joints[stack[-1]]["offset"] = [number(word) for word in words(3)]
        elif key == "CHANNELS":
            count = int(lines[at].split()[1])
            joints[stack[-1]]["channels"] = [word.lower() for word in words(1 + count)[1:]]
        at += 1
    time = re.search(r"frame\s*time\s*:?\s*([^\s]+)[^\n\r]*", rest, re.IGNORECASE)
    assert time is not None
    values = []
    for word in rest[time.end() :].split():
        try:
            values.append(number(word))
        except ValueError:
            break
    channels = sum(len(joint["channels"]) for joint in joints)
    frames = len(values) // channels
    return joints, np.array(values[: frames * channels]).reshape(frames, channels)


def bvh_positions(data: bytes) -> Array:
    """Give the positions of all joints but end sites: (F, J, 3)."""
    joints, values = bvh(data)
    frames, column = len(values), 0
    placed: list[Array] = []
    turned: list[Array] = []
    for joint in joints:
        offset = np.tile(np.array(joint["offset"], float), (frames, 1))
        rotation = np.tile(np.eye(3), (frames, 1, 1))
        for channel in joint["channels"]:
            value = values[:, column]
            column += 1
            if channel.endswith("position"):
                offset[:, AXES[channel[0]]] = value
            elif channel.endswith("rotation"):
                rotation = rotation @ turn(channel[0], np.radians(value))
        parent = joint["parent"]
        if parent >= 0:
            offset = placed[parent] + np.einsum("nij,nj->ni", turned[parent], offset)
            rotation = turned[parent] @ rotation
        placed.append(offset)
        turned.append(rotation)
    return np.stack([p for p, joint in zip(placed, joints, strict=True) if not joint["end"]], 1)


def asf(data: bytes) -> tuple[dict[str, str], dict[str, Any], dict[str, Any], dict[str, str]]:  # noqa: C901
    """Give units, root, bones by name and the parents of bones."""
    section = ""
    bone: dict[str, Any] = {}
    units: dict[str, str] = {}
    root: dict[str, Any] = {"dof": [], "order": "xyz", "offset": [0, 0, 0], "axis": [0, 0, 0]}
    bones: dict[str, Any] = {}
    parents: dict[str, str] = {}
    for raw in re.split(rb"\r\n|\n|\r", data):
        words = [word.decode("latin-1") for word in raw.split(b"#")[0].split()]
        if not words:
            continue
        key, three = words[0].lower(), words[1:4]
        if key.startswith(":"):
            section = key
        elif section == ":units":
            units[key] = words[1]
        elif section == ":root" and key in ("position", "orientation"):
            root["offset" if key == "position" else "axis"] = [float(word) for word in three]
        elif section == ":root" and key == "order":
            root["dof"] = [word.lower() for word in words[1:]]
        elif section == ":root":
            root["order"] = words[1].lower()
        elif section == ":bonedata" and key == "begin":
            bone = {"dof": [], "axis": [0, 0, 0], "order": "xyz"}
        elif section == ":bonedata" and key == "end":
            bones[bone["name"]] = bone
        elif section == ":bonedata" and key == "name":
            bone["name"] = words[1]
        elif section == ":bonedata" and key in ("direction", "axis"):
            bone[key] = [float(word) for word in three]
            bone["order"] = words[4].lower() if len(words) > 4 else bone["order"]
        elif section == ":bonedata" and key == "length":
            bone[key] = float(words[1])
        elif section == ":bonedata" and key == "dof":
            bone[key] = [word.lower() for word in words[1:]]
        elif section == ":hierarchy" and key not in ("begin", "end"):
            parents |= dict.fromkeys(words[1:], words[0])
    return units, root, bones, parents


def amc(data: bytes) -> tuple[list[dict[str, list[float]]], bool | None]:
    """Give the frames, and whether they say to be in radians."""
    frames: list[dict[str, list[float]]] = []
    radians = None
    for raw in re.split(rb"\r\n|\n|\r", data):
        words = [word.decode("latin-1") for word in raw.split(b"#")[0].split()]
        if not words:
            continue
        if words[0].startswith(":"):
            radians = {":radians": True, ":degrees": False}.get(words[0].lower(), radians)
        elif len(words) == 1 and words[0].lstrip("-").isdigit():
            frames.append({})
        elif frames:
            frames[-1][words[0]] = [float(word) for word in words[1:]]
    return frames, radians


def amc_positions(asf_data: bytes, amc_data: bytes) -> dict[str, Array]:
    """Give the positions of each bone's start, (F, 3), by name."""
    units, root, bones, parents = asf(asf_data)
    frames, radians = amc(amc_data)
    count = len(frames)
    rest = 1.0 if units.get("angle", "deg").lower() == "rad" else np.pi / 180
    unit = rest if radians is None else 1.0 if radians else np.pi / 180

    def values(name: str, channels: list[str]) -> dict[str, Array]:
        rows, last = [], [0.0] * len(channels)
        for frame in frames:
            last = frame.get(name, last)
            rows.append(last[: len(channels)])
        made = np.array(rows, float).reshape(count, len(channels))
        return {channel: made[:, i] for i, channel in enumerate(channels)}

    def local(name: str, bone: dict[str, Any]) -> tuple[Array, Array]:
        found = values(name, bone["dof"])
        zero = np.zeros(count)
        frame = turned = np.tile(np.eye(3), (count, 1, 1))
        for axis in bone["order"]:
            frame = turn(axis, np.full(count, bone["axis"][AXES[axis]] * rest)) @ frame
            turned = turn(axis, found.get(f"r{axis}", zero) * unit) @ turned
        moved = np.stack([found.get(f"t{axis}", zero) for axis in "xyz"], -1)
        return moved, frame @ turned @ np.swapaxes(frame, 1, 2)

    moved, rotation = local("root", root)
    turned = {"root": rotation}
    starts = {"root": np.array(root["offset"], float) + moved}
    ends = dict(starts)
    waiting = list(bones)
    while waiting:
        name = next(name for name in waiting if parents[name] in turned)
        waiting.remove(name)
        bone, parent = bones[name], parents[name]
        moved, rotation = local(name, bone)
        starts[name] = ends[parent] + np.einsum("nij,nj->ni", turned[parent], moved)
        turned[name] = turned[parent] @ rotation
        direction = np.array(bone["direction"], float)
        vector = direction / (np.linalg.norm(direction) or 1.0) * bone["length"]
        ends[name] = starts[name] + np.einsum("nij,j->ni", turned[name], vector)
    return starts
