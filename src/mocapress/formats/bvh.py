"""BVH: a skeleton and its motion in one file, one line per frame."""

import re
from decimal import Decimal
from functools import partial

from mocapress import _core
from mocapress.errors import UnsupportedError
from mocapress.formats.contract import Format, Split, split_of
from mocapress.formats.encodings import FileText
from mocapress.formats.joint_names import escaped
from mocapress.formats.layout import build, print_clip
from mocapress.formats.number_formats import to_state
from mocapress.formats.problems import Problem
from mocapress.formats.rows import Body
from mocapress.motion import Clip, Joint, Skeleton
from mocapress.motion.convert import to_bvh_clip
from mocapress.motion.frame_time import decimal_seconds
from mocapress.motion.skeleton import Vec3
from mocapress.motion.stream import Column

# Comments may stand before it.
_KEYWORD = re.compile(rb"(?:(?:#|//)[^\r\n]*+\s*+)*+HIERARCHY\b", re.IGNORECASE)
_WORDS = {
    f"{kind}{axis}": f"{axis.upper()}{word}"
    for axis in "xyz"
    for kind, word in (("t", "position"), ("r", "rotation"), ("s", "scale"))
}


def split(data: bytes, _skeleton: Skeleton | None = None, file: str | None = None) -> Split:
    """Take a BVH apart; it has its skeleton in itself."""
    text = FileText.of(data)
    read = _core.read_bvh(text.data)
    if read.fault:
        raise Problem.told(read.fault, text).error(file)
    body = Body.of(read.body)
    skeleton = Skeleton(tuple(Joint(*joint) for joint in read.joints), "moving")
    columns = tuple(Column(*column) for column in read.columns)
    clip = Clip.of(body.values, columns, Decimal(read.frame_time), skeleton)
    slots = partial(_core.bvh_slots, columns=len(columns))
    layout = build("bvh", text, body, slots, partial(read.places, text.data, body.offsets))
    return split_of(clip, layout, [Problem.told(fact, text) for fact in read.problems], file)


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip."""
    if clip.skeleton is None:
        raise UnsupportedError("a BVH file needs a skeleton")
    if clip.frame_time is None:
        raise UnsupportedError("a BVH file needs a frame time")
    header = format_hierarchy(clip.skeleton, clip.frames, decimal_seconds(clip.frame_time))
    place = {joint: n for n, joint in enumerate(_depth_first(clip.skeleton))}
    order = sorted(range(clip.channels), key=lambda c: place.get(clip.columns[c].joint, 0))
    columns = tuple(clip.columns[c] for c in order)
    clip = Clip.of(clip.values[:, order], columns, clip.frame_time, clip.skeleton, clip.name)
    literals = [b"", *[b" "] * (clip.channels - 1), b"\n"]
    return {".bvh": print_clip(clip, header, literals, counter=False)}


def format_hierarchy(skeleton: Skeleton, frames: int, frame_time: Decimal) -> bytes:
    """Print the first part of a BVH file; joints parents first, depth first."""
    lines = ["HIERARCHY"]
    children = _children(skeleton)
    pending: list[tuple[int, int]] = [(root, 0) for root in reversed(children.get(-1, []))]
    while pending:
        i, depth = pending.pop()
        tab = "\t" * depth
        if i < 0:
            lines.append(tab + "}")
            continue
        joint = skeleton.joints[i]
        names = " ".join(_WORDS[kind] for kind in joint.channels)
        lines += [
            f"{tab}{'JOINT' if joint.parent >= 0 else 'ROOT'} {escaped(joint.name, '{}')}",
            tab + "{",
            f"{tab}\tOFFSET {_text(joint.offset)}",
            f"{tab}\tCHANNELS {len(joint.channels)} {names}".rstrip(),
        ]
        for end in joint.ends:
            lines += [
                tab + "\tEnd Site",
                tab + "\t{",
                f"{tab}\t\tOFFSET {_text(end)}",
                tab + "\t}",
            ]
        pending.append((-1, depth))
        pending += [(child, depth + 1) for child in reversed(children.get(i, []))]
    lines += ["MOTION", f"Frames: {frames}", f"Frame Time: {to_state(frame_time)}", ""]
    return "\n".join(lines).encode()


def _children(skeleton: Skeleton) -> dict[int, list[int]]:
    children: dict[int, list[int]] = {}
    for i, joint in enumerate(skeleton.joints):
        children.setdefault(joint.parent, []).append(i)
    return children


def _depth_first(skeleton: Skeleton) -> list[int]:
    """Give the joints in the order in which a file has them."""
    children, order = _children(skeleton), []
    pending = children.get(-1, [])[::-1]
    while pending:
        order.append(pending.pop())
        pending += reversed(children.get(order[-1], []))
    return order


def _text(vector: Vec3) -> str:
    return " ".join(f"{x:.9g}" for x in vector)


FORMAT = Format(
    id="bvh",
    name="BVH",
    suffixes=(".bvh",),
    recognises=lambda head: bool(_KEYWORD.match(head)),
    split=split,
    fit=to_bvh_clip,
    write=write,
)
