"""ASF: an Acclaim skeleton."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import hypot, isfinite
from typing import NoReturn

import numpy as np

from mocapress.errors import FormatError
from mocapress.formats.contract import Format
from mocapress.formats.joint_names import decoded, escaped, words
from mocapress.motion.skeleton import Joint, Skeleton, Vec3

_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz", "l")
_KEYWORD = re.compile(rb"^\s*:(bonedata|root|hierarchy|version)\b", re.MULTILINE | re.IGNORECASE)
_RESERVED = frozenset({"root", "begin", "end"})
# In the documentation: the name of a root that is called otherwise.
_ROOT_NAME = re.compile(rb"^[ \t]*mocapress-root[ \t]+(\S+)", re.MULTILINE)
_LIMIT = re.compile(r"\(\s*([^\s(),]+)[\s,]+([^\s(),]+)\s*\)")


@dataclass(frozen=True, slots=True)
class _Line:
    number: int
    key: str
    """First word, lower case."""
    words: list[str]
    """The others."""
    text: str


@dataclass(slots=True)
class _Bone:
    name: str
    line: int
    vector: Vec3 = (0.0, 0.0, 0.0)
    axis: Vec3 = (0.0, 0.0, 0.0)
    axis_order: str = "xyz"
    channels: tuple[str, ...] = ()
    limits: list[tuple[float, float]] = field(default_factory=list)
    position: Vec3 = (0.0, 0.0, 0.0)
    parent: int = -1


def parse_asf(data: bytes, file: str | None = None) -> Skeleton:
    """Read an ASF file.

    Raises
    ------
    FormatError
        When it does not follow the format: with line, expected and found.

    """
    return _Parser(data, file).skeleton()


class _Parser:
    def __init__(self, data: bytes, file: str | None) -> None:
        self.file = file
        self.lines = iter(list(_lines(data)))
        named = _ROOT_NAME.search(data)
        self.root_name = named[1].decode("latin-1") if named else "root"

    def fail(self, line: int, what: str, expected: str, found: str | None = None) -> NoReturn:
        raise FormatError(what, file=self.file, line=line, expected=expected, found=found)

    def skeleton(self) -> Skeleton:
        units: dict[str, str] = {}
        name, section = "", ""
        bones: list[_Bone] = []
        children: list[_Line] = []
        for line in self.lines:
            if line.key.startswith(":"):
                section = line.key
                if section == ":name":
                    name = _name(" ".join(line.words))
                elif section == ":root":
                    bones.insert(0, _Bone("root", line.number))
            elif section == ":units" and line.words:
                units[line.key] = line.words[0]
            elif section == ":root":
                self._root_line(bones[0], line)
            elif section == ":bonedata" and line.key == "begin":
                bones.append(self._bone(line.number))
            elif section == ":hierarchy" and line.key not in ("begin", "end"):
                children.append(line)
        if not bones or bones[0].name != "root":
            self.fail(1, "no root", "a section :root")
        self._link(bones, children)
        angle = units.get("angle", "deg").lower()
        if angle not in ("deg", "rad"):
            self.fail(1, "unit of angles", "deg or rad", repr(angle))
        length = self._unit_of_length(units["length"]) if "length" in units else None
        bones[0].name = self.root_name
        joints = _joints(bones)
        return Skeleton(joints, "fixed", angle, length, name, {"mass": units.get("mass", "")})

    def _root_line(self, root: _Bone, line: _Line) -> None:
        if line.key == "order":
            root.channels = self._channels(line)
        elif line.key == "axis" and line.words:
            root.axis_order = self._order(line, line.words[-1])
        elif line.key == "position":
            root.position = self._vector(line)
        elif line.key == "orientation":
            root.axis = self._vector(line)

    def _bone(self, begin: int) -> _Bone:
        bone = _Bone("", begin)
        direction, length, limits = (0.0, 0.0, 0.0), 0.0, ""
        for line in self.lines:
            if line.key == "end":
                break
            if line.key.startswith(":"):
                self.fail(line.number, "a bone without end", "end", line.text)
            if line.key == "name":
                bone.name = " ".join(line.words)
            elif line.key == "direction":
                direction = self._vector(line)
            elif line.key == "length":
                length = self._number(line, line.words[0] if line.words else "")
            elif line.key == "axis":
                bone.axis = self._vector(line)
                bone.axis_order = self._order(line, line.words[3] if line.words[3:] else "xyz")
            elif line.key == "dof":
                bone.channels = self._channels(line)
            elif line.key == "limits" or line.key.startswith("("):
                limits += line.text
        else:
            self.fail(begin, "a bone without end", "end", "the end of the file")
        if not bone.name:
            self.fail(begin, "a bone without a name", "name")
        # Only the direction of `direction` counts: files exist where it is not of unit length.
        scale = length / (hypot(*direction) or 1.0)
        bone.vector = (direction[0] * scale, direction[1] * scale, direction[2] * scale)
        bone.limits = [
            (self._limit(begin, low), self._limit(begin, high))
            for low, high in _LIMIT.findall(limits)
        ]
        return bone

    def _link(self, bones: list[_Bone], lines: list[_Line]) -> None:
        """Set parents. Where names repeat, each mention as a child means the next such bone."""
        by_name: dict[str, list[int]] = {}
        by_lower: dict[str, list[int]] = {}
        for i, bone in enumerate(bones):
            by_name.setdefault(bone.name, []).append(i)
            by_lower.setdefault(bone.name.lower(), []).append(i)

        def find(line: _Line, name: str) -> list[int]:
            found = by_name.get(name) or by_lower.get(name.lower())
            return found or self.fail(line.number, "hierarchy", "the name of a bone", repr(name))

        linked = {0}
        for line in lines:
            parents = find(line, line.text.split(" ", 1)[0])
            parent = next((i for i in reversed(parents) if i in linked), parents[0])
            for word in line.words:
                child = next((i for i in find(line, word) if i not in linked), None)
                if child is None:
                    self.fail(line.number, "hierarchy", "a bone without a parent", repr(word))
                bones[child].parent = parent
                linked.add(child)
        loose = set(range(len(bones))) - _below_root(bones)
        if loose:
            bone = bones[min(loose)]
            self.fail(bone.line, f"bone {bone.name}", "a way to root in :hierarchy")

    def _channels(self, line: _Line) -> tuple[str, ...]:
        channels = tuple(word.lower() for word in line.words)
        wrong = [channel for channel in channels if channel not in _CHANNELS]
        if wrong or len(set(channels)) < len(channels):
            self.fail(line.number, line.key, "each of tx ty tz rx ry rz l at most once", line.text)
        return channels

    def _order(self, line: _Line, word: str) -> str:
        if sorted(word.lower()) != ["x", "y", "z"]:
            self.fail(line.number, "order of axes", "x, y and z in some order", repr(word))
        return word.lower()

    def _vector(self, line: _Line) -> Vec3:
        if len(line.words) < 3:
            self.fail(line.number, line.key, "three numbers", line.text)
        x, y, z = (self._number(line, word) for word in line.words[:3])
        return x, y, z

    def _unit_of_length(self, text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = 0.0
        if not (isfinite(value) and value > 0):
            self.fail(1, "unit of length", "a number above 0", repr(text))
        return value

    def _number(self, line: _Line, word: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = float("nan")
        if not isfinite(value):
            self.fail(line.number, line.key, "a number", repr(word))
        return value

    def _limit(self, line: int, word: str) -> float:
        try:
            return float(word)
        except ValueError:
            self.fail(line, "limits", "a number or inf", repr(word))


def _name(text: str) -> str:
    return decoded(text.encode("latin-1"))


def _lines(data: bytes) -> Iterator[_Line]:
    for number, text in enumerate(data.split(b"\n"), 1):
        words = [word.decode("latin-1") for word in text.split(b"#", 1)[0].split()]
        if words:
            yield _Line(number, words[0].lower(), words[1:], " ".join(words))


def _below_root(bones: list[_Bone]) -> set[int]:
    children: dict[int, list[int]] = {}
    for i, bone in enumerate(bones):
        children.setdefault(bone.parent, []).append(i)
    reached, pending = {0}, [0]
    while pending:
        below = children.get(pending.pop(), [])
        reached.update(below)
        pending += below
    return reached


def _joints(bones: list[_Bone]) -> tuple[Joint, ...]:
    """Order parents before children, otherwise as in the file."""
    children: dict[int, list[int]] = {}
    for i, bone in enumerate(bones):
        if i:
            children.setdefault(bone.parent, []).append(i)
    place = {0: 0}
    order = [0]
    pending = list(range(1, len(bones)))
    if any(bones[i].parent > i for i in pending):
        pending, stack = [], list(reversed(children.get(0, [])))
        while stack:
            i = stack.pop()
            pending.append(i)
            stack += reversed(children.get(i, []))
    for i in pending:
        place[i] = len(order)
        order.append(i)
    return tuple(
        Joint(
            _name(bone.name),
            -1 if i == 0 else place[bone.parent],
            bone.position if i == 0 else bones[bone.parent].vector,
            bone.channels,
            bone.axis,
            bone.axis_order,
            tuple(bone.limits),
            () if i in children or i == 0 else (bone.vector,),
        )
        for i, bone in ((i, bones[i]) for i in order)
    )


def format_asf(skeleton: Skeleton) -> bytes:
    """Print a skeleton whose joints follow ASF's rules, see ``mocapress.motion.convert``.

    Every joint but the root has one bone, at whose end all its children lie.
    """
    vectors = bone_vectors(skeleton)
    called = asf_words(skeleton)
    root = skeleton.joints[0]
    length = skeleton.length_unit if skeleton.length_unit is not None else 1.0
    lines = [
        ":version 1.10",
        f":name {escaped(skeleton.name or 'skeleton', '#')}",
        ":units",
        f"  mass 1.0\n  length {length!r}\n  angle {skeleton.angle_unit}",
        ":documentation\n   written by mocapress",
        *([f"   mocapress-root {escaped(root.name, ' #')}"] if root.name != "root" else []),
        ":root",
        f"   order {' '.join(root.channels).upper()}",
        f"   axis {root.axis_order.upper()}",
        f"   position {_text(root.offset)}",
        f"   orientation {_text(root.axis)}",
        ":bonedata",
    ]
    for i, joint in enumerate(skeleton.joints[1:], 1):
        size = float(np.linalg.norm(vectors[i]))
        x, y, z = vectors[i]
        direction = (x / size, y / size, z / size) if size else (0.0, 1.0, 0.0)
        lines += [
            f"  begin\n     id {i}\n     name {called[i]}",
            f"     direction {_text(direction)}\n     length {size!r}",
            f"     axis {_text(joint.axis)}  {joint.axis_order.upper()}",
        ]
        if joint.channels:
            lines.append(f"    dof {' '.join(joint.channels)}")
            limits = joint.limits or ((float("-inf"), float("inf")),) * len(joint.channels)
            lines.append("    limits " + "\n           ".join(f"({a!r} {b!r})" for a, b in limits))
        lines.append("  end")
    lines.append(":hierarchy\n  begin")
    children: list[list[str]] = [[] for _ in skeleton.joints]
    for i, joint in enumerate(skeleton.joints[1:], 1):
        children[joint.parent].append(called[i])
    for i, names in enumerate(children):
        if names:
            lines.append(f"    {called[i]} {' '.join(names)}")
    lines.append("  end\n")
    return "\n".join(lines).encode()


def asf_words(skeleton: Skeleton) -> list[str]:
    """Give the words by which an ASF and its AMC call the joints; the root is ``root``."""
    return ["root", *words([joint.name for joint in skeleton.joints[1:]], _RESERVED)]


def bone_vectors(skeleton: Skeleton) -> list[Vec3]:
    """Give every joint's bone, from its start to its end: where its children or its end lie."""
    vectors: list[Vec3] = [joint.ends[0] if joint.ends else (0, 0, 0) for joint in skeleton.joints]
    for joint in skeleton.joints[1:]:
        vectors[joint.parent] = joint.offset
    return vectors


def _text(vector: Vec3) -> str:
    return " ".join(repr(float(x)) for x in vector)


FORMAT = Format(
    id="asf",
    name="ASF",
    suffixes=(".asf",),
    recognises=lambda head: bool(_KEYWORD.search(head)),
    read_skeleton=parse_asf,
)
