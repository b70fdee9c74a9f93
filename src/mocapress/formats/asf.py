"""ASF: an Acclaim skeleton."""

import re
from dataclasses import replace
from functools import lru_cache

import numpy as np

from mocapress import _core
from mocapress.formats.contract import Format
from mocapress.formats.encodings import FileText
from mocapress.formats.joint_names import escaped, words
from mocapress.formats.problems import Problem
from mocapress.motion.skeleton import Joint, Skeleton, Vec3

_KEYWORD = re.compile(rb"(?:^|[\r\n])[ \t]*:(bonedata|root|hierarchy|version)\b", re.IGNORECASE)
_SHORT = 2**16
_RESERVED = frozenset({"root", "begin", "end"})


def parse_asf(data: bytes, file: str | None = None) -> Skeleton:
    """Read an ASF file.

    Raises
    ------
    FormatError
        When it does not follow the format: with line, expected and found.

    """
    found = (_of_recent if len(data) <= _SHORT else _of)(data)
    if isinstance(found, Problem):
        raise found.error(file)
    return found


def _of(data: bytes) -> Skeleton | Problem:
    text = FileText.of(data)
    read = _core.read_asf(text.data)
    if read.fault:
        fault = Problem.told(read.fault, text)
        if _KEYWORD.search(text.data):
            return fault
        expected = "sections such as :root and :bonedata"
        return replace(fault, what="not an Acclaim skeleton", line=None, expected=expected)
    joints = tuple(Joint(*joint) for joint in read.joints)
    unit = "rad" if read.radians else "deg"
    return Skeleton(joints, "fixed", unit, read.length_unit, read.name, {"mass": read.mass})


# Many clips in a row have one skeleton; as one object it is written only once, too.
_of_recent = lru_cache(4)(_of)


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
