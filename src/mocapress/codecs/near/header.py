"""The codec header of ``near``: docs/format/near.md."""

from collections.abc import Sequence
from math import ceil, floor, log10
from typing import NamedTuple

import numpy as np

from mocapress import _core
from mocapress.codecs.near.turning import Turning
from mocapress.motion import Column, Skeleton
from mocapress.records import Reader, Writer

STEPS_PER_OCTAVE = 64
COARSE = 32
"""Steps of channels lie so many 64ths of an octave apart; those of the known figure lie so many, or
a multiple of it, from its own."""


class Joints(NamedTuple):
    """The joint of each column, and the parent of each joint, -1 for none.

    Joints are counted as columns tell them; one without columns is left out.
    """

    of_column: list[int]
    parents: list[int]


def joints_of(columns: Sequence[Column], skeleton: Skeleton | None) -> Joints:
    """Count the joints of columns."""
    joints = Joints([], [])
    known: dict[int, int] = {}
    before: int | None = None
    for column in columns:
        if column.joint < 0 or column.joint != before:
            joint, parent = column.joint, -1
            while skeleton is not None and 0 <= joint < len(skeleton.joints) and parent < 0:
                joint = skeleton.joints[joint].parent
                parent = known.get(joint, -1)
            known[column.joint] = len(joints.parents)
            joints.parents.append(parent)
        joints.of_column.append(len(joints.parents) - 1)
        before = column.joint
    return joints


def order_of(columns: Sequence[Column], skeleton: Skeleton | None) -> list[int]:
    """Give the columns in the order of the hierarchy; nothing where none is below a later one.

    Errors of a channel can be made good by those below it only, so that these have to follow it.
    """
    if skeleton is None:
        return []
    none = len(skeleton.joints)
    joints = [c.joint if 0 <= c.joint < none else none for c in columns]
    last = [-1] * (none + 1)
    for place, joint in enumerate(joints):
        last[joint] = place
    above = [-1] * (none + 1)  # the last column of any joint above
    for joint, one in enumerate(skeleton.joints):
        if one.parent >= 0:
            above[joint] = max(above[one.parent], last[one.parent])
    if all(place > above[joint] for place, joint in enumerate(joints)):
        return []
    return sorted(range(len(joints)), key=joints.__getitem__)


def pack_header(
    in_space: bool,
    short_spans: bool,
    errors: tuple[float, float],
    knot: int,
    steps: Sequence[int],
    joints: Joints,
    turnings: Sequence[Turning] = (),
    radians: bool = False,
    start: int = 0,
    known: bool = False,
    order: Sequence[int] = (),
) -> bytes:
    """Make the header.

    Parameters
    ----------
    in_space
        Whether errors are those of joints.
    short_spans
        Whether spans are short.
    errors
        Mean and largest; they are rounded up to three digits.
    knot
        The step of knots in eighths.
    steps
        Of each channel, as an exponent of 2^(1/64); they differ by multiples of 32, or their
        distances from the known figure's do.
    joints
        Of the channels.
    turnings
        The joints whose curves turn in another order than the file.
    radians
        Whether their angles are in radians.
    start
        With which of the learned starts coders begin, from 1 on; 0 for none.
    known
        Whether the figure is the known one.
    order
        Which of the file's columns each is; nothing where they are in its order.

    """
    base = steps[0] if steps else 0
    finer: list[int] = []
    if known:
        below = np.array(_core.near_figure()[0]) - steps
        base = -int(np.sort(below)[len(below) // 2])
        finer = np.diff((below + base) // COARSE, prepend=0).tolist()
    writer = Writer()
    writer.numbers([_rounded_up(error) for error in errors])
    writer.integer(
        (1 if in_space else 0)
        + (0 if short_spans else 2)
        + (4 if radians else 0)
        + (8 if known else 0)
        + (16 if any(finer) else 0)
        + (32 if len(order) else 0)
    )
    writer.integer(knot - 1)
    writer.signed(base)
    writer.integer(start)
    if known:
        writer.integer(sum(each[4] << i for i, each in enumerate(turnings)))
        if any(finer):
            writer.bytes(_core.near_differences(finer))
        return bytes(writer.data)
    if len(order):
        writer.bytes(_core.near_differences((np.diff(order, prepend=-1) - 1).tolist()))
    apart = np.diff(np.array(steps, np.int64), prepend=base) // COARSE
    writer.bytes(_core.near_columns(apart.tolist(), joints.of_column, joints.parents, turnings))
    return bytes(writer.data)


def unpack_errors(header: bytes) -> tuple[bool, float, float]:
    """Give whether errors are those of joints, and their mean and largest.

    Raises
    ------
    CorruptError
        When the header does not begin with them.

    """
    reader = Reader(header, "header of near")
    mean, largest = reader.numbers(2)
    return reader.integer(63) % 2 == 1, mean, largest


def _rounded_up(error: float) -> float:
    if not 0 < error < 1e15:
        return float(error)
    digits = 2 - floor(log10(error))
    if digits > 15:
        return float(error)
    return ceil(error * 10**digits) / 10**digits if digits > 0 else float(ceil(error))
