"""What is compared of standard motion: 35 numbers a frame; and a compact record of them.

The numbers: places of head, wrists and ankles from the hips (leg lengths), their velocities, height
of the hips, their velocity in axes that turn with the body, and how fast the body turns.
"""

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError
from mocapress.motion.standard_joints import JOINTS
from mocapress.search.standard import RATE, StandardMotion

Array = NDArray[np.float64]
Features = NDArray[np.float32]

SIZE = 35
EVERY = 2
"""Compared one by one is every second frame: 15 a second."""
_ENDS = [
    JOINTS.index(joint)
    for joint in ("head", "left_wrist", "right_wrist", "left_ankle", "right_ankle")
]
_PLACES = 3 * len(_ENDS)
# Weights by which numbers of other units count beside leg lengths.
_END_SPEED, _ROOT_SPEED, _TURN = 0.25, 0.5, 0.25
_KEPT = _PLACES + 5
"""Kept of a frame: all but the velocities of the ends, which follow from their places."""
_FINE = 64
"""Steps of what is kept to a unit; it is held to two units about 0, as int8."""
_NO_FRAMES = np.zeros((_KEPT, 0), np.int8)
_HEAD = struct.Struct("<I")
_MOST = 2**26
"""Frames of a record at most."""


def features(motion: StandardMotion) -> Array:
    """Give the numbers by which motion is compared: (F, 35), 30 frames a second."""
    return _with_speeds(_own(motion), RATE, motion.cuts)


def record(motion: StandardMotion) -> bytes:
    """Give what a library keeps of a motion, to align it with others; see ``read_record``.

    Number of frames F, ``<I``, and the deflated int8 numbers (20, F), each less the one before. A
    motion with cuts has one row more, 1 in the first frames behind them.
    """
    kept = np.round(_own(motion)[::EVERY] * _FINE).clip(-127, 127).astype(np.int8)
    steps = np.diff(kept, axis=0, prepend=np.zeros((1, _KEPT), np.int8))
    begins = -(-np.array(motion.cuts, dtype=np.intp) // EVERY)
    begins = begins[begins < len(kept)]
    if len(begins):
        steps = np.concatenate([steps, np.zeros((len(kept), 1), np.int8)], axis=1)
        steps[begins, _KEPT] = 1
    return _HEAD.pack(len(kept)) + zlib.compress(steps.T.tobytes(), 9)


def read_record(data: bytes) -> Features:
    """Give features of a record: (F, 35), 15 frames a second.

    Raises
    ------
    CorruptError
        When it is damaged.

    """
    try:
        (frames,) = _HEAD.unpack_from(data)
        if frames > _MOST:
            raise ValueError
        unpacker = zlib.decompressobj()
        steps = unpacker.decompress(data[_HEAD.size :], frames * (_KEPT + 1) + 1)
        if len(steps) not in (frames * _KEPT, frames * (_KEPT + 1)) or not unpacker.eof:
            raise ValueError
    except (struct.error, zlib.error, ValueError):
        raise CorruptError("damaged: what search compares of a clip") from None
    rows = np.frombuffer(steps, np.int8).reshape(-1, max(frames, 1)) if frames else _NO_FRAMES
    kept = rows[:_KEPT].cumsum(axis=1, dtype=np.int8).T
    cuts = tuple(np.flatnonzero(rows[_KEPT:].any(axis=0)).tolist())
    return _with_speeds(kept / _FINE, RATE / EVERY, cuts).astype(np.float32)


def _own(motion: StandardMotion) -> Array:
    """Give (F, 20): places of the ends, height, velocity and turning of the root."""
    ends = motion.places[:, _ENDS].reshape(motion.frames, _PLACES)
    x, y, z = _rates(motion.root, RATE, motion.cuts).T
    cos, sin = np.cos(motion.heading), np.sin(motion.heading)
    speed = np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=1)
    turn = _rates(motion.heading[:, None], RATE, motion.cuts)
    own = [ends, motion.root[:, 1:2], _ROOT_SPEED * speed, _TURN * turn]
    return np.concatenate(own, axis=1)


def _with_speeds(own: Array, rate: float, cuts: tuple[int, ...]) -> Array:
    speeds = _END_SPEED * _rates(own[:, :_PLACES], rate, cuts)
    return np.concatenate([own[:, :_PLACES], speeds, own[:, _PLACES:]], axis=1)


def _rates(values: Array, rate: float, cuts: tuple[int, ...]) -> Array:
    """Give changes a second, none of them across a cut; nothing changes in a single frame."""
    pieces = [
        np.gradient(piece, axis=0) * rate if len(piece) > 1 else np.zeros_like(piece)
        for piece in np.split(values, cuts)
    ]
    return np.concatenate(pieces)
