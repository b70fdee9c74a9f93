"""Feet that stand: which channels are corrected, and how far, so that they stay where they were."""

from collections.abc import Callable
from math import radians

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from mocapress.codecs.contract import Encoded
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Skeleton, Stream
from mocapress.motion.contacts import Frames, contacts
from mocapress.motion.kinematics import positions

Array = NDArray[np.float64]
Coding = Callable[[Array, float], tuple[Encoded, Array]]
"""Codes with limits of errors, (F, C), and a step by which they can be kept; gives what a decoder
makes of it, too."""

ASSUMED_RATE = 120.0
"""Frames a second of a clip that states none, such as an AMC."""
_ROUNDS = 20


def protected(
    stream: Stream, skeleton: Skeleton | None, most: float, limits: Array, code: Coding
) -> Encoded:
    """Code a stream so that joints of feet are no farther than ``most`` from where they stood.

    In a contact in which a joint of a foot would be farther, all channels that move it are
    corrected to within one limit. It begins with what moves a foot by ``most`` where errors are
    independent of each other, and is halved until no foot is farther.

    Raises
    ------
    ParameterError
        When ``most`` is finer than numbers can say.
    UnsupportedError
        When there is no skeleton, none of its joints is called a foot, or bones stretch.

    """
    clip = Clip({"motion": stream}, skeleton)
    standing = contacts(clip, fps=ASSUMED_RATE)
    assert skeleton is not None
    feet = {skeleton.index(name): frames for name, frames in standing.items()}
    moving = {foot: _moving(stream, skeleton, foot) for foot in feet}
    limit = min(most / effect for _, effect in moving.values())
    corrected = np.zeros(limits.shape, dtype=np.bool_)
    placed = positions(clip)
    finest = float(limits.min(initial=np.inf))
    for _ in range(_ROUNDS):
        narrow = np.where(corrected, np.minimum(limits, limit), limits)
        made, decoded = code(narrow, min(limit, finest) if corrected.any() else finest)
        found = positions(clip.with_values(decoded))
        before = corrected.copy()
        wrong = np.zeros(stream.frames, dtype=np.bool_)
        for foot, frames in feet.items():
            far = np.linalg.norm(found[:, foot] - placed[:, foot], axis=-1) > most
            wrong |= frames & far
            corrected[np.ix_(_whole(frames, far), moving[foot][0])] = True
        if not wrong.any():
            return made
        if (corrected == before).all():
            limit /= 2
    raise ParameterError(
        "qssd:protect", expected="more than rounding moves a foot", found=f"{most}"
    )


def _whole(standing: Frames, far: Frames) -> Frames:
    """Give all frames of those contacts in which a foot is too far: else it would start to jump."""
    contact, _ = label(standing)
    found: Frames = standing & np.isin(contact, contact[standing & far])
    return found


def _moving(stream: Stream, skeleton: Skeleton, foot: int) -> tuple[NDArray[np.intp], float]:
    """Give the columns that move a joint, and how far errors of 1 in all of them do, about."""
    reach = {foot: 0.0}  # from each joint above
    at = foot
    while (above := skeleton.joints[at].parent) >= 0:
        reach[above] = reach[at] + float(np.linalg.norm(skeleton.joints[at].offset))
        at = above
    columns, squares = [], 0.0
    for c, column in enumerate(stream.columns):
        if column.joint not in reach:
            continue
        if column.kind[:1] != "r":
            effect = 1.0
        else:
            effect = reach[column.joint] * (1.0 if column.unit == "rad" else radians(1.0))
        if effect > 0:
            columns.append(c)
            squares += effect**2
    return np.array(columns, dtype=np.intp), max(float(np.sqrt(squares)), 1e-300)
