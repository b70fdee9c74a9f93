"""BVH: a skeleton and its motion in one file, one line per frame."""

import re

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats.bvh_hierarchy import Hierarchy, format_hierarchy, parse_hierarchy
from mocapress.formats.contract import Format, Split, split_of
from mocapress.formats.layout import Slot, build, print_clip
from mocapress.formats.rows import Body, RowShape, read_rows, row_error
from mocapress.motion import Clip, Skeleton
from mocapress.motion.clip import decimal_seconds
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.convert import to_bvh_clip

_TOKEN = re.compile(rb"\S+")


def split(data: bytes, _skeleton: Skeleton | None = None, file: str | None = None) -> Split:
    """Take a BVH apart; it has its skeleton in itself."""
    body, hierarchy, error = read_body(data, file)
    columns = skeleton_columns(hierarchy.skeleton)
    clip = Clip.of(body.values, columns, hierarchy.frame_time, hierarchy.skeleton)
    return split_of(clip, build("bvh", data, body, slots_of_row), error, file)


def write(clip: Clip) -> dict[str, bytes]:
    """Print a clip."""
    if clip.skeleton is None:
        raise UnsupportedError("a BVH file needs a skeleton")
    if clip.frame_time is None:
        raise UnsupportedError("a BVH file needs a frame time")
    header = format_hierarchy(clip.skeleton, clip.frames, decimal_seconds(clip.frame_time))
    literals = [b"", *[b" "] * (clip.channels - 1), b"\n"]
    return {".bvh": print_clip(clip, header, literals, counter=False)}


def read_body(data: bytes, file: str | None = None) -> tuple[Body, Hierarchy, FormatError | None]:
    """Read the frames; the error says why reading stopped before the declared number of frames.

    Raises
    ------
    FormatError
        When the hierarchy cannot be read.

    """
    hierarchy = parse_hierarchy(data, file)
    channels = sum(len(joint.channels) for joint in hierarchy.skeleton.joints)
    if channels == 0:
        raise FormatError("no channels", file=file, expected="a joint with CHANNELS")
    shape = RowShape(False, (b"",), (channels,))
    body = read_rows(data, hierarchy.rows_begin, shape, hierarchy.frames)
    found = len(body.values)
    error = None
    if body.stop not in ("end of data", "limit"):
        expected = f"{channels} numbers on a line"
        error = row_error(data, body, file, found + 1, expected)
    elif body.stop == "limit" and data[int(body.offsets[-1]) :].strip():
        error = row_error(data, body, file, found + 1, f"{hierarchy.frames} frames, as declared")
    elif found < hierarchy.frames / 2:
        # One frame too few is common; half of them missing is a broken file.
        error = FormatError(
            "frames are missing",
            file=file,
            expected=f"{hierarchy.frames} frames, as declared",
            found=str(found),
        )
    return body, hierarchy, error


def slots_of_row(text: bytes) -> list[Slot]:
    """Find the numbers in a row's bytes."""
    line = text.split(b"\n", 1)[0] if text.lstrip()[:1] != b"#" else text
    return [(column, *token.span()) for column, token in enumerate(_TOKEN.finditer(line))]


FORMAT = Format(
    id="bvh",
    name="BVH",
    suffixes=(".bvh",),
    recognises=lambda head: head[:9].upper() == b"HIERARCHY",
    split=split,
    fit=to_bvh_clip,
    write=write,
)
