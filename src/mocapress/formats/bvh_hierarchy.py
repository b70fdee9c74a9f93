"""The first part of a BVH file: the skeleton, and what the MOTION section declares."""

import re
from dataclasses import dataclass
from decimal import Decimal
from math import isfinite
from typing import NoReturn

from mocapress.errors import FormatError
from mocapress.formats.joint_names import decoded, escaped
from mocapress.formats.number_formats import stated, to_state
from mocapress.motion.skeleton import Joint, Skeleton, Vec3

_KINDS = {
    "xposition": "tx",
    "yposition": "ty",
    "zposition": "tz",
    "xrotation": "rx",
    "yrotation": "ry",
    "zrotation": "rz",
}
_NAMES = {kind: name[0].upper() + name[1:] for name, kind in _KINDS.items()}
# Braces may stand on a line of their own or not.
_PIECE = re.compile(rb"[{}]|[^\s{}][^\n{}]*")
_FRAMES = re.compile(rb"\s*frames\s*:\s*(\S+)[^\n]*(?:\n|$)", re.IGNORECASE)
_FRAME_TIME = re.compile(rb"\s*frame\s*time\s*:\s*(\S+)[^\n]*(?:\n|$)", re.IGNORECASE)
_MOST_JOINTS = 2**16


@dataclass(frozen=True, slots=True)
class Hierarchy:
    """What stands before the rows."""

    skeleton: Skeleton
    frames: int
    """As declared."""
    frame_time: Decimal
    """Seconds, as declared."""
    rows_begin: int
    """Byte offset of the first row."""


@dataclass(slots=True)
class _Open:
    """A joint whose brace is open."""

    name: str
    parent: int
    end_site: bool
    offset: Vec3 = (0.0, 0.0, 0.0)
    index: int = -1


def parse_hierarchy(data: bytes, file: str | None = None) -> Hierarchy:
    """Read up to the first row.

    Raises
    ------
    FormatError
        When the file does not follow the format: with line, expected and found.

    """
    return _Parser(data, file).hierarchy()


