"""Reading and writing motion files, whichever their format."""

import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mocapress.errors import FormatError, UnsupportedError
from mocapress.formats import amc, asf, bvh, bvh_hierarchy
from mocapress.formats.layout import Layout, RowTemplate, build
from mocapress.formats.problems import Problem, report
from mocapress.motion import Clip, NumberFormat, Skeleton
from mocapress.motion.clip import decimal_seconds
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.number_format import NumberKind

FORMATS = ("amc", "bvh", "asf")


class Split(NamedTuple):
    """A motion file taken apart."""

    clip: Clip
    layout: Layout
    problems: tuple[Problem, ...]
    """Where the file departs from its format. What is no row is in the layout's tail."""


def sniff(data: bytes, name: str = "") -> str | None:
    """Tell ``amc``, ``bvh`` or ``asf`` from the contents, then from the name; None for neither."""
    head = data[: 2**16].lstrip(b"\xef\xbb\xbf \t\r\n")
    if head[:9].upper() == b"HIERARCHY":
        return "bvh"
    if re.search(rb"^\s*:(bonedata|root|hierarchy|version)\b", head, re.MULTILINE | re.IGNORECASE):
        return "asf"
    if re.search(rb"^\s*:(fully-specified|degrees|radians)\b", head, re.MULTILINE | re.IGNORECASE):
        return "amc"
    suffix = Path(name).suffix.lower()[1:]
    return suffix if suffix in FORMATS else None


def find_asf(path: Path) -> Path | None:
    """Find the skeleton of an AMC: the ASF of the same name, of the subject, or the only one."""
    try:
        candidates = sorted(p for p in path.parent.iterdir() if p.suffix.lower() == ".asf")
    except OSError:
        return None
    stem = path.stem.lower()
    same = [p for p in candidates if p.stem.lower() == stem]
    subject = [p for p in candidates if re.match(re.escape(p.stem.lower()) + r"[_\-. ]", stem)]
    by_length = sorted(subject, key=lambda p: -len(p.stem))
    return next(iter(same or by_length or (candidates if len(candidates) == 1 else [])), None)


def split(
    data: bytes, kind: str, *, skeleton: Skeleton | None = None, file: str | None = None
) -> Split:
    """Take a file's bytes apart into numbers and layout.

    Raises
    ------
    FormatError
        When not a single frame can be read.

    """
    if kind == "amc":
        body, shape, problems = amc.read_body(data, file)
        clip = amc.clip_of(body.values, shape, data[: int(body.offsets[0])], skeleton)
        layout = build(kind, data, body, partial(amc.slots_of_row, shape=shape))
    elif kind == "bvh":
        body, hierarchy, problems = bvh.read_body(data, file)
        clip = Clip.of(
            body.values,
            skeleton_columns(hierarchy.skeleton),
            hierarchy.frame_time,
            hierarchy.skeleton,
        )
        layout = build(kind, data, body, bvh.slots_of_row)
    else:
        raise UnsupportedError("no motion format", file=file, expected="amc or bvh", found=kind)
    columns = tuple(
        replace(column, decimal=number_format)
        for column, number_format in zip(clip.columns, layout.formats, strict=True)
    )
    clip = replace(clip.with_columns(columns), name=Path(file).stem if file else "")
    return Split(clip, layout, tuple(problems))


def columns_of(layout: Layout, skeleton: Skeleton | None = None) -> Clip:
    """Give the clip without frames that belongs to a layout: columns, frame time, skeleton.

    Raises
    ------
    FormatError
        When header and rows of the layout are not those of its format.

    """
    empty = split(layout.first_row(), layout.format, skeleton=skeleton).clip
    if empty.channels != len(layout.formats):
        raise FormatError("columns", expected=str(len(layout.formats)), found=str(empty.channels))
    columns = tuple(
        replace(column, decimal=number_format)
        for column, number_format in zip(empty.columns, layout.formats, strict=True)
    )
    return empty.with_columns(columns).with_values(empty.values[:0])


def read(path: str | Path, *, asf_path: str | Path | None = None, strict: bool = True) -> Clip:
    """Read a motion file.

    Parameters
    ----------
    path
        An AMC, BVH or ASF file. An ASF alone gives a clip of its skeleton without frames.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.
    strict
        Whether a file that has lost frames is refused. Otherwise it gives a ``MotionWarning``, as
        does whatever else departs from the format and loses nothing.

    Raises
    ------
    FormatError
        When the file cannot be read, or only in part: with file, line, expected and found.
    OSError
        When it cannot be opened.

    """
    path = Path(path)
    data = path.read_bytes()
    kind = sniff(data, path.name)
    if kind is None:
        raise FormatError("not a motion file", file=str(path), expected="AMC, BVH or ASF")
    skeleton: Skeleton | None = None
    if kind == "asf":
        skeleton = asf.parse_asf(data, str(path))
        columns = skeleton_columns(skeleton)
        return Clip.of(np.empty((0, len(columns))), columns, None, skeleton, path.stem)
    found = asf_path or (find_asf(path) if kind == "amc" else None)
    if found:
        skeleton = asf.parse_asf(Path(found).read_bytes(), str(found))
    parts = split(data, kind, skeleton=skeleton, file=str(path))
    report(parts.problems, str(path), strict=strict, depth=2)
    return parts.clip


def format_clip(clip: Clip, kind: str) -> bytes:
    """Print a clip as AMC or BVH; numbers in their columns' formats, else the fewest digits.

    The columns must be those of the format: see ``mocapress.motion.convert``.
    """
    shortest = NumberFormat(NumberKind.SHORTEST)
    formats = tuple(column.decimal or shortest for column in clip.columns)
    names = [
        clip.skeleton.joints[column.joint].name if clip.skeleton else column.name.rpartition(".")[0]
        for column in clip.columns
    ]
    if kind == "bvh":
        if clip.skeleton is None:
            raise UnsupportedError("a BVH file needs a skeleton")
        if clip.frame_time is None:
            raise UnsupportedError("a BVH file needs a frame time")
        header = bvh_hierarchy.format_hierarchy(
            clip.skeleton, clip.frames, decimal_seconds(clip.frame_time)
        )
        literals = [b"", *[b" "] * (clip.channels - 1), b"\n"]
    elif kind == "amc":
        radians = any(column.unit == "rad" for column in clip.columns)
        header = b":FULLY-SPECIFIED\n" + (b":RADIANS\n" if radians else b":DEGREES\n")
        literals = [b""]
        for i, column in enumerate(clip.columns):
            fresh = i == 0 or column.joint != clip.columns[i - 1].joint
            literals.append(b"\n" + names[i].encode("latin-1", "replace") + b" " if fresh else b" ")
        literals.append(b"\n")
    else:
        raise UnsupportedError("no format for clips", expected="amc or bvh", found=repr(kind))
    template = RowTemplate(
        kind == "amc", tuple(literals), tuple(range(clip.channels)), (0,) * clip.channels
    )
    layout = Layout(
        kind,
        header,
        b"",
        formats,
        (template,),
        np.zeros(clip.frames, np.int32),
        np.arange(1, clip.frames + 1) if kind == "amc" else np.empty(0, np.int64),
        np.empty(0, np.uint64),
        np.empty(0, np.uint32),
        (),
        (),
    )
    return layout.join(clip.values)
