"""What is compared of standard motion: 35 numbers a frame; and a compact record of them.

The numbers: places of head, wrists and ankles from the hips (leg lengths), their velocities, height
of the hips, their velocity in axes that turn with the body, and how fast the body turns.
"""

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import CorruptError
from mocapress.search.joint_names import JOINTS
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
_HEAD = struct.Struct("<I")
_MOST = 2**26
"""Frames of a record at most."""


def features(motion: StandardMotion) -> Array:
    """Give the numbers by which motion is compared: (F, 35), 30 frames a second."""
    return _with_speeds(_own(motion), RATE)


def record(motion: StandardMotion) -> bytes:
    """Give what a library keeps of a motion, to align it with others; see ``read_record``.

    Number of frames F, ``<I``, and the deflated int8 numbers (20, F), each less the one before.
    """
    kept = np.round(_own(motion)[::EVERY] * _FINE).clip(-127, 127).astype(np.int8)
    steps = np.diff(kept, axis=0, prepend=np.zeros((1, _KEPT), np.int8))
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
        steps = unpacker.decompress(data[_HEAD.size :], frames * _KEPT + 1)
        if len(steps) != frames * _KEPT or not unpacker.eof:
            raise ValueError
    except (struct.error, zlib.error, ValueError):
        raise CorruptError("damaged: what search compares of a clip") from None
    kept = np.frombuffer(steps, np.int8).reshape(_KEPT, frames).cumsum(axis=1, dtype=np.int8).T
    return _with_speeds(kept / _FINE, RATE / EVERY).astype(np.float32)


def _own(motion: StandardMotion) -> Array:
    """Give (F, 20): places of the ends, height, velocity and turning of the root."""
    ends = motion.places[:, _ENDS].reshape(motion.frames, _PLACES)
    x, y, z = _rates(motion.root, RATE).T
    cos, sin = np.cos(motion.heading), np.sin(motion.heading)
    speed = np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=1)
    turn = _rates(motion.heading[:, None], RATE)
    own = [ends, motion.root[:, 1:2], _ROOT_SPEED * speed, _TURN * turn]
    return np.concatenate(own, axis=1)


def _with_speeds(own: Array, rate: float) -> Array:
    speeds = _END_SPEED * _rates(own[:, :_PLACES], rate)
    return np.concatenate([own[:, :_PLACES], speeds, own[:, _PLACES:]], axis=1)


def _rates(values: Array, rate: float) -> Array:
    """Give changes a second; nothing changes in a single frame."""
    if len(values) < 2:
        return np.zeros_like(values)
    rates: Array = np.gradient(values, axis=0) * rate
    return rates