class _Parser:
    def __init__(self, data: bytes, file: str | None) -> None:
        self.data, self.file = data, file
        self.joints: list[Joint] = []
        self.stack: list[_Open] = []

    def fail(self, offset: int, what: str, expected: str, found: str | None = None) -> NoReturn:
        if found is None:
            found = self.data[offset : offset + 40].split(b"\n")[0].decode("latin-1").strip()
            found = repr(found) if found else "the end of the file"
        line = self.data.count(b"\n", 0, offset) + 1
        raise FormatError(
            what, file=self.file, line=line, offset=offset, expected=expected, found=found
        )

    def hierarchy(self) -> Hierarchy:
        position = 0
        waiting: _Open | None = None  # a joint whose brace is to come
        while True:
            piece = _PIECE.search(self.data, position)
            if piece is None:
                self.fail(len(self.data), "no motion", "MOTION", "the end of the file")
            at, position = piece.start(), piece.end()
            text = piece.group().removeprefix(b"\xef\xbb\xbf").strip()
            if not text or text.startswith((b"#", b"//")):
                line_end = self.data.find(b"\n", at)
                position = line_end if line_end >= 0 else len(self.data)
                continue
            key, *words = (word.decode("latin-1") for word in text.split())
            key = key.upper()
            if waiting and key != "{":
                self.fail(at, f"joint {waiting.name}", "{")
            if key == "MOTION":
                if self.stack or not self.joints:
                    self.fail(at, "the hierarchy is not complete", "}" if self.stack else "ROOT")
                return self._motion(position)
            if key == "{":
                if waiting is None:
                    self.fail(at, "a brace without a joint", "ROOT, JOINT or End Site")
                self.stack.append(waiting)
                waiting = None
            elif key in ("ROOT", "JOINT", "END"):
                waiting = self._begin(at, key, decoded(text[len(key) :].strip()))
            else:
                position = self._more_words(position, key, words)
                self._inside(at, key, words)

    def _more_words(self, position: int, key: str, words: list[str]) -> int:
        """Append the words of the next lines, where OFFSET or CHANNELS go on there."""
        needed = 3 if key == "OFFSET" else 0
        if key == "CHANNELS" and words and words[0].isdecimal():
            needed = 1 + min(int(words[0][:3]), 99)
        while len(words) < needed:
            piece = _PIECE.search(self.data, position)
            if piece is None or piece.group() in b"{}":
                break
            words += (word.decode("latin-1") for word in piece.group().split())
            position = piece.end()
        return position

    def _inside(self, at: int, key: str, words: list[str]) -> None:
        if key == "}":
            self._close(at)
        elif key == "OFFSET":
            self._offset(at, words)
        elif key == "CHANNELS":
            self._channels(at, words)
        elif key != "HIERARCHY":
            self.fail(at, "hierarchy", "ROOT, JOINT, End Site, OFFSET, CHANNELS or a brace")

    def _begin(self, at: int, key: str, name: str) -> _Open:
        if (key == "ROOT") == bool(self.stack) or (self.stack and self.stack[-1].end_site):
            self.fail(at, f"{key} in the wrong place", "ROOT outside, JOINT inside of a joint")
        if len(self.joints) >= _MOST_JOINTS:
            self.fail(at, "too many joints", f"at most {_MOST_JOINTS}")
        made = _Open(name, self.stack[-1].index if self.stack else -1, key == "END")
        if not made.end_site:
            made.index = len(self.joints)
            self.joints.append(Joint(name, made.parent))
        return made

    def _offset(self, at: int, words: list[str]) -> None:
        try:
            x, y, z = (float(word) for word in words)
        except ValueError:
            x = y = z = float("nan")
        if not self.stack or not (isfinite(x) and isfinite(y) and isfinite(z)):
            self.fail(at, "offset", "OFFSET and three numbers, inside of a joint")
        here = self.stack[-1]
        here.offset = (x, y, z)
        if not here.end_site:
            joint = self.joints[here.index]
            self.joints[here.index] = Joint(joint.name, joint.parent, here.offset, joint.channels)

    def _channels(self, at: int, words: list[str]) -> None:
        kinds = tuple(_KINDS.get(word.lower(), "") for word in words[1:])
        told = words[0].lstrip("0") or "0" if words else ""
        if told != str(len(kinds)) or "" in kinds:
            self.fail(at, "channels", "their number, and as many names like Xrotation")
        if not self.stack or self.stack[-1].end_site or len(set(kinds)) < len(kinds):
            self.fail(at, "channels", "each at most once, inside of a joint")
        index = self.stack[-1].index
        joint = self.joints[index]
        self.joints[index] = Joint(joint.name, joint.parent, joint.offset, kinds)

    def _close(self, at: int) -> None:
        if not self.stack:
            self.fail(at, "a brace too many", "MOTION")
        closed = self.stack.pop()
        if closed.end_site:
            joint = self.joints[closed.parent]
            self.joints[closed.parent] = Joint(
                joint.name,
                joint.parent,
                joint.offset,
                joint.channels,
                ends=(*joint.ends, closed.offset),
            )

    def _motion(self, position: int) -> Hierarchy:
        frames = _FRAMES.match(self.data, position)
        told = frames[1].lstrip(b"0") or b"0" if frames else b""
        if frames is None or not told.isdigit() or int(told[:20]) > 2**40:
            self.fail(position, "number of frames", "Frames: and their number")
        frame_time = _FRAME_TIME.match(self.data, frames.end())
        if frame_time is None:
            self.fail(frames.end(), "frame time", "Frame Time: and seconds")
        seconds = stated(frame_time[1])
        if seconds is None:
            self.fail(frames.end(), "frame time", "seconds")
        skeleton = Skeleton(tuple(self.joints), "moving")
        return Hierarchy(skeleton, int(told), seconds, frame_time.end())


def format_hierarchy(skeleton: Skeleton, frames: int, frame_time: Decimal) -> bytes:
    """Print the first part of a BVH file; joints parents first, depth first."""
    lines = ["HIERARCHY"]
    children: dict[int, list[int]] = {}
    for i, joint in enumerate(skeleton.joints):
        children.setdefault(joint.parent, []).append(i)
    pending: list[tuple[int, int]] = [(root, 0) for root in reversed(children.get(-1, []))]
    while pending:
        i, depth = pending.pop()
        tab = "\t" * depth
        if i < 0:
            lines.append(tab + "}")
            continue
        joint = skeleton.joints[i]
        names = " ".join(_NAMES[kind] for kind in joint.channels)
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


def _text(vector: Vec3) -> str:
    return " ".join(f"{x:.9g}" for x in vector)
