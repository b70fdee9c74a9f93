"""AMC: the motion of an Acclaim skeleton, one line per bone and frame."""

import re
from fractions import Fraction
from functools import partial

from mocapress import _core
from mocapress.errors import UnsupportedError
from mocapress.formats.asf import asf_words, format_asf
from mocapress.formats.contract import Format, Split, split_of
from mocapress.formats.encodings import FileText
from mocapress.formats.joint_names import words
from mocapress.formats.layout import build, print_clip
from mocapress.formats.number_formats import to_state
from mocapress.formats.problems import Problem
from mocapress.formats.rows import Body
from mocapress.motion import Clip, Skeleton
from mocapress.motion.convert import to_amc_clip
from mocapress.motion.frame_time import FrameTime, short_decimal
from mocapress.motion.stream import Column

_KEYWORD = re.compile(rb"(?:^|[\r\n])[ \t]*:(fully-specified|degrees|radians)\b", re.IGNORECASE)


def split(data: bytes, skeleton: Skeleton | None = None, file: str | None = None) -> Split:
    """Take an AMC apart; angles are in the unit that it names, otherwise the skeleton's."""
    text = FileText.of(data)
    read = _core.read_amc(text.data, skeleton)
    if read.fault:
        raise Problem.told(read.fault, text).error(file)
    body = Body.of(read.body)
    columns = tuple(Column(*column) for column in read.columns)
    frame_time = 1 / Fraction(read.frame_time) if read.frame_time else None
    clip = Clip.of(body.values, columns, frame_time, skeleton)
    slots = partial(_core.amc_slots, words=read.words, counts=read.counts)
    layout = build("amc", text, body, slots, partial(read.places, text.data, body.offsets))
    return split_of(clip, layout, [Problem.told(fact, text) for fact in read.problems], file)


def fit(clip: Clip) -> Clip:
    """Give the clip as an AMC has it; one without a skeleton is taken to be from an AMC."""
    return to_amc_clip(clip) if clip.skeleton else clip


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip, and its skeleton as the ASF beside it."""
    if not clip.values.size:
        raise UnsupportedError("an AMC needs frames", expected="1 frame of 1 channel at least")
    radians = any(column.unit == "rad" for column in clip.columns)
    header = format_header(clip.frame_time, "rad" if radians else "deg") + b"\n"
    literals = [b""]
    bones = _bone_words(clip)
    for i, column in enumerate(clip.columns):
        fresh = i == 0 or column.joint != clip.columns[i - 1].joint
        literals.append(f"\n{bones[column.joint]} ".encode() if fresh else b" ")
    literals.append(b"\n")
    files = {".amc": print_clip(clip, header, literals, counter=True)}
    return files | ({".asf": format_asf(clip.skeleton)} if clip.skeleton else {})


def _bone_words(clip: Clip) -> dict[int, str]:
    """Give the word of each joint, as the ASF of its skeleton has it."""
    if clip.skeleton is not None:
        return dict(enumerate(asf_words(clip.skeleton)))
    names = {column.joint: column.name.rpartition(".")[0] for column in clip.columns}
    return dict(zip(names, words(list(names.values()), frozenset()), strict=True))


def format_header(frame_time: FrameTime, angle_unit: str) -> bytes:
    """Print what stands before the frames."""
    lines = [":FULLY-SPECIFIED", ":RADIANS" if angle_unit == "rad" else ":DEGREES"]
    if frame_time:
        lines.append(f":SAMPLES-PER-SECOND {to_state(short_decimal(1 / Fraction(frame_time)))}")
    return "\n".join(lines).encode()


FORMAT = Format(
    id="amc",
    name="AMC",
    suffixes=(".amc",),
    recognises=lambda head: bool(_KEYWORD.search(head)),
    split=split,
    fit=fit,
    write=write,
    timed=False,
    companion="asf",
)
